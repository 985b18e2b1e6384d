// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/settings.hpp"

#include "cli/setting_rows.hpp"

#include <toml++/toml.h>

#include <sstream>

namespace scree::cli {

namespace {

#define AT(member)                  \
    [](SiteSettings & s) -> auto& { \
        return s.member;            \
    }
#define AT_SOIL(member)     \
    [](Soil & s) -> auto& { \
        return s.member;    \
    }

void add_site_and_terrain(std::vector<Setting<SiteSettings>>& keys) {
    const Row<SiteSettings> site{"site"}, terrain{"terrain"}, zones{"zones"};
    keys.push_back(site.text("name", AT(name), "Title of the results."));
    keys.push_back(
        terrain.path("dtm", AT(dtm), "The terrain: a raster of heights in a projected CRS in metres. Required."));
    keys.push_back(
        terrain.number("resolution", "m", kNotNegative, AT(resolution),
                       "Cell of the model, averaged from the DTM by area; 0 keeps the DTM's own. Finer terrain has "
                       "more roughness that blocks trip over: parameters belong to a resolution."));
    keys.push_back(terrain.choice("surface", kSurfaceKindNames, AT(surface),
                                  "grid: two facets a cell. tin: as few facets as the tolerance allows; its slopes may "
                                  "differ more than its heights."));
    keys.push_back(terrain.choice("diagonals", kDiagonalRuleNames, AT(diagonals),
                                  "How the cells of a grid are parted. alike: all from north-west to south-east. "
                                  "by_relief: each along the diagonal on which the ground bends less, so that rough "
                                  "ground has no grain that steers blocks."));
    keys.push_back(terrain.number("tolerance", "m", kPositive, AT(tolerance),
                                  "Largest vertical distance between tin and grid; larger smooths the terrain."));
    keys.push_back(
        terrain.flag("conforming", AT(conforming),
                     "true: facets end at the boundaries of soil zones. false: a facet has the soil at its centroid."));
    keys.push_back(terrain.path("breaklines", AT(breaklines.file),
                                "Lines or polygons that facets must not cross, such as crests or road edges."));
    keys.push_back(
        terrain.text("breaklines_layer", AT(breaklines.layer), "Layer of that file; empty if it has only one."));
    keys.push_back(zones.path("file", AT(zones.file), "Polygons of soils; without it the default soil is everywhere."));
    keys.push_back(zones.text("layer", AT(zones.layer), "Layer of that file; empty if it has only one."));
    keys.push_back(zones.text("field", AT(zones.field), "Text field with the name of a [[soil]]."));
    keys.push_back(zones.text("default", AT(default_soil), "Soil where no polygon lies; empty is the first [[soil]]."));
    keys.push_back(zones.text(
        "priority", AT(priority_field),
        "Numeric field that decides where polygons overlap, the higher wins; empty makes overlaps an error."));
}

void add_blocks(std::vector<Setting<SiteSettings>>& keys) {
    const Row<SiteSettings> blocks{"blocks"};
    keys.push_back(blocks.path("list", AT(block_list),
                               "CSV with block_id, mass_kg, L1_m, L2_m, L3_m; each block takes a row. Empty draws from "
                               "the distributions below."));
    keys.push_back(blocks.choice("order", kBlockOrderNames, AT(block_order),
                                 "random draws a row per block; in_turn takes them one after the other."));
    keys.push_back(blocks.choice(
        "shape", kBlockShapeNames, AT(shape),
        "hull: random convex body that fills the box L1 x L2 x L3. sharp, round: the same with 10, 40 corners. box, "
        "eota: the box, the same with cut edges. ellipsoid. file: given points. In 2D the same as polygons in the "
        "rectangle "
        "L1 x L2. Rounder runs farther: in 3D round has fewer corners than a hull of 50 points (blocks.points)."));
    keys.push_back(blocks.integer(
        "points", {4, 2000}, AT(points),
        "Mean number of corners of hull (ellipsoid: the number). More makes rounder blocks, which run farther."));
    keys.push_back(blocks.integer("polygon_points", {3, 100}, AT(polygon_points),
                                  "The same in 2D: mean number of corners of hull (ellipsoid: the number)."));
    keys.push_back(
        blocks.path("shape_file", AT(shape_file),
                    "Points of the shape \"file\": text with x y z per line, OBJ or STL; stretched to L1 x L2 x L3."));
    keys.push_back(
        blocks.choice("volume_law", kVolumeLawNames, AT(distribution.law),
                      "How volumes are spread when there is no list. In 2D a volume gives the L1, L2 that a 3D "
                      "block of it has in the mean."));
    keys.push_back(blocks.number("volume", "m3", kVolumes, AT(distribution.volume),
                                 "constant: the volume of every block. log_normal: the median."));
    keys.push_back(
        blocks.number("volume_min", "m3", kVolumes, AT(distribution.volume_min), "Smallest volume of the other laws."));
    keys.push_back(
        blocks.number("volume_max", "m3", kVolumes, AT(distribution.volume_max), "Largest volume of the other laws."));
    keys.push_back(blocks.number("volume_sigma", "-", kPositive, AT(distribution.sigma),
                                 "log_normal: standard deviation of ln(volume)."));
    keys.push_back(blocks.number("volume_exponent", "-", {1e-3, 20}, AT(distribution.exponent),
                                 "power_law: the number of blocks above v falls as v to the minus this."));
    keys.push_back(blocks.number("density", "kg/m3", {500, 5000}, AT(distribution.density),
                                 "Of the rock; mass = density x volume (blocks of a list bring their mass)."));
    keys.push_back(blocks.number("density_spread", "kg/m3", {0, 1000}, AT(distribution.density_spread),
                                 "Half width of a uniform spread of the density."));
    keys.push_back(blocks.number("ratio_21_min", "-", {0.05, 1}, AT(distribution.ratio_21[0]), "Smallest L2/L1."));
    keys.push_back(blocks.number("ratio_21_max", "-", {0.05, 1}, AT(distribution.ratio_21[1]), "Largest L2/L1."));
    keys.push_back(blocks.number("ratio_32_min", "-", {0.05, 1}, AT(distribution.ratio_32[0]), "Smallest L3/L2."));
    keys.push_back(blocks.number("ratio_32_max", "-", {0.05, 1}, AT(distribution.ratio_32[1]), "Largest L3/L2."));
}

void add_release(std::vector<Setting<SiteSettings>>& keys) {
    const Row<SiteSettings> release{"release"};
    keys.push_back(release.path("file", AT(release.file), "Polygons, lines or points where blocks start. Required."));
    keys.push_back(release.text("layer", AT(release.layer), "Layer of that file; empty if it has only one."));
    keys.push_back(release.integer("count", {1, 1e9}, AT(releases.count),
                                   "Blocks to throw. A share p is known to about +-sqrt(p (1-p) / count)."));
    keys.push_back(release.choice(
        "pattern", kReleasePatternNames, AT(releases.pattern),
        "random: positions uniform over polygons (by area), lines (by length), points; where features overlap, each "
        "sends its share. cells: one block after the other from the centres of the model's cells in the polygons. In "
        "2D the "
        "blocks of a feature start where profiles meet it: on their stretches inside a polygon (cells: the cells along "
        "them), where "
        "they cross a line, at the foot of a point."));
    keys.push_back(release.number("height", "m", {0, 1000}, AT(releases.height),
                                  "Of the centre of mass above the ground, vertically. A block that would touch the "
                                  "ground is lifted until it is free."));
    keys.push_back(release.number("height_spread", "m", {0, 1000}, AT(releases.height_spread),
                                  "Half width of a uniform spread of the height."));
    keys.push_back(release.number("speed", "m/s", {0, 100}, AT(releases.speed), "Initial speed."));
    keys.push_back(
        release.number("azimuth_deg", "deg", {-360, 360}, AT(azimuth_deg),
                       "Direction of the initial speed in plan view, clockwise from north. In 2D the speed points "
                       "down along the profile."));
    keys.push_back(release.number("elevation_deg", "deg", {-90, 90}, AT(elevation_deg),
                                  "Angle of the initial speed above the horizontal."));
    keys.push_back(release.number("spin", "rad/s", {0, 200}, AT(releases.spin),
                                  "Initial spin about a random axis; in 2D in a random sense."));
}

void add_model(std::vector<Setting<SiteSettings>>& keys) {
    const Row<SiteSettings> model{"model"};
    keys.push_back(model.integer(
        "dimension", {2, 3}, AT(dimension),
        "3: blocks in space. 2: polygons on the profiles of [profile], much faster; they cannot leave the "
        "line nor slow down by spreading."));
    keys.push_back(model.choice("mode", kSteppingModeNames, AT(dynamics.mode),
                                "event: steps end where a contact closes; use it. moreau_jean: the scheme of Bourrier "
                                "& Acary 2022, to compare with them, with time_step = 1e-3."));
    keys.push_back(model.number("time_step", "s", {1e-6, 0.02}, AT(dynamics.time_step),
                                "Longest step in contact. event: results have converged at 8e-3; shorter gains nothing "
                                "but with a strong drag in contact. moreau_jean: 1e-3 and "
                                "shorter."));
    keys.push_back(model.number("time_limit", "s", {0.1, 1e5}, AT(dynamics.time_limit),
                                "A block still moving then ends as time_limit."));
    keys.push_back(model.integer("seed", {0, 9e15}, AT(seed),
                                 "Seed of all random numbers: same seed, same results, byte for byte."));
    keys.push_back(
        model.number("gravity", "m/s2", {0.1, 30}, AT(dynamics.gravity), "Standard gravity unless you are elsewhere."));
    keys.push_back(
        model.number("activation_gap", "m", {1e-6, 1e-2}, AT(dynamics.activation_gap),
                     "A contact closes at this gap. Larger merges contacts that should act one after the other."));
    keys.push_back(model.number("release_gap", "m", {1e-6, 1e-1}, AT(dynamics.release_gap),
                                "A closed contact opens beyond this gap. Smaller lets sliding blocks chatter."));
    keys.push_back(
        model.number("impact_speed", "m/s", {1e-3, 1}, AT(dynamics.impact_speed),
                     "event: a faster approach is an impact that takes no time; a slower one never bounces."));
    keys.push_back(model.number("restitution_threshold", "m/s", {0, 2}, AT(dynamics.restitution_threshold),
                                "event: a slower normal approach does not bounce, nor does one below "
                                "model.impact_speed. Smaller makes endless small bounces."));
    keys.push_back(model.number("flight_step", "s", {1e-4, 0.05}, AT(dynamics.flight_step),
                                "Longest step of the rotation in flight; the path of the centre of mass is exact."));
    keys.push_back(model.number("rest_head", "m", {1e-9, 1e-2}, AT(dynamics.rest_head),
                                "Kinetic energy per weight below which a block in static equilibrium may stop."));
    keys.push_back(model.number("rest_time", "s", {0, 10}, AT(dynamics.rest_time),
                                "How long it must stay so before it counts as at rest."));
    keys.push_back(model.number(
        "solver_tolerance", "-", {1e-17, 1e-2}, AT(dynamics.solver.tolerance),
        "Largest residual of a contact problem relative to the speed at which its contacts approach; smaller is "
        "slower."));
    keys.push_back(model.flag("vertices_only", AT(dynamics.vertices_only),
                              "Leave out contacts of terrain tips and crests: only to compare with codes that lack "
                              "them; blocks then sink into crests."));
}

void add_profile(std::vector<Setting<SiteSettings>>& keys) {
    const Row<SiteSettings> profile{"profile"};
    keys.push_back(profile.choice("mode", kProfileModeNames, AT(profile_mode),
                                  "steepest: steepest lines from starting points. guided: steepest lines held near "
                                  "guiding lines, from the first point "
                                  "of each. line: the section of the terrain along the guiding lines."));
    keys.push_back(profile.path("start", AT(profile_start.file),
                                "steepest: points, lines or polygons to start from; empty takes release.file."));
    keys.push_back(
        profile.text("start_layer", AT(profile_start.layer), "Layer of that file; empty if it has only one."));
    keys.push_back(profile.number("spacing", "m", kNotNegative, AT(profile_spacing),
                                  "steepest: distance of starting points in polygons and along lines; 0: one per part "
                                  "of a feature, in its middle."));
    keys.push_back(profile.path("guide", AT(profile_guide.file), "guided, line: lines, drawn downhill."));
    keys.push_back(
        profile.text("guide_layer", AT(profile_guide.layer), "Layer of that file; empty if it has only one."));
    keys.push_back(profile.number("guide_width", "m", {0.1, 1000}, AT(profile.guide_width),
                                  "guided: at this distance the guide pulls as a slope of 45 degrees would, nearer in "
                                  "proportion. Larger leaves the line more freedom."));
    keys.push_back(profile.number("smoothing", "m", {0, 100}, AT(profile.smoothing),
                                  "Directions are those of the terrain averaged over this radius, heights never are; 0 "
                                  "follows each facet. Larger straightens lines and cuts the corners of gullies."));
    keys.push_back(profile.number("gentle_slope_deg", "deg", {0, 45}, AT(profile_gentle_slope_deg),
                                  "Where the averaged ground falls by less (tracks, platforms, pits), the line goes "
                                  "straight on in the direction of the "
                                  "slope above until steeper, lower ground. 0: in pits only."));
    keys.push_back(profile.number("memory", "m", {0.1, 1000}, AT(profile.memory),
                                  "The direction of the slope above is that of the line's last metres, this many."));
    keys.push_back(
        profile.number("longest_crossing", "m", {0, 1e4}, AT(profile.longest_crossing),
                       "A line that finds no steep ground within this length on gentle ground ends there: flat."));
    keys.push_back(profile.number("highest_rise", "m", {0, 100}, AT(profile.highest_rise),
                                  "Largest climb of the averaged ground on a crossing. A line that would climb more "
                                  "takes the way down the gentle ground, "
                                  "if that gets steep again, or ends: pit."));
    keys.push_back(profile.number("run_up", "m", {0, 1e4}, AT(profile.run_up),
                                  "Ground behind a pit in which a line ends, straight on, for blocks to run up."));
    keys.push_back(
        profile.number("head", "m", {0, 1e3}, AT(profile.head),
                       "Ground above the starting point, and above all release polygons that lie up there."));
    keys.push_back(profile.number("longest", "m", {1, 1e6}, AT(profile.longest),
                                  "A line longer than this from its starting point ends: length_limit."));
    keys.push_back(
        profile.choice("converging", kConvergingNames, AT(profile_converging),
                       "Lines that run into earlier ones. keep: they stay whole, as a 2D model wants them. merge: the "
                       "later one ends at the "
                       "junction: merged. drop: it is left out if more than half of it is shared. All are reported."));
    keys.push_back(profile.number("merge_distance", "m", {1e-3, 1000}, AT(profile_merge_distance),
                                  "Lines this near to each other run together."));
    keys.push_back(profile.number("release_distance", "m", {0, 1000}, AT(profile_release_distance),
                                  "2D: release points and lines farther than this from every profile send no blocks."));
    keys.push_back(profile.integer("pictures", {0, 1000}, AT(profile_pictures),
                                   "How many of the first profiles to draw, one picture each."));
}

void add_screens(std::vector<Setting<SiteSettings>>& keys) {
    const Row<SiteSettings> screens{"screens"}, deposits{"deposit_zones"};
    keys.push_back(screens.path(
        "file", AT(screens.file),
        "Evaluation screens: lines, or polygons whose outline counts. The first crossing of each block is recorded."));
    keys.push_back(screens.text("layer", AT(screens.layer), "Layer of that file; empty if it has only one."));
    keys.push_back(screens.text("field", AT(screens.field), "Text field with the screen's name."));
    keys.push_back(
        screens.text("chainages", AT(screen_chainages),
                     "2D: more screens, by their chainage in m on every profile: \"ES1 = 39.5, ES2 = 48.5\"."));
    keys.push_back(
        deposits.path("file", AT(deposit_zones.file), "Polygons in which blocks that came to rest are counted."));
    keys.push_back(deposits.text("layer", AT(deposit_zones.layer), "Layer of that file; empty if it has only one."));
    keys.push_back(deposits.text("field", AT(deposit_zones.field), "Text field with the zone's name."));
}

void add_output(std::vector<Setting<SiteSettings>>& keys) {
    const Row<SiteSettings> output{"output"};
    keys.push_back(output.path("directory", AT(output_directory), "Folder of the results; --output overrides it."));
    keys.push_back(
        output.integer("trajectories", {0, 1e7}, AT(trajectories), "How many of the first blocks to keep as lines."));
    keys.push_back(output.integer("impacts", {0, 10}, AT(impacts),
                                  "How many of the first impacts of every block to keep, with the motion before and "
                                  "after. An impact lies between two flights of 0.1 s and more."));
    keys.push_back(output.integer(
        "contact_problems", {0, 1e6}, AT(contact_problems),
        "How many of the contact problems above solver_tolerance to keep as text files in "
        "contact_problem_BLOCK_N.txt (N counts those of a block), for whoever wants to look into them."));
    keys.push_back(
        output.number("resolution", "m", kNotNegative, AT(result_resolution),
                      "Cell of the result rasters, in 2D of the curves along the profiles; 0 takes the model's."));
}

void add_observed(std::vector<Setting<SiteSettings>>& keys) {
    const Row<SiteSettings> observed{"observed"};
    keys.push_back(observed.flag(
        "matched", AT(observed.matched),
        "Simulate every measured block again and again with its own mass and lengths, if all of them have an id, "
        "a mass and lengths; where some have and some have not, measurements are refused. false: two pools, the "
        "measured "
        "blocks and the site's own population."));
    keys.push_back(observed.integer(
        "repeats", {5, 1e5}, AT(observed.repeats),
        "How often every measured block is simulated. Fewer is faster and leaves the gap less certain."));
    keys.push_back(observed.integer("draws", {100, 1e6}, AT(observed.draws),
                                    "Samples of chance behind every interval; fewer is faster."));
    keys.push_back(observed.flag(
        "release_positions", AT(observed.release_positions),
        "Release blocks where the observations say (release_points), else anywhere in the release area."));
    keys.push_back(observed.integer(
        "thrown", {0, 1e9}, AT(observed.thrown),
        "Blocks thrown in the test, for the shares that passed a screen; 0: as many as were measured."));
    keys.push_back(observed.texts(
        "watched", AT(observed.watched),
        "Names of screens that would have recorded every block that passed. No block passed one of these that no row "
        "of screen_crossings names; of any other screen without a row nothing is known."));
    keys.push_back(observed.number("position_error", "m", kNotNegative, AT(observed.position_error),
                                   "Standard deviation of easting and of northing of stops whose rows state none."));
    keys.push_back(observed.number(
        "speed_error", "m/s", kNotNegative, AT(observed.speed_error),
        "Likewise of speeds at screens. The simulated speeds get the same error before they are compared."));
    keys.push_back(
        observed.number("height_error", "m", kNotNegative, AT(observed.height_error), "Likewise of passing heights."));
    keys.push_back(observed.number("spin_error", "rad/s", kNotNegative, AT(observed.spin_error), "Likewise of spins."));
    keys.push_back(
        observed.number("energy_error", "kJ", kNotNegative, AT(observed.energy_error_kj), "Likewise of energies."));
    keys.push_back(observed.number(
        "averaging", "m", kNotNegative, AT(observed.averaging),
        "Length of path around a screen over which films measured the mean speed of blocks that touched "
        "the ground there; blocks in free flight have the speed of their parabola. 0: speeds at the screen."));
    keys.push_back(observed.number("least_speed", "m/s", kNotNegative, AT(observed.least_speed),
                                   "Slower passages went unseen: simulated ones then count as not passed, too."));
    keys.push_back(observed.number(
        "runout_limit", "m", kNotNegative, AT(observed.runout_limit),
        "Distance along the axis at which the survey ended: stops beyond count there, on both sides. 0: none."));
    keys.push_back(observed.choice(
        "broken", kBrokenBlocksNames, AT(observed.broken),
        "Stops of blocks that broke: keep compares them as if whole, leave_out does not compare them."));
    keys.push_back(observed.flag(
        "lateral", AT(observed.lateral),
        "false: stops are compared by their distance along the axis alone, as a model on a profile must be."));
    keys.push_back(observed.choice(
        "axis", kAxisChoiceNames, AT(observed.axis),
        "Line along which distance counts. profile: the profile of [profile], from its head, in 3D as in 2D. From the "
        "centre of the release area: measured, to the mean of the measured stops; azimuth, as given. line: a line of "
        "a file, from its first point. auto: the profile in 2D if there is one only, else measured."));
    keys.push_back(observed.number("azimuth_deg", "deg", {-360, 360}, AT(observed.azimuth_deg),
                                   "Direction of the axis \"azimuth\", clockwise from north."));
    keys.push_back(observed.path("line_file", AT(observed.line.file), "File with the line of the axis \"line\"."));
    keys.push_back(
        observed.text("line_layer", AT(observed.line.layer), "Layer of that file; empty if it has only one."));
}

void add_calibration(std::vector<Setting<SiteSettings>>& keys) {
    const Row<SiteSettings> c{"calibration"};
    keys.push_back(
        c.texts("free", AT(calibration.free),
                "What is calibrated, each as a key of this file with its range, \"soil.NAME.rolling=0.01:0.1\" "
                "(with :log at its end it is searched by ratios), or with the choices to try, "
                "\"blocks.shape=hull,box,eota\". Numbers and choices of [[soil]], [[effect]], [blocks], [release] and "
                "[model]."));
    keys.push_back(c.integer("starts", {1, 1000}, AT(calibration.search.starts),
                             "Searches, shared out among the choices, at least one each. More find remote minima."));
    keys.push_back(c.integer(
        "screening", {0, 1e5}, AT(calibration.search.screening),
        "Simulations spread over the ranges before the search, per choice; 0: four per parameter, at least 8."));
    keys.push_back(c.integer("population", {0, 1e4}, AT(calibration.search.population),
                             "Candidates of a generation, with common random numbers; 0: 4 + 3 ln(parameters)."));
    keys.push_back(c.integer("generations", {0, 1e4}, AT(calibration.search.generations), "Of each search."));
    keys.push_back(c.integer("search_repeats", {3, 1e5}, AT(calibration.search.search_repeats),
                             "How often every measured block is simulated in screening and search."));
    keys.push_back(c.integer(
        "surroundings", {0, 1e5}, AT(calibration.search.surroundings),
        "Simulations around the best point, behind estimates and intervals; 0: five per coefficient of a quadratic, "
        "at least 40. More narrow the intervals down to what the test allows."));
    keys.push_back(c.integer("repeats", {3, 1e5}, AT(calibration.search.repeats),
                             "How often every measured block is simulated there."));
    keys.push_back(c.integer("final_repeats", {5, 1e5}, AT(calibration.search.final_repeats),
                             "Likewise for the gaps before, after and held out."));
    keys.push_back(c.integer("folds", {0, 1000}, AT(calibration.search.folds),
                             "Parts into which the measured blocks are cut, each predicted from the others; 0: none."));
    keys.push_back(c.integer("draws", {100, 1e6}, AT(calibration.search.draws),
                             "Samples of the measured blocks behind the intervals."));
}

void add_diagnosis(std::vector<Setting<SiteSettings>>& keys) {
    const Row<SiteSettings> d{"diagnosis"};
    keys.push_back(d.number("level", "-", {0.001, 0.2}, AT(diagnosis.level),
                            "Share of models without a flaw that are rejected. Smaller: fewer false alarms, and only "
                            "stronger effects are seen."));
    keys.push_back(d.integer("reference_repeats", {10, 1e5}, AT(diagnosis.reference_repeats),
                             "How often every measured block is simulated by the calibrated model."));
    keys.push_back(d.integer("repeats", {5, 1e5}, AT(diagnosis.repeats),
                             "Likewise per derivative and effect: fewer blur what is visible."));
    keys.push_back(d.integer("draws", {99, 1e6}, AT(diagnosis.draws), "Samples of chance: 1 / level - 1 at least."));
    keys.push_back(d.integer("finalists", {1, 100}, AT(diagnosis.finalists),
                             "Effects that are followed to the strength and parameters that explain most."));
    keys.push_back(d.texts("without", AT(diagnosis_without),
                           "Effects that are known to be absent and not searched for: names of the report, such as "
                           "[\"forest_drag\"] where there is no forest."));
    keys.push_back(d.flag("further", AT(diagnosis_further),
                          "After UNKNOWN, say when and where an unnamed force acts; after GROUP, what else to measure. "
                          "false saves the time."));
    keys.push_back(d.integer("wide_search", {0, 10000}, AT(diagnosis.wide_search),
                             "Simulations of every block in a search all over the ranges for each form of these "
                             "effects, 40 at least, before they are followed from the best place found; forms of "
                             "theirs that leave more end earlier. 0: none, which is faster and misses strong effects "
                             "that the calibration has made up for."));
    keys.push_back(d.integer("power_search", {0, 10000}, AT(diagnosis.power_search),
                             "Simulations of every block in a search for parameters that would make up for an effect, "
                             "for each strength that NONE and a plan say would be seen. 0: none, which is faster and "
                             "promises too much of strong effects."));
    keys.push_back(d.integer(
        "rounds", {1, 100}, AT(diagnosis.rounds),
        "Surveys at the place to which an effect was followed, of simulations all around, at most; on the way "
        "there are 15 smaller ones at most."));
}

}  // namespace

std::span<const Setting<SiteSettings>> site_keys() {
    static const std::vector<Setting<SiteSettings>> keys = [] {
        std::vector<Setting<SiteSettings>> k;
        add_site_and_terrain(k);
        add_blocks(k);
        add_release(k);
        add_model(k);
        add_profile(k);
        add_screens(k);
        add_observed(k);
        add_calibration(k);
        add_diagnosis(k);
        add_output(k);
        return k;
    }();
    return keys;
}

std::span<const Setting<Soil>> soil_keys() {
    static const std::vector<Setting<Soil>> keys = [] {
        const Row<Soil> soil{"soil"};
        return std::vector<Setting<Soil>>{
            soil.text("name", AT_SOIL(name), "Name that zones refer to. Required, unique."),
            soil.number("restitution", "-", {0, 1}, AT_SOIL(restitution),
                        "e of Newton's impact law. Larger bounces higher and runs farther."),
            soil.number("friction", "-", {0, 10}, AT_SOIL(friction),
                        "mu of Coulomb friction. Larger slides less and rolls more."),
            soil.number(
                "rolling", "m", {0, 10}, AT_SOIL(rolling),
                "mu_r, lever arm of the rolling resistance: a length. Larger stops earlier, small blocks first.")};
    }();
    return keys;
}

std::string section_help(const std::string& section) {
    if (section == "effect")
        return "What acts beyond the contact law, none by default: `scree effects` lists the kinds, `scree effects "
               "KIND` "
               "explains one.";
    if (section == "site") return "What the results are called.";
    if (section == "terrain") return "The ground.";
    if (section == "soil")
        return "One or more: contact parameters of a kind of ground (Bourrier & Acary 2022, Table 1).";
    if (section == "zones") return "Where which soil lies.";
    if (section == "blocks") return "What falls.";
    if (section == "release") return "Where and how blocks start.";
    if (section == "model")
        return "The mechanics. Change with care: the defaults are those at which the statistics have converged.";
    if (section == "profile")
        return "Profiles of the terrain along lines of steepest slope: `scree profile`, the ground of the 2D model.";
    if (section == "screens") return "Where passing blocks are measured.";
    if (section == "deposit_zones") return "Where stopped blocks are counted.";
    if (section == "observed") return "How a field test measured, and how `scree compare` holds the model against it.";
    if (section == "calibration") return "What `scree calibrate` may change, and how long it looks.";
    if (section == "diagnosis") return "How long `scree diagnose` looks for what the model misses.";
    if (section == "output") return "What is written where.";
    return {};
}

std::string settings_as_toml(const SiteSettings& settings, const std::function<std::string(const std::string&)>& path) {
    std::ostringstream out;
    std::string section;
    auto soils = [&] {
        for (const Soil& soil : settings.soils) {
            out << "\n[[soil]]\n";
            for (const auto& key : soil_keys()) out << key.key << " = " << key.show(soil) << "\n";
        }
    };
    for (const auto& key : site_keys()) {
        if (key.section != section) {
            if (section == "terrain") soils();
            section = key.section;
            out << (out.str().empty() ? "[" : "\n[") << section << "]\n";
        }
        std::string value = key.show(settings);
        if (key.is_path && value != "\"\"" && value != "''") {
            const toml::table parsed = toml::parse("x = " + value);
            value = quoted(path(parsed["x"].value_or(std::string())));
        }
        out << key.key << " = " << value << "\n";
    }
    for (const EffectSettings& effect : settings.effects) out << "\n[[effect]]\n" << effect_as_toml(effect, path);
    return out.str();
}

std::string settings_manual() {
    const SiteSettings defaults;
    const Soil soil;
    std::ostringstream out;
    out << "# Keys of the site file\n\nPaths are relative to the site file. A key that is not listed here is an error. "
           "Any key can be set on the command line: "
           "`--set terrain.resolution=2`, `--set \"soil.loose waste.rolling=0.05\"`, of several soils at once with "
           "`soil.*.rolling` or `soil.sand|gravel.rolling`; `effect.KIND.KEY` means all effects of a kind, "
           "`effect.1.KEY` the second "
           "of the file.\n";
    std::string section;
    auto head = [&](const std::string& name, bool list) {
        out << "\n## " << (list ? "[[" : "[") << name << (list ? "]]" : "]") << "\n\n"
            << section_help(name) << "\n\n| key | unit | default | allowed | meaning |\n|---|---|---|---|---|\n";
    };
    auto row = [&](const auto& key, const std::string& value) {
        out << "| `" << key.key << "` | " << key.unit << " | " << (value.empty() ? "" : "`" + value + "`") << " | "
            << key.allowed << " | " << key.help << " |\n";
    };
    for (const auto& key : site_keys()) {
        if (key.section != section) {
            if (section == "terrain") {
                head("soil", true);
                for (const auto& k : soil_keys()) row(k, k.show(soil));
            }
            section = key.section;
            head(section, false);
        }
        row(key, key.show(defaults));
    }
    head("effect", true);
    for (const auto& key : effect_place_keys()) row(key, key.show(EffectSettings{}));
    for (const EffectInfo& info : effect_catalogue()) {
        out << "\n`kind = \"" << info.name << "\"`: " << info.title
            << "\n\n| key | unit | default | allowed | meaning |\n|---|---|---|---|---|\n";
        const EffectSettings standard{make_effect(info.kind), {}, {}, {}};
        for (const auto& key : effect_keys(info.kind)) row(key, key.show(standard));
    }
    return out.str();
}

}  // namespace scree::cli
