// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/observation_tables.hpp"

#include "gis/crs.hpp"
#include "gis/crs_transform.hpp"
#include "gis/observation_reader.hpp"
#include "gis/table_reader.hpp"
#include "gis/utf8.hpp"
#include "gis/vector_reader.hpp"
#include "gis/words.hpp"
#include "scree/base/error.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>

namespace scree::gis {

namespace {

// What Scree writes into its own results beside what is read here.
constexpr const char* kOwnFields[] = {"block",       "runout_m",     "drop_m",        "path_m",
                                      "time_s",      "speed_max_ms", "energy_max_kj", "release_feature",
                                      "azimuth_deg", "percent_low",  "percent_high",  "raised_m",
                                      "profile",     "s_m",          "release_s_m",   "mass_left_kg"};
constexpr double kPoorAccuracy = 5.0;  // of a transformation that deserves a warning [m]

std::string operation_text(const std::string& name, double accuracy) {
    if (name.empty()) return {};
    return words(
        ", transformed by ", name,
        std::isnan(accuracy) ? std::string(" (accuracy unknown)") : words(" (accuracy ", fixed(accuracy, 1), " m)"));
}

Vec3 point_of(const Feature& feature, const RecordTable& table) {
    const auto* points = std::get_if<Points>(&feature.geometry);
    if (!points) return Vec3::Constant(kNaN);
    if (points->size() != 1)
        throw InputError(words(table.place, " has feature ", feature.id, " with ", points->size(),
                               " points; a measurement has one: split it."));
    return points->front();
}

}  // namespace

const FieldValue* RecordTable::find(const Record& record, const std::string& field) const {
    const auto at = std::find(fields.begin(), fields.end(), field);
    return at == fields.end() ? nullptr : &record.values[static_cast<std::size_t>(at - fields.begin())];
}

bool RecordTable::has(const std::string& field) const {
    return std::find(fields.begin(), fields.end(), field) != fields.end();
}

void RecordTable::require(const std::vector<std::string>& needed) const {
    std::string missing, there;
    for (const std::string& field : needed)
        if (!has(field)) missing += words(missing.empty() ? "'" : ", '", field, "'");
    for (const std::string& field : fields) there += words(there.empty() ? "'" : ", '", field, "'");
    if (!missing.empty()) throw InputError(words(place, " lacks the field ", missing, "; it has ", there, "."));
}

void RecordTable::refuse(const Record& record, const std::string& what) const {
    throw InputError(words(place, ", ", row_word, " ", record.row, ", ", what));
}

std::string RecordTable::text(const Record& record, const std::string& field) const {
    const FieldValue* value = find(record, field);
    if (!value) return {};
    if (const auto* s = std::get_if<std::string>(value)) return *s;
    if (const auto* i = std::get_if<std::int64_t>(value)) return words(*i);
    if (const auto* d = std::get_if<double>(value)) return shortest(*d);
    return {};
}

double RecordTable::number(const Record& record, const std::string& field, double low, double high) const {
    const FieldValue* value = find(record, field);
    if (!value || std::holds_alternative<std::monostate>(*value)) return kNaN;
    double result = kNaN;
    bool unclear = false;
    if (const auto* i = std::get_if<std::int64_t>(value)) result = static_cast<double>(*i);
    if (const auto* d = std::get_if<double>(value)) result = *d;
    if (const auto* s = std::get_if<std::string>(value)) {
        if (s->empty()) return kNaN;
        result = parse_number(*s, decimal_comma).value_or(kNaN);
        std::string thousands = *s;
        std::erase(thousands, ',');
        unclear =
            decimal_comma && is_ambiguous_number(*s) && parse_number(thousands, false).value_or(kInfinity) <= high;
    }
    if (!unclear && std::isfinite(result) && result >= low && result <= high) return result;
    std::string allowed = "a finite number";
    if (std::isfinite(low)) allowed += words(" of at least ", low);
    if (std::isfinite(high)) allowed += words(std::isfinite(low) ? " and" : "", " of at most ", high);
    if (unclear) allowed += ", without a comma that could mean thousands (14,23 or 14.230 is clear)";
    refuse(record, words("has '", text(record, field), "' in the field '", field, "'; allowed is ", allowed,
                         ", or nothing where it was not measured."));
}

bool RecordTable::flag(const Record& record, const std::string& field) const {
    const std::string value = lower_case(text(record, field));
    if (value.empty() || value == "0" || value == "false" || value == "no") return false;
    if (value == "1" || value == "true" || value == "yes") return true;
    refuse(record, words("has '", value, "' in the field '", field, "'; allowed is 0 or 1."));
}

void RecordTable::warn_of_unread(const std::vector<std::string>& known) {
    std::string unread;
    for (const std::string& field : fields) {
        const bool ours = std::find(std::begin(kOwnFields), std::end(kOwnFields), field) != std::end(kOwnFields);
        if (!ours && std::find(known.begin(), known.end(), field) == known.end())
            unread += words(unread.empty() ? "'" : ", '", field, "'");
    }
    if (!unread.empty())
        warnings.push_back(words(place, " has fields that are not read: ", unread,
                                 "; names carry their unit, such as speed_ms (gis/README.md lists them)."));
}

namespace {

/// Finds out where the positions of a table are and brings them into the local frame, of records that have none yet.
class TablePositions {
public:
    TablePositions(RecordTable& table, const LocalFrame& frame, const Box2& extent)
        : table_(table), frame_(frame), extent_(extent) {}

