// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/simulation_store.hpp"

#include "gis/sha256.hpp"
#include "scree/base/error.hpp"

#include <bit>
#include <fstream>

namespace scree::cli {

namespace fs = std::filesystem;

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr const char* kOther = "another diagnosis";

template <class T>
void put(std::ostream& out, const T& value) {
    out.write(reinterpret_cast<const char*>(&value), sizeof value);
}
template <class T>
T get(std::istream& in) {
    T value{};
    in.read(reinterpret_cast<char*>(&value), sizeof value);
    return value;
}
template <class T>
void put_all(std::ostream& out, const std::vector<T>& values) {
    out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
}
template <class T>
void get_all(std::istream& in, std::vector<T>& values, std::size_t count) {
    values.resize(count);
    in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * sizeof(T)));
}

}  // namespace

SimulationStore::SimulationStore(fs::path folder, std::string subject)
    : folder_(std::move(folder)), subject_(std::move(subject)) {
    lock_.hold(folder_, kOther);
}

void SimulationStore::make_folder() {
    std::error_code ignored;  // whatever is written there says so
    fs::create_directories(folder_, ignored);
    if (!lock_.holds()) lock_.hold(folder_, kOther);
}

fs::path SimulationStore::file(const std::string& name) {
    make_folder();
    return folder_ / name;
}

fs::path SimulationStore::file_of(const std::string& words) const {
    return folder_ / (gis::sha256_of_text(subject_ + "\n" + words).substr(0, 32) + ".table");
}

std::optional<ObservationTable> SimulationStore::find(const std::string& words) const {
    std::ifstream in(file_of(words), std::ios::binary);
    if (!in) return std::nullopt;
    ObservationTable table;
    const auto columns = get<std::uint64_t>(in), rows = get<std::uint64_t>(in);
    if (!in || columns > 1000 || rows > 100'000'000) return std::nullopt;
    for (std::uint64_t c = 0; c < columns; ++c) {
        const auto quantity = get<std::int32_t>(in);
        const auto place = get<std::int32_t>(in);
        table.columns.push_back({static_cast<Quantity>(quantity), place});
    }
    get_all(in, table.block, rows);
    table.values.resize(columns);
    for (auto& column : table.values) get_all(in, column, rows);
    return in ? std::optional(std::move(table)) : std::nullopt;
}

void SimulationStore::keep(const std::string& words, const ObservationTable& table) {
    make_folder();
    const fs::path file = file_of(words), draft = file.string() + ".part";
    {
        std::ofstream out(draft, std::ios::binary);
        put(out, static_cast<std::uint64_t>(table.columns.size()));
        put(out, static_cast<std::uint64_t>(table.rows()));
        for (const Column& c : table.columns) {
            put(out, static_cast<std::int32_t>(c.quantity));
            put(out, c.place);
        }
        put_all(out, table.block);
        for (const auto& column : table.values) put_all(out, column);
        if (!out.flush())
            throw ComputeError("cannot write " + draft.string() + ": is the disc full, or the folder not writable?");
    }
    fs::rename(draft, file);
}

void SimulationStore::remove() {
    std::error_code ignored;
    std::vector<fs::path> own;
    for (const auto& entry : fs::directory_iterator(folder_, ignored)) {
        fs::path name = entry.path().filename();
        if (name.extension() == ".part") name.replace_extension();
        if ((name.extension() == ".table" || name.extension() == ".jsonl") && entry.is_regular_file(ignored))
            own.push_back(entry.path());
    }
    for (const fs::path& file : own) fs::remove(file, ignored);
    lock_.release();
    fs::remove(folder_, ignored);  // unless somebody keeps other things there
}

}  // namespace scree::cli
