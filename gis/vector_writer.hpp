// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/layers.hpp"
#include "gis/qml.hpp"
#include "scree/geometry/local_frame.hpp"

#include <filesystem>
#include <span>
#include <vector>

namespace scree::gis {

/// What was learnt about a layer while it was written.
struct WrittenLayer {
    std::int64_t features = 0;              ///< rows [-]
    bool multipart = false;                 ///< several parts per feature
    Box2 extent;                            ///< map frame [m]
    std::vector<VectorStyle> styles;        ///< the layer's own, or the house style
    std::vector<ValueRange> colour_ranges;  ///< per style: span of the values of its field colour_by [*]
};

/// Writes the layers into a new GeoPackage in one transaction, with a spatial index each, features in the order given, shifted
/// back to the map frame. NaN becomes NULL. Layers that use `next` take 24 bytes of memory per feature.
/// Throws InputError for names, fields and geometries that do not fit (naming layer, feature and remedy), ComputeError where
/// writing fails; the file is then useless. No styles: write_results() adds them.
std::vector<WrittenLayer> write_vector_layers(const std::filesystem::path& geopackage, const LocalFrame& frame,
                                              std::span<const VectorLayer> layers);

/// Throws InputError unless the name may stand in a database and in file names: a-z, 0-9 and _, a letter first, at most 60
/// characters, no prefix of SQLite or the GeoPackage. `what` says whose name it is.
void require_table_name(const std::string& name, const std::string& what);

}  // namespace scree::gis