    void fill() {
        const bool map = table_.has("easting_m") || table_.has("northing_m");
        const bool earth = table_.has("longitude_deg") || table_.has("latitude_deg");
        const bool any = std::any_of(table_.records.begin(), table_.records.end(), &TablePositions::is_placed);
        const auto is_told = [&](const RecordTable::Record& record) {
            return !is_placed(record) &&
                   !(table_.text(record, "easting_m") + table_.text(record, "longitude_deg")).empty();
        };
        // of a layer with points fields may say the same once more, and nothing where a block was not found
        if (any && std::none_of(table_.records.begin(), table_.records.end(), is_told)) return;
        if (!map && !earth) {
            table_.source += " without positions";
            return;
        }
        if (map && earth)
            throw InputError(words(table_.place,
                                   " has positions twice, as easting_m, northing_m and as longitude_deg, "
                                   "latitude_deg; keep one pair."));
        table_.require(map ? std::vector<std::string>{"easting_m", "northing_m"}
                           : std::vector<std::string>{"longitude_deg", "latitude_deg"});
        prepare(earth);
        for (RecordTable::Record& record : table_.records)
            if (!is_placed(record)) place(record, earth);
        check_extent();
        report();
    }

private:
    static bool is_placed(const RecordTable::Record& record) { return std::isfinite(record.position.x()); }

    void prepare(bool earth) {
        std::string name;
        for (const RecordTable::Record& record : table_.records) {
            const std::string here = table_.text(record, "crs");
            if (name.empty()) name = here;
            if (!here.empty() && here != name)
                table_.refuse(
                    record, words("has the CRS '", here, "' where others have '", name, "'; use one CRS in a table."));
        }
        for (const RecordTable::Record& record : table_.records)
            if (!name.empty() && table_.text(record, "crs").empty() &&
                !table_.text(record, earth ? "longitude_deg" : "easting_m").empty())
                table_.refuse(record, words("has a position but no CRS, where others have '", name,
                                            "'; fill the column, or leave it out."));
        if (earth && name.empty()) name = "EPSG:4326";
        if (name.empty()) {
            table_.warnings.push_back(
                words(table_.place,
                      " names no CRS in a column crs: its positions are taken to be in the CRS of "
                      "the terrain; give it, such as EPSG:2154, to be sure."));
            table_.source += ", CRS of the terrain (assumed)";
            return;
        }
        const HorizontalCrs crs = named_crs(name, table_.place);
        table_.source += ", " + crs.name;
        if (in_degrees(crs.wkt) != earth)
            throw InputError(words(table_.place, " has positions in ", earth ? "degrees" : "metres",
                                   " but names the CRS '", crs.name, "', which is in ", earth ? "metres" : "degrees",
                                   "; name columns and CRS alike."));
        if (frame_.crs.empty())
            throw InputError(words(table_.place,
                                   " names a CRS, but the terrain has none to transform to; assign one to the "
                                   "terrain."));
        if (!same_map(crs.wkt, frame_.crs)) transform_.emplace(crs.wkt, frame_.crs, table_.place);
    }

