// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/types.hpp"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace scree::test {

/// A raster to be written for a test: by default 40 x 30 cells of 2 m in Lambert 93 with the heights of a plane.
struct RasterSpec {
    int columns = 40;  ///< [-]
    int rows = 30;     ///< [-]
    std::array<double, 6> geotransform{900013.0, 2.0, 0.0, 6400077.0, 0.0, -2.0};
    std::string crs = "EPSG:2154";  ///< empty: none
    std::string type = "Float64";   ///< GDAL's name
    std::string driver = "GTiff";
    int bands = 1;  ///< [-]
    std::optional<double> nodata;
    std::string unit;
    double scale = 1.0;   ///< [-]
    double offset = 0.0;  ///< [m]
    /// Stored value of a cell by (column, row) of the file [m].
    std::function<double(int, int)> value = [](int c, int r) { return 1200.25 + 0.5 * c - 0.75 * r; };
    /// Values of an alpha band after the others [-]; none: no such band.
    std::function<double(int, int)> alpha;
};
void write_raster(const std::string& file, const RasterSpec& spec);

/// A vector layer to be written for a test: features as WKT with a text field and a number.
struct VectorSpec {
    struct Row {
        std::string wkt;               ///< empty: no geometry
        std::string text;              ///< value of the text field
        std::optional<double> number;  ///< value of the number field, none: NULL
    };
    std::string layer = "zones";
    std::string crs = "EPSG:2154";  ///< empty: none
    std::string driver = "GPKG";
    std::string text_field = "soil";
    std::string number_field = "priority";
    std::vector<Row> rows;
};
/// Writes one layer; with `append` into an existing file.
void write_vector(const std::string& file, const VectorSpec& spec, bool append = false);

/// The message of the InputError that `action` throws; "no error" if it throws none.
std::string input_error_of(const std::function<void()>& action);

}  // namespace scree::test
