// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/layers.hpp"

#include <algorithm>
#include <limits>
#include <string>

namespace scree::gis {

/// Smallest and largest of the values seen, in their own unit; low > high while there is none.
struct ValueRange {
    double low = std::numeric_limits<double>::infinity();    ///< [*]
    double high = -std::numeric_limits<double>::infinity();  ///< [*]

    void add(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    bool empty() const { return !(low <= high); }
};

/// A layer's look in QGIS' XML: the same pieces make a .qml file, a row of layer_styles and a layer of a project.
struct QgisStyle {
    std::string attributes{};  ///< for the root element, each after a space
    std::string elements{};    ///< inside it
};

/// Drawing, labels and aliases of a vector layer. `range` spans the values of the field style.colour_by.
QgisStyle vector_qgis_style(const VectorLayer& layer, const VectorStyle& style, const ValueRange& range);

/// Drawing of a raster layer; no value is transparent.
QgisStyle raster_qgis_style(const RasterLayer& layer);

/// A whole style file.
std::string qml_document(const QgisStyle& style);

/// The title, or the name where there is none.
template <class Layer>
const std::string& layer_title(const Layer& layer, const std::string& name) {
    return layer.title.empty() ? name : layer.title;
}

}  // namespace scree::gis
