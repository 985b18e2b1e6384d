// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/layers.hpp"
#include "gis/results_folder.hpp"
#include "scree/geometry/local_frame.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace scree::gis {

/// A file that goes into the folder as it is: run.toml, report.html, figures/map.svg.
struct TextFile {
    std::string name{};  ///< may begin with the name of one folder
    std::string text{};
};

/// Everything that a command hands over to be opened in a GIS.
struct ResultsPackage {
    LocalFrame frame{};
    std::string title = "Scree";         ///< of the project and the metadata
    std::vector<VectorLayer> vectors{};  ///< as they lie on the map, topmost first
    std::vector<RasterLayer> rasters{};  ///< below the vectors, topmost first
    std::vector<ProvenanceEntry> provenance{};
    std::vector<TextFile> files{};
};

/// Writes into the folder
///     results.gpkg       all layers, their styles, the table `run` and the metadata
///     rasters/NAME.tif   each raster as a Cloud Optimized GeoTIFF, with its style NAME.qml
///     results.qgs        a QGIS project that opens everything, grouped and styled, wherever the folder is moved
///     SHA256SUMS         the hash of every file
/// and the package's own text files. The same package gives the same bytes. The folder appears complete or not at all. Throws
/// InputError for what the caller can mend (see require_free_results_folder and the writers), ComputeError where writing fails.
void write_results(const std::filesystem::path& folder, const ResultsPackage& package, bool overwrite);

}  // namespace scree::gis
