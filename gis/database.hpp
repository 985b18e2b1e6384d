// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace scree::gis {

struct StatementCloser {
    void operator()(sqlite3_stmt* statement) const;
};
struct DatabaseCloser {
    void operator()(sqlite3* database) const;
};

class Database;

/// A prepared statement. Places count from 1, as ?1 in the SQL; what is bound must live until the next run().
class Statement {
public:
    Statement& bind(int place, std::int64_t value);
    Statement& bind(int place, std::string_view text);
    Statement& bind_blob(int place, std::string_view bytes);
    /// To the end, ready to be bound and run again.
    void run();
    /// The first column of the first row; the query must have one.
    std::int64_t integer();

private:
    friend class Database;
    Statement(Database& database, const std::string& sql);

    Database* database_;
    std::unique_ptr<sqlite3_stmt, StatementCloser> handle_;
};

/// An existing SQLite file, opened to add what GDAL does not write. Errors are ComputeErrors that name the file. Nothing is
/// flushed to disc: the folder of results is, once, when it is complete.
class Database {
public:
    explicit Database(const std::filesystem::path& file);

    void run(const std::string& sql);
    Statement prepare(const std::string& sql) { return {*this, sql}; }

private:
    friend class Statement;
    [[noreturn]] void fail() const;

    std::string file_;
    std::unique_ptr<sqlite3, DatabaseCloser> handle_;
};

/// Lists an extension of the GeoPackage standard as used by a table (and a column, if not empty), once.
void register_extension(Database& database, std::string_view table, std::string_view column, std::string_view extension,
                        std::string_view definition, std::string_view scope);

}  // namespace scree::gis
