// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/types.hpp"

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace scree::test {

/// One point of a layer with its attributes as text.
struct PointRow {
    Vec3 at = Vec3::Zero();  ///< map frame [m]
    std::map<std::string, std::string> values;
    double number(const std::string& field) const { return std::stod(values.at(field)); }
};

/// Features of a layer of a GeoPackage; of lines and polygons the attributes alone.
std::vector<PointRow> read_points(const std::filesystem::path& file, const std::string& layer);
/// Names of the fields of a layer; empty if there is no such layer.
std::set<std::string> fields_of(const std::filesystem::path& file, const std::string& layer);
/// Code of the CRS of a layer, "2154".
std::string crs_code_of(const std::filesystem::path& file, const std::string& layer);
/// Lowest and highest value, and sum, of a raster's cells that have one.
struct RasterFacts {
    double low = kInfinity;    ///< [unit of the raster]
    double high = -kInfinity;  ///< [unit of the raster]
    double sum = 0.0;          ///< [unit of the raster]
    bool finite = true;        ///< no infinity among them
};
RasterFacts raster_facts(const std::filesystem::path& file);
/// All cells of a raster, row by row from the north-west; NaN where there is no value [unit of the raster].
std::vector<double> raster_cells(const std::filesystem::path& file);
/// Height of a raster at a point: that of the cell it lies in; NaN outside [m].
double raster_at(const std::filesystem::path& file, double easting, double northing);
/// Is this line a JSON object with all these members?
bool is_json_object(const std::string& line, const std::vector<std::string>& members);

/// Relative name to content, of every file below a folder.
std::map<std::string, std::string> contents_of(const std::filesystem::path& folder);
/// A picture or report without the pixels that it holds, in which letters follow each other by chance.
std::string without_pixels(std::string text);
/// Files of a folder whose bytes differ from those of another folder's, or that only one of them has.
std::vector<std::string> differing_files(const std::filesystem::path& a, const std::filesystem::path& b,
                                         const std::set<std::string>& except = {});

}  // namespace scree::test
