// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/feature.hpp"
#include "scree/geometry/local_frame.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace scree::gis {

/// A layer or a table of measurements, before it is known what they are: both look the same from here on.
class RecordTable {
public:
    struct Record {
        std::int64_t row = 0;                  ///< line of the table, number of the feature [-]
        Vec3 position = Vec3::Constant(kNaN);  ///< local frame [m]
        std::vector<FieldValue> values;
    };

    std::string place;                 ///< begins messages: "The table 'stops.csv'"
    std::string row_word = "feature";  ///< or "line"
    bool decimal_comma = false;
    std::vector<std::string> fields;  ///< in lower case
    std::vector<Record> records;
    std::string source;  ///< what was read from where and how it was transformed, for people
    std::vector<std::string> warnings;

    bool has(const std::string& field) const;
    /// Throws InputError unless all are there.
    void require(const std::vector<std::string>& needed) const;
    /// "" where there is none.
    std::string text(const Record& record, const std::string& field) const;
    /// NaN where there is none; throws InputError where it is no finite number in [low, high].
    double number(const Record& record, const std::string& field, double low, double high) const;
    /// 0, 1, true, false, yes, no; false where there is none.
    bool flag(const Record& record, const std::string& field) const;
    /// A warning about fields that are neither known nor Scree's own.
    void warn_of_unread(const std::vector<std::string>& known);
    [[noreturn]] void refuse(const Record& record, const std::string& what) const;

private:
    const FieldValue* find(const Record& record, const std::string& field) const;
};

/// A layer of a vector file or spreadsheet, whose records are of the kind of a table of observations (observation_reader.hpp), or of another one. Positions are those of its points;
/// of records without a point those of the fields that a CSV table would have.
RecordTable read_layer_records(const std::string& file, const std::string& layer, std::string_view kind,
                               const LocalFrame& frame, const Box2& extent);
/// A CSV table with easting_m and northing_m, in the CRS that its column `crs` names or else in the terrain's, or longitude_deg and latitude_deg in
/// WGS 84; z_m is a height in the terrain's datum. Positions may be absent.
RecordTable read_csv_records(const std::string& file, const LocalFrame& frame, const Box2& extent);

}  // namespace scree::gis