    void place(RecordTable::Record& record, bool earth) {
        const double x = table_.number(record, earth ? "longitude_deg" : "easting_m", earth ? -180.0 : -kInfinity,
                                       earth ? 180.0 : kInfinity);
        const double y = table_.number(record, earth ? "latitude_deg" : "northing_m", earth ? -90.0 : -kInfinity,
                                       earth ? 90.0 : kInfinity);
        if (std::isnan(x) != std::isnan(y)) table_.refuse(record, "has half a position; give both numbers or none.");
        if (std::isnan(x)) return;
        Vec2 map{x, y};
        if (transform_) {
            const std::optional<Vec2> moved = (*transform_)(map);
            if (!moved)
                table_.refuse(record,
                              words("has the position (", x, ", ", y, "), which has no place in the terrain's CRS."));
            map = *moved;
        }
        record.position = {map.x() - frame_.easting, map.y() - frame_.northing,
                           table_.number(record, "z_m", -kInfinity, kInfinity) - frame_.height};
        box_.add(Vec2(record.position.head<2>()));
    }

    void check_extent() const {
        if (box_.empty() || extent_.overlaps(box_)) return;
        const auto span = [&](const Box2& box) {
            return words("easting ", fixed(box.min.x() + frame_.easting, 1), " to ",
                         fixed(box.max.x() + frame_.easting, 1), ", northing ", fixed(box.min.y() + frame_.northing, 1),
                         " to ", fixed(box.max.y() + frame_.northing, 1));
        };
        throw InputError(words(table_.place, " lies wholly outside of the terrain: in the terrain's CRS it spans ",
                               span(box_), ", the terrain ", span(extent_), "; check coordinates and CRS."));
    }

    void report() {
        if (!transform_ || box_.empty()) return;
        const CrsTransform::Operation operation = transform_->last_operation();
        table_.source += operation_text(operation.name, operation.accuracy);
        if (!(operation.accuracy <= kPoorAccuracy))
            table_.warnings.push_back(words(table_.place, " was",
                                            operation_text(operation.name, operation.accuracy).substr(1),
                                            "; reproject it with the national grid files if that matters."));
    }

    RecordTable& table_;
    const LocalFrame& frame_;
    const Box2& extent_;
    std::optional<CrsTransform> transform_;
    Box2 box_;  // of all positions [m]
};

}  // namespace

RecordTable read_layer_records(const std::string& file, const std::string& layer, std::string_view kind,
                               const LocalFrame& frame, const Box2& extent) {
    VectorSource source;
    source.file = file;
    source.layer = layer;
    source.kinds = {GeometryKind::Point};
    if (kind == kSharesTable)  // deposit zones, along profiles as well
        source.kinds.insert(source.kinds.end(), {GeometryKind::Polygon, GeometryKind::LineString});
    source.purpose = "observations";
    source.may_reach_beyond = true;  // the audit of the observations says so in its own words
    source.geometry_optional = true;
    const VectorData data = read_vector(source, frame, extent);
    RecordTable table;
    table.place = words("The layer '", layer, "' of '", file, "'");
    for (const Field& field : data.layer.fields) table.fields.push_back(lower_case(field.name));
    for (const Feature& feature : data.layer.features)
        table.records.push_back({feature.id, point_of(feature, table), feature.values});
    table.warnings = data.report.warnings;
    table.source = words(layer, ": ", counted(table.records.size(), "record"));
    if (data.layer.kind != GeometryKind::None)
        table.source += words(", ", data.report.crs_name.empty() ? "unknown CRS" : data.report.crs_name,
                              operation_text(data.report.operation, data.report.accuracy));
    if (kind != kSharesTable || data.layer.kind == GeometryKind::None) TablePositions(table, frame, extent).fill();
    return table;
}

RecordTable read_csv_records(const std::string& file, const LocalFrame& frame, const Box2& extent) {
    const Table csv = read_table(file, "table of observations");
    RecordTable table;
    table.place = words("The table '", file, "'");
    table.row_word = "line";
    table.decimal_comma = csv.separator != ',';
    table.warnings = csv.warnings;
    for (const std::string& field : csv.header) table.fields.push_back(lower_case(field));
    for (const Table::Row& row : csv.rows)
        table.records.push_back({static_cast<std::int64_t>(row.line), Vec3::Constant(kNaN),
                                 std::vector<FieldValue>(row.cells.begin(), row.cells.end())});
    table.source =
        words(std::filesystem::path(file).filename().string(), ": ", counted(table.records.size(), "record"));
    TablePositions(table, frame, extent).fill();
    return table;
}

}  // namespace scree::gis
