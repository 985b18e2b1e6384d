// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/observation_reader.hpp"

#include "gis/observation_tables.hpp"
#include "gis/utf8.hpp"
#include "gis/vector_reader.hpp"
#include "gis/words.hpp"
#include "scree/base/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>

namespace scree::gis {

namespace {

namespace fs = std::filesystem;

constexpr std::array kTables{kStopsTable, kCrossingsTable, kImpactsTable, kSharesTable, kReleasesTable};
const std::vector<std::string> kPositionFields{"easting_m",    "northing_m", "longitude_deg",
                                               "latitude_deg", "z_m",        "crs"};
const std::vector<std::string> kBodyFields{"block_id", "order", "mass_kg", "l1_m", "l2_m", "l3_m"};

constexpr const char* kResults = "results.gpkg";  // of a run of Scree
constexpr double kMaxMass = 1e7;                  // [kg]
constexpr double kMaxEdge = 50.0;                 // [m]
constexpr double kMaxSpeed = 300.0;               // [m/s]
constexpr double kMaxSpin = 1000.0;               // [rad/s]
constexpr double kMaxError = 1000.0;              // [m, m/s, ...]
constexpr double kMaxImpacts = 10.0;              // of a block [-]
constexpr double kMaxBlocks = 1e9;                // [-]
constexpr double kPercentRounding = 0.06;         // [%] of a share that is printed with one decimal
constexpr double kWholePercentRounding = 0.51;    // [%] of one without

std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

ObservedBody body_of(const RecordTable& table, const RecordTable::Record& record) {
    ObservedBody body;
    body.id = table.has("block") ? table.text(record, "block") : table.text(record, "block_id");
    body.order = table.number(record, "order", 0.0, kMaxBlocks);
    body.mass = table.number(record, "mass_kg", 0.0, kMaxMass);
    std::array<double, 3> edges{};
    constexpr std::array<const char*, 3> kNames{"l1_m", "l2_m", "l3_m"};
    for (std::size_t k = 0; k < 3; ++k) edges[k] = table.number(record, kNames[k], 0.0, kMaxEdge);
    if (std::isfinite(edges[0] + edges[1] + edges[2])) std::sort(edges.rbegin(), edges.rend());
    body.l1 = edges[0];
    body.l2 = edges[1];
    body.l3 = edges[2];
    return body;
}

void add_stops(RecordTable& table, ObservationRecords& records) {
    table.warn_of_unread(
        joined(joined(kPositionFields, kBodyFields), {"position_error_m", "stop_reason", "censored", "broken"}));
    std::size_t failed = 0;
    for (const RecordTable::Record& r : table.records) {
        const std::string reason = table.text(r, "stop_reason");
        if (reason == "failed" && ++failed) continue;  // a simulation that came to nothing observes nothing
        if (!reason.empty() && reason != "at_rest" && reason != "left_terrain" && reason != "time_limit")
            table.refuse(r, words("has the stop_reason '", reason,
                                  "'; allowed is at_rest, left_terrain, time_limit, failed, or nothing."));
        StopRecord stop{r.row, body_of(table, r), r.position, kNaN, false, false};
        stop.error = table.number(r, "position_error_m", 0.0, kMaxError);
        stop.censored = table.flag(r, "censored") || reason == "left_terrain" || reason == "time_limit";
        stop.broken = table.flag(r, "broken");
        records.stops.push_back(stop);
    }
    if (failed > 0)
        records.warnings.push_back(
            words(table.place, " has ", counted(failed, "record"), " of failed computations, left out."));
}

void add_crossings(RecordTable& table, ObservationRecords& records) {
    table.require({"screen"});
    table.warn_of_unread(
        joined(joined(kPositionFields, kBodyFields),
               {"screen", "speed_ms", "height_m", "spin_rads", "energy_kj", "rise_ms", "speed_error_ms",
                "height_error_m", "spin_error_rads", "energy_error_kj", "rise_error_ms"}));
    for (const RecordTable::Record& r : table.records) {
        CrossingRecord c;
        c.row = r.row;
        c.body = body_of(table, r);
        c.screen = table.text(r, "screen");
        if (c.screen.empty()) table.refuse(r, "names no screen; every crossing needs one.");
        c.position = r.position;
        c.speed = table.number(r, "speed_ms", 0.0, kMaxSpeed);
        c.height = table.number(r, "height_m", -kMaxEdge, kMaxError);
        c.spin = table.number(r, "spin_rads", 0.0, kMaxSpin);
        c.energy = table.number(r, "energy_kj", 0.0, kInfinity);
        c.rise = table.number(r, "rise_ms", -kMaxSpeed, kMaxSpeed);
        c.rise_error = table.number(r, "rise_error_ms", 0.0, kMaxError);
        c.speed_error = table.number(r, "speed_error_ms", 0.0, kMaxError);
        c.height_error = table.number(r, "height_error_m", 0.0, kMaxError);
        c.spin_error = table.number(r, "spin_error_rads", 0.0, kMaxError);
        c.energy_error = table.number(r, "energy_error_kj", 0.0, kInfinity);
        records.crossings.push_back(c);
    }
}

ImpactEnd impact_end(const RecordTable& table, const RecordTable::Record& r, const std::string& which) {
    ImpactEnd end;
    end.speed = table.number(r, "speed_" + which + "_ms", 0.0, kMaxSpeed);
    if (std::isnan(end.speed))
        table.refuse(r, words("lacks speed_", which, "_ms; an impact needs the speeds before and after it."));
    end.rise = table.number(r, "rise_" + which + "_ms", -kMaxSpeed, kMaxSpeed);
    end.spin = table.number(r, "spin_" + which + "_rads", 0.0, kMaxSpin);
    return end;
}

void add_impacts(RecordTable& table, ObservationRecords& records) {
    table.require({"impact", "speed_before_ms", "speed_after_ms"});
    table.warn_of_unread(
        joined(joined(kPositionFields, kBodyFields),
               {"impact", "speed_before_ms", "speed_after_ms", "rise_before_ms", "rise_after_ms", "spin_before_rads",
                "spin_after_rads", "speed_error_ms", "rise_error_ms", "spin_error_rads"}));
    for (const RecordTable::Record& r : table.records) {
        ImpactRecord impact;
        impact.row = r.row;
        impact.body = body_of(table, r);
        const double number = table.number(r, "impact", 1.0, kMaxImpacts);
        if (!(number == std::floor(number)))
            table.refuse(r, "has no whole number in the field 'impact'; 1 is the first impact of a block.");
        impact.impact = static_cast<std::int64_t>(number);
        impact.before = impact_end(table, r, "before");
        impact.after = impact_end(table, r, "after");
        impact.speed_error = table.number(r, "speed_error_ms", 0.0, kMaxError);
        impact.rise_error = table.number(r, "rise_error_ms", 0.0, kMaxError);
        impact.spin_error = table.number(r, "spin_error_rads", 0.0, kMaxError);
        records.impacts.push_back(impact);
    }
}

void add_shares(RecordTable& table, ObservationRecords& records) {
    table.require({"name", "released"});
    if (!table.has("count") && !table.has("percent")) table.require({"count"});
    table.warn_of_unread({"name", "count", "released", "percent", "percent_low", "percent_high"});
    for (const RecordTable::Record& r : table.records) {
        ShareRecord share{r.row, table.text(r, "name"), 0, 0};
        if (share.zone.empty()) table.refuse(r, "names no deposit zone; every share needs one.");
        const double released = table.number(r, "released", 1.0, kMaxBlocks);
        const double count = table.number(r, "count", 0.0, kMaxBlocks),
                     percent = table.number(r, "percent", 0.0, 100.0);
        if (std::isnan(released) || (std::isnan(count) && std::isnan(percent)))
            table.refuse(r, "needs the number of blocks thrown (released) and the count in the zone, or its percent.");
        const double blocks = std::isnan(count) ? std::round(0.01 * percent * released) : count;
        if (blocks != std::floor(blocks) || released != std::floor(released))
            table.refuse(r, "has a count that is no whole number of blocks.");
        if (blocks > released)
            table.refuse(
                r, words("counts ", blocks, " blocks in the zone but ", released, " released; mend one of them."));
        const double rounding = percent == std::floor(percent) ? kWholePercentRounding : kPercentRounding;
        if (!std::isnan(percent) && std::abs(100.0 * blocks / released - percent) > rounding) {
            if (!std::isnan(count))
                table.refuse(r, words("says ", percent, " % but counts ", blocks, " of ", released,
                                      " blocks; mend one of them."));
            table.refuse(r,
                         words("says ", percent, " % of ", released, " blocks, which are ", 0.01 * percent * released,
                               ": no whole number of them; percent goes from 0 to 100 (70, not 0.7), mend it or "
                               "give the count."));
        }
        share.count = static_cast<std::int64_t>(blocks);
        share.thrown = static_cast<std::int64_t>(released);
        records.shares.push_back(share);
    }
}

void add_releases(RecordTable& table, ObservationRecords& records) {
    table.warn_of_unread(joined(kPositionFields, kBodyFields));
    for (const RecordTable::Record& r : table.records) {
        ReleaseRecord release{r.row, body_of(table, r), r.position};
        if (!release.body.id.empty()) records.releases.push_back(release);
    }
}

void add_table(const std::string& kind, RecordTable table, ObservationRecords& records) {
    if (kind == kStopsTable) add_stops(table, records);
    if (kind == kCrossingsTable) add_crossings(table, records);
    if (kind == kImpactsTable) add_impacts(table, records);
    if (kind == kSharesTable) add_shares(table, records);
    if (kind == kReleasesTable) add_releases(table, records);
    records.sources.push_back(table.source);
    records.warnings.insert(records.warnings.end(), table.warnings.begin(), table.warnings.end());
}

std::string what_is_read() {
    return words("observations are layers or tables called ", kStopsTable, ", ", kCrossingsTable, ", ", kImpactsTable,
                 ", ", kSharesTable, " (and ", kReleasesTable, "); gis/README.md describes them.");
}

bool is_table(const fs::path& file) {
    const std::string extension = lower_case(file.extension().string());
    return extension == ".csv" || extension == ".txt" || extension == ".tsv";
}

/// Of files that GDAL reads: those that somebody may keep a table in, beside others of a folder.
bool is_vector_file(const fs::path& file) {
    constexpr std::array kExtensions{".gpkg", ".shp", ".geojson", ".json", ".fgb", ".gml",
                                     ".kml",  ".tab", ".sqlite",  ".xlsx", ".ods"};
    return std::find(kExtensions.begin(), kExtensions.end(), lower_case(file.extension().string())) !=
           kExtensions.end();
}

/// The one of the names that is `name`, in whatever case; empty if none is.
std::string called(const std::string& name, const std::vector<std::string>& names, const std::string& place) {
    std::string found;
    for (const std::string& candidate : names) {
        const bool file = is_table(candidate) || is_vector_file(candidate);
        if (lower_case(file ? fs::path(candidate).stem().string() : candidate) != name) continue;
        if (!found.empty())
            throw InputError(words("The observations '", place, "' hold '", found, "' and '", candidate,
                                   "': which one counts? Keep one, or rename the other."));
        found = candidate;
    }
    return found;
}

/// A slip in a name must not leave out half of what was measured.
void warn_of_unread_tables(const std::string& place, const std::vector<std::string>& there,
                           const std::vector<std::string>& read, ObservationRecords& records) {
    std::string names;
    for (const std::string& name : there)
        if (std::find(read.begin(), read.end(), name) == read.end())
            names += words(names.empty() ? "'" : ", '", name, "'");
    if (!names.empty())
        records.warnings.push_back(
            words("The observations '", place, "' hold ", names, ", which is not read; ", what_is_read()));
}

/// What results of Scree say of their run.
void add_run(const RecordTable& run, const std::string& file, ObservationRecords& records) {
    for (const RecordTable::Record& r : run.records) {
        const std::string key = run.text(r, "key"), value = run.text(r, "value");
        if (key == "seed") records.seed = value;
        if (key.starts_with(kPassedKey)) records.screens.push_back(key.substr(kPassedKey.size()));
        if (key != "interrupted" || value == "false") continue;
        const auto done = value.find(": ");
        records.warnings.push_back(words("The results '", file, "' are those of a run that was interrupted (",
                                         done == std::string::npos ? value : value.substr(done + 2),
                                         "); run it to its end if they are to stand for all blocks."));
    }
}

void add_vector_file(const std::string& file, const LocalFrame& frame, const Box2& extent,
                     ObservationRecords& records) {
    const std::vector<std::string> layers = layer_names(file, "observations");
    std::vector<std::string> read;
    for (const char* name : kTables) {
        const std::string layer = called(name, layers, file);
        if (layer.empty()) continue;
        add_table(name, read_layer_records(file, layer, name, frame, extent), records);
        read.push_back(layer);
    }
    const bool of_scree =
        std::find(layers.begin(), layers.end(), "run") != layers.end();  // with more than observations
    if (!read.empty() && !of_scree) warn_of_unread_tables(file, layers, read, records);
    if (read.empty()) {
        std::string names;
        for (const std::string& name : layers) names += words(names.empty() ? "'" : ", '", name, "'");
        throw InputError(words("The observations '", file, "' have no layer that is known, only ",
                               names.empty() ? "none" : names, "; ", what_is_read()));
    }
    if (of_scree) add_run(read_layer_records(file, "run", "run", frame, extent), file, records);
    records.files.push_back(file);
}

/// What a table holds, by its name or by its columns.
std::string kind_of(const RecordTable& table, const fs::path& file) {
    const std::string stem = file.stem().string();
    for (const char* name : kTables)
        if (stem == name) return name;
    if (table.has("screen")) return kCrossingsTable;
    if (table.has("impact")) return kImpactsTable;
    if (table.has("name") && table.has("released")) return kSharesTable;
    if (table.has("easting_m") || table.has("longitude_deg")) return kStopsTable;
    std::string fields;
    for (const std::string& field : table.fields) fields += words(fields.empty() ? "'" : ", '", field, "'");
    throw InputError(words(
        table.place,
        " holds neither stops (easting_m, northing_m), nor crossings (screen), nor impacts (impact), nor shares (name, "
        "released), only ",
        fields, "; ", what_is_read()));
}

/// A table of a folder, in a file of its own: of several layers the one that is called as the table.
RecordTable read_file(const std::string& file, const char* kind, const LocalFrame& frame, const Box2& extent) {
    if (is_table(file)) return read_csv_records(file, frame, extent);
    const std::vector<std::string> layers = layer_names(file, "observations");
    const std::string layer = layers.size() == 1 ? layers.front() : called(kind, layers, file);
    if (layer.empty())
        throw InputError(words("The observations '", file, "' have ", counted(layers.size(), "layer"),
                               ", and none of them is called '", kind, "'; rename the one that is meant."));
    return read_layer_records(file, layer, kind, frame, extent);
}

void add_folder(const fs::path& folder, const LocalFrame& frame, const Box2& extent, ObservationRecords& records) {
    std::vector<std::string> tables, read;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
        const std::string name = entry.path().filename().string();
        if (name == kResults || (!is_table(entry.path()) && !is_vector_file(entry.path()))) continue;
        if (entry.is_regular_file(ignored))
            tables.push_back(name);
        else if (std::any_of(std::begin(kTables), std::end(kTables),
                             [&](const char* table) { return !called(table, {name}, folder.string()).empty(); }))
            throw InputError(
                words("The observations '", folder.string(), "' hold '", name,
                      "', which is a folder or a link that leads nowhere; put the table there, or remove it."));
    }
    std::sort(tables.begin(), tables.end());
    const bool results = fs::exists(folder / kResults);
    for (const char* name : kTables) {
        const std::string table = called(name, tables, folder.string());
        if (table.empty()) continue;
        if (results)
            throw InputError(words("The observations '", folder.string(), "' hold '", kResults, "' and '", table,
                                   "': which one counts? Name the file that is meant, or put it into a folder of its "
                                   "own."));
        const std::string file = (folder / table).string();
        add_table(name, read_file(file, name, frame, extent), records);
        records.files.push_back(file);
        read.push_back(table);
    }
    if (results) add_vector_file((folder / kResults).string(), frame, extent, records);
    if (!read.empty()) warn_of_unread_tables(folder.string(), tables, read, records);
    if (records.files.empty())
        throw InputError(words("The folder '", folder.string(), "' holds no table of observations and no results; ",
                               what_is_read()));
}

}  // namespace

ObservationRecords read_observations(const std::string& path, const LocalFrame& frame, const Box2& extent) {
    ObservationRecords records;
    std::error_code ignored;
    if (!fs::exists(path, ignored))
        throw InputError(words("The observations '", path, "' do not exist; check the path."));
    if (fs::is_directory(path, ignored)) {
        add_folder(path, frame, extent, records);
    } else if (is_table(path)) {
        RecordTable table = read_csv_records(path, frame, extent);
        const std::string kind = kind_of(table, path);
        add_table(kind, std::move(table), records);
        records.files.push_back(path);
    } else {
        add_vector_file(path, frame, extent, records);
    }
    if (records.stops.empty() && records.crossings.empty() && records.impacts.empty() && records.shares.empty())
        throw InputError(
            words("The observations '", path, "' hold no stop, crossing, impact or share; ", what_is_read()));
    return records;
}

}  // namespace scree::gis
