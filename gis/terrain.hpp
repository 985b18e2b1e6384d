// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/dtm_reader.hpp"
#include "gis/resample.hpp"
#include "gis/soil_zones.hpp"
#include "gis/triangulate.hpp"
#include "gis/vector_reader.hpp"

#include <optional>
#include <string>
#include <vector>

namespace scree::gis {

enum class Surface { Grid, Tin };

struct TerrainSource {
    std::string dtm;                  ///< raster of heights
    double resolution = 0.0;          ///< of the model; 0: the larger edge of the raster's cells [m]
    Surface surface = Surface::Grid;  ///< facets: two a cell, or few within a tolerance
    double tolerance = 0.1;  ///< of a Tin: largest vertical distance between a node of the grid and the surface [m]
    DiagonalRule diagonals = DiagonalRule::Alike;
    bool conforming = false;       ///< true: facets do not cross the boundaries of soil zones
    std::string zones_file;        ///< polygons with soils; empty: the default soil everywhere
    std::string zones_layer;       ///< empty: the only one
    SoilZoneSettings zones;        ///< names of soils, fields
    std::string breaklines_file;   ///< lines (or polygons) that facets must not cross; empty: none
    std::string breaklines_layer;  ///< empty: the only one
    DtmSettings limits;
};

/// All that a model needs to know of the ground, and what was done to get it.
struct Terrain {
    LocalFrame frame;
    Grid<double> grid;  ///< heights at cell centres, local frame [m]
    std::optional<TriangleMesh>
        mesh;  ///< for a Tin, conforming facets or breaklines, with soils; none: the facets are those of the grid
    std::vector<SoilId>
        grid_soil;  ///< soil of the grid's facets (numbered as in assign_soils); empty where there is a mesh

    DtmReport dtm;
    ResampleReport resampling;
    std::optional<VectorReport> zones;
    std::optional<VectorReport> breaklines;
    std::optional<TriangulationReport> triangulation;
    SoilReport soils;

    /// The warnings of all reports, in the order of the work.
    std::vector<std::string> warnings() const;
};

/// The first half: reads and resamples the DTM. No facets yet. Throws InputError.
Terrain read_grid(const TerrainSource& source);
/// The second half: triangulates the heights of the grid, changed or not, and lays soils onto the facets. Throws InputError.
void add_facets(const TerrainSource& source, Terrain& terrain);

}  // namespace scree::gis
