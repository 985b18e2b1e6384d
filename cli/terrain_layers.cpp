// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/terrain_layers.hpp"

namespace scree::cli {

gis::RasterLayer heights_layer(const SiteTerrain& terrain) {
    gis::RasterLayer layer;
    layer.name = "model_height_m";
    layer.title = "Model terrain";
    layer.unit = "m";
    layer.quantity_definition = "height of the model terrain at the centre of the cell, in the datum of the DTM";
    layer.theme = gis::RasterTheme::Terrain;
    layer.visible = true;
    layer.values = Grid<float>(terrain.data.grid.shape);
    for (std::size_t k = 0; k < terrain.data.grid.values.size(); ++k)
        layer.values.values[k] = static_cast<float>(terrain.data.grid.values[k] + terrain.data.frame.height);
    return layer;
}

}  // namespace scree::cli
