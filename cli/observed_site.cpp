// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/observed_site.hpp"

#include "cli/commands.hpp"
#include "cli/further_instruments.hpp"
#include "cli/observation_resolver.hpp"
#include "cli/progress.hpp"
#include "gis/dataset.hpp"
#include "scree/base/error.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <set>
#include <sstream>

namespace scree::cli {

namespace {

constexpr std::int64_t kStartsLookedAt = 200;     // blocks released to learn how high blocks start [-]
constexpr std::uint64_t kPlacesLookedAt = 20000;  // places of the release area to learn how high its ground is [-]
constexpr double kStartSlack = 0.5;               // what others may start above those [m]

/// Height of the centre of mass of the highest block that the site releases [m].
double highest_start(const SiteModel& model, const Observations& observations) {
    const CampaignInput& c = model.campaign;
    double highest = -kInfinity;
    if (model.in_plane()) {
        for (std::uint64_t k = 0; k < kPlacesLookedAt; ++k) {
            const ProfileRelease::Place place = c.profile_release->draw(c.seed, k);
            const double ground = model.terrain.surface->height(c.tracks[place.profile].profile.place_at(place.s));
            highest = std::max(highest, ground + c.release.height + c.release.height_spread);
        }
        for (const ObservedBlock& b : observations.blocks) {
            if (b.profile < 0) continue;
            const double ground = c.tracks[static_cast<std::size_t>(b.profile)].profile.height_at(b.s);
            highest = std::max(highest, ground + c.release.height + c.release.height_spread);
        }
        return highest + kStartSlack;
    }
    const std::int64_t tried = std::min(c.release.count, kStartsLookedAt);
    const auto blocks = static_cast<std::int64_t>(observations.blocks.size());
    for (std::int64_t k = 0; k < tried + blocks; ++k) {
        std::int64_t feature = 0;
        double raised = 0.0;
        const PopulationBlock block = draw_block(c.population, c.seed, static_cast<std::uint64_t>(k));
        const Vec2 fixed =
            k < tried ? Vec2::Constant(kNaN) : observations.blocks[static_cast<std::size_t>(k - tried)].release;
        const BlockState<3> state = draw_release(c.release, *c.area, *c.surface, block.body, c.seed,
                                                 static_cast<std::uint64_t>(k), feature, raised, fixed);
        highest = std::max(highest, state.position.z());
    }
    for (std::uint64_t k = 0; k < kPlacesLookedAt; ++k) {
        std::int64_t feature = 0;
        const double ground = c.surface->height(c.area->draw(c.seed, k, feature));
        highest = std::max(highest, ground + c.release.height + c.release.height_spread);
    }
    return highest + kStartSlack;
}

/// Largest speed that a release gives, its spin counted as if all of it could turn into speed; infinite where nobody knows the size of a block that spins [m/s].
double start_speed(const SiteModel& model, const Observations& observations) {
    const CampaignInput& c = model.campaign;
    double speed = c.release.speed, spin = c.release.spin;
    for (const Effect& e : c.effects) {
        if (e.kind != EffectKind::ReleaseMotion) continue;
        speed += e.value("speed");
        spin += e.value("spin");
    }
    if (spin == 0.0) return speed;
    double largest = 0.0;
    for (const BlockRow& b : c.population.list) largest = std::max(largest, b.size.maxCoeff());
    for (const ObservedBlock& b : observations.blocks)
        if (b.has_body()) largest = std::max(largest, b.size.maxCoeff());
    return largest > 0.0 ? std::hypot(speed, 0.5 * largest * spin) : kInfinity;
}

/// Any number at all: tables may hold names and times only.
bool has_values(const ObservedSite& observed) {
    if (!observed.observations.shares.empty()) return true;
    const ObservationTable measured = measured_table(observed.observations, observed.op);
    return std::ranges::any_of(measured.values, [](const std::vector<double>& column) {
        return std::ranges::any_of(column, [](double v) { return std::isfinite(v); });
    });
}

}  // namespace

ObservedSite load_observed(const SiteFile& site, const SiteModel& model, const std::string& path) {
    const gis::ObservationRecords records =
        gis::read_observations(path, model.terrain.data.frame, model.terrain.data.grid.shape.bounds());
    ObservedSite observed = resolve_observations(site, model, records);
    observed.files = gis::input_files(observed.inputs);
    if (!has_values(observed)) {
        if (std::none_of(observed.findings.begin(), observed.findings.end(),
                         [](const Finding& f) { return f.severity == Severity::Error; }))
            observed.findings.push_back(
                {Severity::Error, "nothing measured",
                 "nothing in it can be compared: stopping points need easting_m and northing_m (or longitude_deg and "
                 "latitude_deg), crossings of screens the screen (gis/README.md lists all columns)"});
        return observed;
    }

    AuditSite audit;
    audit.surface = model.terrain.surface.get();
    audit.screens = model.campaign.screens;
    audit.blocks = model.campaign.population.list;
    audit.highest_start = highest_start(model, observed.observations);
    audit.start_speed = start_speed(model, observed.observations);
    audit.gravity = model.campaign.dynamics.gravity;
    audit.frame = model.terrain.data.frame;
    for (Finding& f : audit_observations(observed.observations, observed.op, audit))
        observed.findings.push_back(std::move(f));
    std::stable_sort(observed.findings.begin(), observed.findings.end(),
                     [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
    return observed;
}

ObservedSite planned_test(const SiteFile& site, const SiteModel& model, const std::string& instruments) {
    std::set<std::string> measured;
    std::istringstream list(instruments);
    for (std::string name; std::getline(list, name, ',');) {
        if (name != "stops" && name != "speed" && name != "height" && name != "spin" && name != "impacts")
            throw InputError("--instruments knows no \"" + name +
                             "\": take some of stops, speed, height, spin, impacts");
        measured.insert(name);
    }
    CampaignInput input = model.campaign;
    input.kept_trajectories = 0;
    input.screen_span = site.settings.observed.averaging;
    input.impacts = measured.contains("impacts") ? static_cast<std::int32_t>(kPlannedImpacts) : 0;
    const CampaignResult campaign = run_campaign(
        input, [](std::int64_t) {}, InterruptScope::flag());
    gis::ObservationRecords records;
    std::vector<gis::ObservedBody> bodies;
    for (std::size_t k = 0; k < campaign.blocks.size(); ++k) {
        const BlockResult& b = campaign.blocks[k];
        bodies.push_back({"B" + std::to_string(k + 1), b.mass, b.size.x(), b.size.y(), b.size.z()});
        const auto row = static_cast<std::int64_t>(k) + 1;
        const bool stops = measured.contains("stops");  // else it is known who was thrown all the same
        records.stops.push_back({row, bodies.back(), stops ? b.stop : Vec3::Constant(kNaN), kNaN,
                                 stops && b.reason != StopReason::AtRest, false});
    }
    for (const FilmedImpact& i : campaign.impacts) {
        const auto end = [&](const FilmedImpact::End& e) {
            return gis::ImpactEnd{e.velocity.norm(), e.velocity.z(), measured.contains("spin") ? e.spin : kNaN};
        };
        records.impacts.push_back({static_cast<std::int64_t>(records.impacts.size()) + 1,
                                   bodies[static_cast<std::size_t>(i.block)], i.number + 1, end(i.before), end(i.after),
                                   kNaN, kNaN, kNaN});
    }
    for (const ScreenCrossing& c : campaign.crossings) {
        gis::CrossingRecord r;
        r.row = static_cast<std::int64_t>(records.crossings.size()) + 1;
        r.body = bodies[static_cast<std::size_t>(c.block)];
        r.screen = model.campaign.screens[static_cast<std::size_t>(c.screen)].name;
        r.position = c.position;
        if (measured.contains("speed")) r.speed = c.measured_speed;
        if (measured.contains("height")) r.height = c.height;
        if (measured.contains("spin")) r.spin = c.spin;
        records.crossings.push_back(r);
    }
    if (!measured.contains("stops") && records.crossings.empty() && records.impacts.empty())
        throw InputError("nothing would be measured: --instruments needs stops or impacts, or the site [screens]");
    SiteFile planned = site;  // its instruments would see whoever passes, though nobody does here
    for (const Screen& screen : model.campaign.screens) planned.settings.observed.watched.push_back(screen.name);
    return resolve_observations(planned, model, records);
}

std::vector<double> screen_chainages(const SiteModel& model, const Axis& axis) {
    std::vector<double> at;
    for (const Screen& screen : model.campaign.screens)
        at.push_back(screen.line.empty() ? kNaN : axis.crossing(screen.line));
    for (const ProfileTrack& track : model.campaign.tracks)
        for (const ProfileTrack::Mark& mark : track.marks) {
            double& of_screen = at[static_cast<std::size_t>(mark.screen)];
            if (std::isnan(of_screen)) of_screen = axis.place(track.profile.place_at(mark.s)).along;
        }
    return at;
}

std::int64_t blocks_of(const ObservedSite& observed) {
    const Observations& o = observed.observations;
    if (o.matched) return std::ssize(o.blocks);
    return std::max({std::int64_t{1}, o.thrown, static_cast<std::int64_t>(side_by_side(o, observed.op).rows())});
}

void match_campaign(const SiteFile& site, const ObservedSite& observed, CampaignInput& campaign) {
    campaign.screen_span = site.settings.observed.averaging;
    campaign.impacts = static_cast<std::int32_t>(observed.op.impacts);
    shift_screens(observed.op.effects, observed.op.axis, campaign);
    if (!observed.observations.matched) return;
    campaign.population.list.clear();
    for (const ObservedBlock& block : observed.observations.blocks)
        campaign.population.list.push_back({block.id, block.mass, block.size, block.release, block.profile, block.s});
    campaign.population.in_turn = true;
    campaign.release.count =
        site.settings.observed.repeats * static_cast<std::int64_t>(observed.observations.blocks.size());
}

bool print_findings(const Context& context, const ObservedSite& observed) {
    print_warnings(context, observed.warnings);
    for (const Finding& f : observed.findings)
        *context.err << (f.severity == Severity::Error ? "error: " : "warning: ") << context.observed << ": "
                     << f.sentence << "\n";
    return observed.has_errors();
}

}  // namespace scree::cli
