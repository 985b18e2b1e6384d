// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/layers.hpp"
#include "gis/qml.hpp"
#include "scree/geometry/local_frame.hpp"

#include <filesystem>

namespace scree::gis {

/// What the project needs to know of a raster that has been written.
struct WrittenRaster {
    QgisStyle style;
    Box2 extent;  ///< frame of the layer [m]
};

/// Writes a Cloud Optimized GeoTIFF, Float32, NaN where there is no value, with the style NAME.qml beside it. Its overviews show
/// the LARGEST of the cells that they stand for (the mean for terrain and slope): no dangerous cell vanishes when one zooms out.
/// Throws InputError for a raster without cells or without a proper name, ComputeError where writing fails.
WrittenRaster write_geotiff(const std::filesystem::path& tif, const LocalFrame& frame, const RasterLayer& layer);

/// Adds the raster to an existing GeoPackage as a 2D gridded coverage of Float32 TIFF tiles.
void append_coverage(const std::filesystem::path& geopackage, const LocalFrame& frame, const RasterLayer& layer);

}  // namespace scree::gis
