// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/terrain_layers.hpp"

namespace scree::cli {

Grid<double> model_heights(const SiteTerrain& terrain) {
    Grid<double> heights(terrain.data.grid.shape);
    for (int j = 0; j < heights.shape.rows; ++j)
        for (int i = 0; i < heights.shape.columns; ++i)
            heights.at(i, j) = terrain.surface->height(heights.shape.centre(i, j));
    return heights;
}

gis::RasterLayer heights_layer(const SiteTerrain& terrain) {
    const Grid<double> heights = model_heights(terrain);
    gis::RasterLayer layer;
    layer.name = "model_height_m";
    layer.title = "Model terrain";
    layer.unit = "m";
    layer.quantity_definition = "height of the model terrain at the centre of the cell, in the datum of the DTM";
    layer.theme = gis::RasterTheme::Terrain;
    layer.visible = true;
    layer.values = Grid<float>(heights.shape);
    for (std::size_t k = 0; k < heights.values.size(); ++k)
        layer.values.values[k] = static_cast<float>(heights.values[k] + terrain.data.frame.height);
    return layer;
}

gis::VectorStyle soil_style(const SiteTerrain& terrain, const std::string& field) {
    gis::VectorStyle style{.name = "By soil", .colour_by = field};
    const std::vector<std::string>& soils = terrain.data.soils.soils;
    for (std::size_t soil = 0; soil < soils.size(); ++soil)
        style.categories.push_back({soils[soil], soils[soil], gis::category_colour(soil)});
    return style;
}

}  // namespace scree::cli
