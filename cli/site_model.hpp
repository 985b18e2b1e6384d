// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_file.hpp"
#include "gis/dtm_reader.hpp"
#include "gis/resample.hpp"
#include "gis/soil_zones.hpp"
#include "gis/vector_reader.hpp"
#include "scree/ensemble/campaign.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace scree::cli {

/// The terrain of a site, ready for the mechanics, with the reports of how it came about.
struct SiteTerrain {
    gis::DtmReport dtm_report;
    double dtm_cell_x = 0.0;               ///< cell of the DTM west to east [m]
    double dtm_cell_y = 0.0;               ///< south to north [m]
    LocalFrame frame;
    Grid<double> grid;                     ///< heights at the model resolution [m]
    gis::ResampleReport resample_report;
    std::unique_ptr<Surface> surface;
    gis::SoilReport soil_report;
    std::optional<gis::VectorData> zones;  ///< polygons as read
    std::string surface_report;            ///< facets and errors, in words
    std::vector<std::string> warnings;
};

SiteTerrain load_terrain(const SiteFile& site);

/// Everything else that a campaign needs, read and checked against the terrain.
struct SiteModel {
    SiteTerrain terrain;
    CampaignInput campaign;                ///< points into this object: move it as a whole only
    std::unique_ptr<ReleaseArea> area;
    gis::VectorData release;
    std::optional<gis::VectorData> screens;
    std::optional<gis::VectorData> deposit_zones;
    std::vector<std::string> inputs;       ///< files read, as opened
    std::vector<std::string> warnings;     ///< of everything, in order of reading
};

SiteModel load_site(const SiteFile& site);

/// The points of a block shape from text (x y z per line), OBJ or STL.
std::vector<Vec3> read_shape_points(const std::filesystem::path& file);

}  // namespace scree::cli
