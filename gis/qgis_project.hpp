// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/layers.hpp"
#include "gis/raster_writer.hpp"
#include "gis/vector_writer.hpp"
#include "scree/geometry/local_frame.hpp"

#include <span>
#include <string>

namespace scree::gis {

/// The text of a QGIS project that opens results.gpkg and rasters/NAME.tif in the folder where it lies, styled and grouped:
/// layers in the order given, vectors above rasters, groups where their first layer stands. Paths are relative.
std::string qgis_project(const LocalFrame& frame, const std::string& title, std::span<const VectorLayer> vectors,
                         std::span<const WrittenLayer> written, std::span<const RasterLayer> rasters,
                         std::span<const WrittenRaster> written_rasters);

}  // namespace scree::gis
