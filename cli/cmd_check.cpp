// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/commands.hpp"
#include "cli/profile_layers.hpp"
#include "cli/site_model.hpp"
#include "cli/text.hpp"
#include "scree/base/units.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <ostream>
#include <span>
#include <sstream>

namespace scree::cli {

namespace {

std::string fixed(double value, int digits) {
    std::ostringstream s;
    s << std::fixed << std::setprecision(digits) << value;
    return s.str();
}

std::string crs_text(const std::string& name) {
    return name.empty() ? "unknown CRS" : name;
}

std::string report_text(const gis::VectorReport& report) {
    std::string text = crs_text(report.crs_name);
    if (!report.operation.empty()) {
        text += ", transformed by " + report.operation;
        text += std::isnan(report.accuracy) ? " (accuracy unknown)" : " (accuracy " + fixed(report.accuracy, 1) + " m)";
    }
    return text;
}

std::string layer_text(const gis::VectorData& data) {
    return std::to_string(data.layer.features.size()) + " feature" + (data.layer.features.size() == 1 ? "" : "s") +
           ", " + report_text(data.report);
}

void print_terrain(std::ostream& out, const SiteTerrain& terrain, const std::string& slopes) {
    const gis::Terrain& t = terrain.data;
    const GridShape& g = t.grid.shape;
    const MapPoint low = t.frame.to_map({g.bounds().min.x(), g.bounds().min.y(), 0.0}),
                   high = t.frame.to_map({g.bounds().max.x(), g.bounds().max.y(), 0.0});
    const auto extent = [](const Vec2& from, const Vec2& to) {
        return "easting " + fixed(from.x(), 1) + " to " + fixed(to.x(), 1) + ", northing " + fixed(from.y(), 1) +
               " to " + fixed(to.y(), 1);
    };
    out << "terrain        " << t.dtm.file << " (" << t.dtm.driver << ", " << t.dtm.data_type << ")\n"
        << "               " << crs_text(t.dtm.crs_name) << "\n"
        << "               cells of " << t.dtm.cell_x << " x " << t.dtm.cell_y << " m, "
        << fixed(std::floor(1000.0 * t.dtm.valid_fraction) / 10.0, 1) << " % valid, heights "
        << fixed(t.dtm.min_height, 1) << " to " << fixed(t.dtm.max_height, 1) << " m\n"
        << "               " << extent(t.dtm.south_west, t.dtm.north_east) << "\n"
        << "model          " << g.columns << " x " << g.rows << " cells of " << g.cell << " m; differs from the DTM by "
        << fixed(t.resampling.rms_difference, 3) << " m (root mean square), " << fixed(t.resampling.max_difference, 2)
        << " m (largest)\n"
        << "               " << extent({low.easting, low.northing}, {high.easting, high.northing}) << "\n"
        << "               " << terrain.surface_report << "\n"
        << "               " << slopes << "\n";
    double area = 0.0;
    for (const double a : t.soils.area) area += a;
    for (std::size_t k = 0; k < t.soils.soils.size(); ++k)
        out << (k == 0 ? "soils          " : "               ") << t.soils.soils[k] << ": " << fixed(t.soils.area[k], 0)
            << " m2 (" << fixed(100.0 * t.soils.area[k] / std::max(area, 1e-9), 1) << " %)\n";
    if (t.soils.gap_area > 0.0)
        out << "               " << fixed(t.soils.gap_area, 0) << " m2 lie in no zone and take the default soil\n";
    if (t.soils.divided_area > 0.0)
        out << "               " << fixed(t.soils.divided_area, 0)
            << " m2 are facets on a boundary between soils, each with the soil of its centroid\n";
}

/// Slopes of the model terrain, by area: heights in the wrong unit make them absurd.
constexpr double kSteep = 60.0;  ///< half of the area: hardly a slope is so [degrees]
constexpr double kGentle = 5.0;  ///< nearly all of it: no block would go far [degrees]
std::string slope_text(const Surface& surface, std::vector<std::string>& warnings) {
    constexpr double kBin = 0.1;                                           // [degrees]
    std::vector<double> areas(static_cast<std::size_t>(90.0 / kBin) + 1);  // [m2]
    double area = 0.0;
    for (std::int64_t f = 0; f < surface.facet_count(); ++f) {
        std::array<Vec3, 3> corner;
        SoilId soil = 0;
        if (!surface.facet(f, corner, soil)) continue;
        const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
        const double slope = degrees_from_radians(std::atan2(normal.head<2>().norm(), normal.z()));
        areas[static_cast<std::size_t>(std::clamp(slope, 0.0, 90.0) / kBin)] += 0.5 * normal.z();
        area += 0.5 * normal.z();
    }
    const auto quantile = [&](double share) {
        double below = 0.0;
        for (std::size_t k = 0; k < areas.size(); ++k)
            if ((below += areas[k]) >= share * area) return (static_cast<double>(k) + 0.5) * kBin;
        return 90.0;
    };
    const double median = quantile(0.5);
    if (median > kSteep)
        warnings.push_back("half of the terrain is steeper than " + fixed(median, 0) +
                           " degrees: are its heights in metres, and its cells?");
    if (quantile(0.95) < kGentle)
        warnings.push_back("95 % of the terrain are gentler than " + fixed(quantile(0.95), 1) +
                           " degrees: are its heights in metres, and its cells?");
    return "slopes of " + fixed(quantile(0.05), 0) + ", " + fixed(median, 0) + " and " + fixed(quantile(0.95), 0) +
           " degrees (5 %, half and 95 % of the area lie below)";
}

/// What the first blocks of a distribution are.
std::string drawn_blocks(const CampaignInput& c) {
    constexpr std::uint64_t kTried = 200;
    const BlockPopulation population = reshaped(c.population, c.effects);
    Eigen::Array3d low = Eigen::Array3d::Constant(kInfinity), high = -low;
    for (std::uint64_t k = 0; k < kTried; ++k) {
        const ConvexBlock block = draw_block(population, c.seed, k).body;
        const Eigen::Array3d own(block.volume, block.mass, block.size.x());
        low = low.min(own);
        high = high.max(own);
    }
    const auto range = [&](const auto& text, int k) {
        const std::string from = text(low[k]), to = text(high[k]);
        return from == to ? from : from + " to " + to;
    };
    const auto whole = [](double v) { return fixed(v, 0); };
    const auto hundredths = [](double v) { return fixed(v, 2); };
    return range(short_number, 0) + " m3, " + range(whole, 1) + " kg, L1 " + range(hundredths, 2) + " m (the first " +
           std::to_string(kTried) + ")";
}

void print_blocks(std::ostream& out, const SiteModel& m) {
    const BlockPopulation& p = m.campaign.population;
    if (p.list.empty()) {
        out << "blocks         drawn from distributions, volume law "
            << kVolumeLawNames[static_cast<std::size_t>(p.distribution.law)] << ": " << drawn_blocks(m.campaign);
    } else {
        auto [light, heavy] = std::minmax_element(p.list.begin(), p.list.end(),
                                                  [](const auto& a, const auto& b) { return a.mass < b.mass; });
        auto [small, large] = std::minmax_element(p.list.begin(), p.list.end(),
                                                  [](const auto& a, const auto& b) { return a.size.x() < b.size.x(); });
        out << "blocks         " << p.list.size() << (p.list.size() == 1 ? " row, " : " rows, ")
            << fixed(light->mass, 0) << " to " << fixed(heavy->mass, 0) << " kg, L1 " << fixed(small->size.x(), 2)
            << " to " << fixed(large->size.x(), 2) << " m";
    }
    out << "; shape " << kBlockShapeNames[static_cast<std::size_t>(p.shape.shape)] << "\n";
    std::string names;
    for (const std::string& name : m.unread_block_columns) names += (names.empty() ? "" : ", ") + name;
    if (!names.empty())
        out << "               columns that are not read: " << names << "; every row is as likely as any other\n";
}

/// A volume or a mass in a release layer looks as if it mattered: say that it does not.
void print_unread_fields(std::ostream& out, const FeatureLayer& layer) {
    std::string names;
    for (const Field& field : layer.fields) names += (names.empty() ? "" : ", ") + field.name;
    if (!names.empty()) out << "               fields that are not read: " << names << " (blocks come from [blocks])\n";
}

/// Height of the centre of mass of block `key` at its start.
double height_of_release(const CampaignInput& c, const BlockPopulation& population, std::span<const GroundLine> grounds,
                         std::uint64_t key, double& raised) {
    if (!c.tracks.empty()) {
        const ProfileRelease::Place place = c.profile_release->draw(c.seed, key);
        const PopulationPolygon block = draw_polygon(population, c.seed, key);
        return draw_release(c.release, place.s, grounds[place.profile], block.body, c.seed, key, raised).position.y();
    }
    std::int64_t feature = 0;
    const PopulationBlock block = draw_block(population, c.seed, key);
    return draw_release(c.release, *c.area, *c.surface, block.body, c.seed, key, feature, raised).position.z();
}

/// The profiles of a 2D model, with what stands along them.
void print_profiles(std::ostream& out, const SiteModel& m) {
    const std::size_t shown = std::min<std::size_t>(m.campaign.tracks.size(), 20);
    for (std::size_t k = 0; k < shown; ++k) {
        const ProfileTrack& track = m.campaign.tracks[k];
        const ProfileFacts facts = facts_of(m.profiles->traces[k], m.campaign.soils.size());
        std::string head = "profile " + std::to_string(k + 1);
        head.resize(std::max<std::size_t>(head.size() + 1, 15), ' ');
        out << head << profile_words(m.profiles->traces[k], facts)
            << (m.profile_release->used()[k] ? "" : "; no block starts on it") << "\n";
        for (const ProfileTrack::Mark& mark : track.marks)
            out << "               screen " << m.campaign.screens[static_cast<std::size_t>(mark.screen)].name
                << " at s = " << fixed(mark.s, 1) << " m\n";
        for (std::size_t z = 0; z < m.campaign.deposit_zones.size(); ++z)
            for (const Stretch& s :
                 track.profile.inside(std::get<MultiPolygon>(m.deposit_zones->layer.features[z].geometry)))
                out << "               deposit zone " << m.campaign.deposit_zones[z].name
                    << " from s = " << fixed(s.from, 1) << " to " << fixed(s.to, 1) << " m\n";
    }
    if (m.campaign.tracks.size() > shown)
        out << "               ... " << m.campaign.tracks.size() - shown << " more profiles\n";
}

/// What the first blocks would start with: heights over the ground and how many had to be lifted.
void print_release(std::ostream& out, const SiteModel& m) {
    const CampaignInput& c = m.campaign;
    out << "release        " << layer_text(m.release) << "; " << c.release.count
        << (c.release.count == 1 ? " block from " : " blocks from ") << c.release.height << " m above the ground\n";
    print_unread_fields(out, m.release.layer);
    const BlockPopulation population = reshaped(c.population, c.effects);
    const std::int64_t tried = std::min<std::int64_t>(c.release.count, 200);
    std::vector<GroundLine> grounds;
    for (const ProfileTrack& track : c.tracks) grounds.emplace_back(track.profile);
    std::int64_t lifted = 0;
    double most = 0.0, low = kInfinity, high = -kInfinity;
    for (std::int64_t k = 0; k < tried; ++k) {
        double raised = 0.0;
        const double height = height_of_release(c, population, grounds, static_cast<std::uint64_t>(k), raised);
        lifted += raised > 0.0 ? 1 : 0;
        most = std::max(most, raised);
        low = std::min(low, height);
        high = std::max(high, height);
    }
    out << (tried == 1 ? std::string("               it starts")
                       : "               the first " + std::to_string(tried) + " start")
        << " at heights " << fixed(low + m.terrain.data.frame.height, 1) << " to "
        << fixed(high + m.terrain.data.frame.height, 1) << " m; "
        << (lifted == 0 ? "all of them free of the ground"
                        : std::to_string(lifted) + " had to be lifted to start free of the ground, by up to " +
                              fixed(most, 2) + " m")
        << "\n";
}

}  // namespace

ExitCode run_check(const Context& context) {
    const SiteFile site = context.read_site();
    SiteModel model = load_site(site);
    warn_of_rolling(model);
    const std::string slopes = slope_text(*model.terrain.surface, model.warnings);
    print_warnings(context, model.warnings);
    if (context.quiet) return ExitCode::Done;
    std::ostream& out = *context.out;
    out << "site           " << site.settings.name << " (" << site.file.string() << ")\n";
    print_terrain(out, model.terrain, slopes);
    if (model.terrain.data.zones) out << "zones          " << report_text(*model.terrain.data.zones) << "\n";
    if (model.terrain.data.breaklines) out << "breaklines     " << report_text(*model.terrain.data.breaklines) << "\n";
    if (model.in_plane()) print_profiles(out, model);
    for (std::size_t k = 0; k < site.settings.effects.size(); ++k)
        out << (k == 0 ? "effects        " : "               ") << effect_text(site.settings.effects[k]) << "\n";
    print_blocks(out, model);
    print_release(out, model);
    if (model.screens) out << "screens        " << layer_text(*model.screens) << "\n";
    if (model.deposit_zones) out << "deposit zones  " << layer_text(*model.deposit_zones) << "\n";
    out << "Inputs are good" << (model.warnings.empty() ? "" : ", with warnings") << ". Next: scree run "
        << shell_word(site.file.string());
    for (const std::string& change : context.changes) out << " --set " << shell_word(change);
    out << "\n";
    return ExitCode::Done;
}

}  // namespace scree::cli
