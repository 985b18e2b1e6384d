// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/local_frame.hpp"
#include "scree/geometry/types.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace scree::gis {

struct DtmSettings {
    /// Largest raster that is read [cells]; a larger one is refused before any memory is taken (8 bytes a cell, and about three
    /// times that while the terrain is built).
    std::int64_t max_cells = 400'000'000;
    /// Heights outside of this range are no heights on land but an untagged nodata value or another unit, and are refused [m].
    double lowest_height = -500.0;
    double highest_height = 9000.0;  ///< upper end of that range [m]
};

struct DtmReport {
    std::string file;             ///< as given
    std::string driver;           ///< GDAL's name of the format
    std::string data_type;        ///< GDAL's name of the pixel type
    std::string crs_name;         ///< with its code where it has one; empty: unknown
    Vec2 south_west, north_east;  ///< corners of the raster, map frame [m]
    double cell_x = 0.0;          ///< width of a cell, west to east [m]
    double cell_y = 0.0;          ///< height of a cell in plan, south to north [m]
    double valid_fraction = 0.0;  ///< share of the cells that have a height [-]
    double min_height = kNaN;     ///< lowest height in the map frame [m]
    double max_height = kNaN;     ///< highest height in the map frame [m]
    std::vector<std::string> warnings;
};

/// A terrain model as it lies in its file, on rectangular cells. Row 0 in the SOUTH whatever the order in the file.
struct Dtm {
    LocalFrame frame;                ///< origin: south-west corner and lowest height, rounded down to 100 m
    int columns = 0;                 ///< number of cells west to east [-]
    int rows = 0;                    ///< number of cells south to north [-]
    double dx = 1.0;                 ///< width of a cell, west to east [m]
    double dy = 1.0;                 ///< height of a cell in plan, south to north [m]
    Vec2 north_west = Vec2::Zero();  ///< north-west corner of the north-west cell, local frame [m]
    std::vector<double>
        heights;  ///< of the cells' centres, row by row from the south-west, local frame [m]; NaN: no value
    DtmReport report;

    double at(int column, int row) const {
        return heights[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                       static_cast<std::size_t>(column)];
    }
    Box2 bounds() const {
        return {{north_west.x(), north_west.y() - rows * dy}, {north_west.x() + columns * dx, north_west.y()}};
    }
};

/// Reads a raster of heights. Refuses with InputError what would silently be wrong: degrees, feet, rotation, several bands, complex
/// numbers, no georeference, untagged nodata values, infinities, unreadable or missing pixels, rasters beyond max_cells.
/// NaN, the nodata value, mask and alpha bands mark cells without a height; scale and offset of the band are applied.
Dtm read_dtm(const std::string& file, const DtmSettings& settings = {});

}  // namespace scree::gis
