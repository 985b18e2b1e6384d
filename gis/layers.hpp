// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/styles.hpp"
#include "scree/geometry/feature.hpp"
#include "scree/geometry/grid.hpp"

#include <functional>
#include <string>
#include <vector>

namespace scree::gis {

/// Which coordinates the vertices of a layer carry. M is the polyline's measure, time along trajectories [s].
enum class Coordinates { XY, XYZ, XYZM };

/// A vector layer to be written: its data and how people see it.
struct VectorLayer {
    FeatureLayer data{};  ///< name, kind, fields, and the features in the order in which they are written
    /// For layers too large to hold: fills the next feature and returns true, or returns false at the end. Called instead of
    /// reading data.features; always with the same object, so that its buffers can be used again.
    std::function<bool(Feature&)> next{};
    Coordinates coordinates = Coordinates::XYZ;
    bool multipart = false;             ///< several parts per feature; found out by itself unless `next` is used
    std::string title{};                ///< name in the legend, with the unit; empty: the name
    std::string description{};          ///< one sentence on what the layer holds
    std::string group{};                ///< heading in the legend; empty: none
    std::vector<VectorStyle> styles{};  ///< the first is the default; empty: house_styles()
    bool visible = true;                ///< switched on when the project opens
};

/// A raster layer to be written.
struct RasterLayer {
    std::string name{};                 ///< snake_case with a unit suffix: energy_kj_p95
    std::string title{};                ///< name in the legend; empty: the name
    std::string unit{};                 ///< "kJ", "m", "m/s"; "-" or empty: none
    std::string quantity_definition{};  ///< one sentence that defines the number, for the GeoPackage and the GeoTIFF
    std::string group{};                ///< heading in the legend; empty: none
    RasterTheme theme = RasterTheme::Generic;
    bool visible = false;  ///< switched on when the project opens
    Grid<float> values{};  ///< row 0 in the SOUTH; NaN: no value; in `unit` [*]
    std::function<Grid<float>()>
        make_values{};  ///< fills `values` when results are written: of two dozen rasters one is in memory at a time
};

/// One line of the account of how a result came about: the settings as text, a version, the seed, an input file's SHA-256, a count.
struct ProvenanceEntry {
    std::string key{};
    std::string value{};
};

}  // namespace scree::gis
