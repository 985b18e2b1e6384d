// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_profiles.hpp"
#include "cli/site_terrain.hpp"
#include "gis/dataset.hpp"
#include "scree/ensemble/campaign.hpp"

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace scree::cli {

/// Everything else that a campaign needs, read and checked against the terrain.
struct SiteModel {
    SiteTerrain terrain;
    CampaignInput campaign;                           ///< points into this object: move it as a whole only
    std::unique_ptr<ReleaseArea> area;                ///< 3D
    std::optional<SiteProfiles> profiles;             ///< 2D
    std::unique_ptr<ProfileRelease> profile_release;  ///< 2D
    gis::VectorData release;
    std::optional<gis::VectorData> screens;
    std::optional<gis::VectorData> deposit_zones;
    std::set<std::string>
        met_screens;  ///< names of those that stand where a block could pass: over ground, in 2D on a profile
    std::vector<bool> met_zones;  ///< the same of every deposit zone
    std::vector<std::string> unread_block_columns;
    std::vector<std::string> inputs;    ///< files read, as opened
    std::vector<gis::InputFile> files;  ///< on disc behind them, as they were when read
    std::vector<std::string> warnings;  ///< of everything, in order of reading

    bool in_plane() const { return profiles.has_value(); }
};

SiteModel load_site(const SiteFile& site);

/// Warns of a rolling resistance with which none of the blocks of the site could roll: a slip of units.
void warn_of_rolling(SiteModel& model);

/// What needs no file: soils, mechanics, seed, how blocks are shaped and released. For calls by the thousand with other values of such keys; the list of
/// blocks, the points of the shape "file" and everything of the terrain stay as they were loaded.
void apply_parameters(const SiteFile& site, CampaignInput& campaign);

/// Lines, or outlines of polygons, with the names in the field.
std::vector<Screen> make_screens(const gis::VectorData& data, const std::string& field);

/// The points of a block shape from text (x y z per line), OBJ or STL.
std::vector<Vec3> read_shape_points(const std::filesystem::path& file);

}  // namespace scree::cli
