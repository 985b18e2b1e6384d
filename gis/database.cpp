// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/database.hpp"

#include "scree/base/error.hpp"

#include <sqlite3.h>

namespace scree::gis {

void StatementCloser::operator()(sqlite3_stmt* statement) const {
    sqlite3_finalize(statement);
}
void DatabaseCloser::operator()(sqlite3* database) const {
    sqlite3_close(database);
}

Statement::Statement(Database& database, const std::string& sql) : database_(&database) {
    sqlite3_stmt* prepared = nullptr;
    if (sqlite3_prepare_v2(database.handle_.get(), sql.c_str(), -1, &prepared, nullptr) != SQLITE_OK) database.fail();
    handle_.reset(prepared);
}

Statement& Statement::bind(int place, std::int64_t value) {
    if (sqlite3_bind_int64(handle_.get(), place, value) != SQLITE_OK) database_->fail();
    return *this;
}

Statement& Statement::bind(int place, std::string_view text) {
    // an empty view may have no address, which SQLite would take for NULL
    const char* data = text.empty() ? "" : text.data();
    if (sqlite3_bind_text64(handle_.get(), place, data, text.size(), SQLITE_STATIC, SQLITE_UTF8) != SQLITE_OK)
        database_->fail();
    return *this;
}

Statement& Statement::bind_blob(int place, std::string_view bytes) {
    if (sqlite3_bind_blob64(handle_.get(), place, bytes.data(), bytes.size(), SQLITE_STATIC) != SQLITE_OK)
        database_->fail();
    return *this;
}

void Statement::run() {
    int status = sqlite3_step(handle_.get());
    while (status == SQLITE_ROW) status = sqlite3_step(handle_.get());
    if (status != SQLITE_DONE || sqlite3_reset(handle_.get()) != SQLITE_OK) database_->fail();
}

std::int64_t Statement::integer() {
    if (sqlite3_step(handle_.get()) != SQLITE_ROW) database_->fail();
    const std::int64_t value = sqlite3_column_int64(handle_.get(), 0);
    sqlite3_reset(handle_.get());
    return value;
}

Database::Database(const std::filesystem::path& file) : file_(file.string()) {
    sqlite3* opened = nullptr;
    const int status = sqlite3_open_v2(file_.c_str(), &opened, SQLITE_OPEN_READWRITE, nullptr);
    handle_.reset(opened);
    if (status != SQLITE_OK) fail();
    run("PRAGMA synchronous = OFF");
}

void Database::run(const std::string& sql) {
    if (sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

void Database::fail() const {
    throw ComputeError(file_ + ": could not be written; SQLite says: " + sqlite3_errmsg(handle_.get()));
}

void register_extension(Database& database, std::string_view table, std::string_view column, std::string_view extension,
                        std::string_view definition, std::string_view scope) {
    database.run(
        "CREATE TABLE IF NOT EXISTS gpkg_extensions (table_name TEXT, column_name TEXT, extension_name TEXT NOT NULL,"
        " definition TEXT NOT NULL, scope TEXT NOT NULL,"
        " CONSTRAINT ge_tce UNIQUE (table_name, column_name, extension_name))");
    // a NULL column defeats the UNIQUE above
    database
        .prepare(
            "INSERT INTO gpkg_extensions (table_name, column_name, extension_name, definition, scope)"
            " SELECT ?1, nullif(?2, ''), ?3, ?4, ?5 WHERE NOT EXISTS (SELECT 1 FROM gpkg_extensions"
            " WHERE table_name = ?1 AND ifnull(column_name, '') = ?2 AND extension_name = ?3)")
        .bind(1, table)
        .bind(2, column)
        .bind(3, extension)
        .bind(4, definition)
        .bind(5, scope)
        .run();
}

}  // namespace scree::gis
