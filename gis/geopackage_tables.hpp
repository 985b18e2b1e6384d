// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/layers.hpp"
#include "gis/vector_writer.hpp"

#include <filesystem>
#include <span>
#include <string>

namespace scree::gis {

/// Adds to a GeoPackage what GDAL does not write: the styles that QGIS looks for (layer_styles), aliases of the fields
/// (gpkg_data_columns), the provenance as a table `run` (key, value) and as the lineage of an ISO 19139 record (gpkg_metadata).
/// `written` holds one entry per layer; `rasters`: how many are in it. Throws ComputeError where the database cannot be written.
void write_geopackage_tables(const std::filesystem::path& geopackage, const std::string& title,
                             std::span<const VectorLayer> layers, std::span<const WrittenLayer> written,
                             std::span<const ProvenanceEntry> provenance, std::size_t rasters);

}  // namespace scree::gis
