// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/observation_resolver.hpp"

#include "cli/observed_releases.hpp"
#include "cli/text.hpp"
#include "scree/base/error.hpp"
#include "scree/base/units.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <map>
#include <numeric>
#include <set>
#include <sstream>

namespace scree::cli {

namespace {

/// Index of a name, added if it is new.
std::int32_t index_of(std::vector<std::string>& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<std::int32_t>(found - names.begin());
    names.push_back(name);
    return static_cast<std::int32_t>(names.size()) - 1;
}

std::int32_t find_name(const std::vector<std::string>& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? -1 : static_cast<std::int32_t>(found - names.begin());
}

/// Centre of everything that blocks are released from, by area, length or number.
Vec2 release_centre(const FeatureLayer& layer) {
    Vec2 sum = Vec2::Zero();
    double weight = 0.0;
    const auto add = [&](const Vec2& p, double w) {
        sum += w * p;
        weight += w;
    };
    for (const Feature& feature : layer.features) {
        if (const auto* polygons = std::get_if<MultiPolygon>(&feature.geometry)) {
            const auto add_ring =
                [&](const Ring& ring) {  // triangles from its first point; holes run the other way and count negative
                    for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
                        const Vec2 a = ring[i] - ring[0], b = ring[i + 1] - ring[0];
                        add(ring[0] + (a + b) / 3.0, 0.5 * cross(a, b));
                    }
                };
            for (const Polygon& polygon : *polygons) {
                add_ring(polygon.outer);
                for (const Ring& hole : polygon.holes) add_ring(hole);
            }
        } else if (const auto* lines = std::get_if<Polylines>(&feature.geometry)) {
            for (const Polyline& line : *lines)
                for (std::size_t i = 1; i < line.points.size(); ++i) {
                    const Vec2 a = line.points[i - 1].head<2>(), b = line.points[i].head<2>();
                    add(0.5 * (a + b), (b - a).norm());
                }
        } else if (const auto* points = std::get_if<Points>(&feature.geometry)) {
            for (const Vec3& p : *points) add(p.head<2>(), 1.0);
        }
    }
    return weight > 0.0 ? Vec2(sum / weight) : Vec2(Vec2::Zero());
}

/// Builds the observations of a site from the records of files.
class Resolver {
public:
    Resolver(const SiteFile& site, const SiteModel& model, const gis::ObservationRecords& records)
        : site_(site), s_(site.settings.observed), model_(model), records_(records) {}

    ObservedSite resolve() {
        result_.sources = records_.sources;
        result_.inputs = records_.files;
        result_.warnings = records_.warnings;
        if (records_.seed == std::to_string(site_.settings.seed))
            find(Severity::Warning, "same_seed",
                 "these are results of a run with model.seed = " + records_.seed +
                     ", which is that of this site: blocks that are simulated are the measured ones once more, and "
                     "look too much alike; give another with --seed");
        name_places();
        name_blocks();
        add_stops();
        add_crossings();
        add_impacts();
        add_shares();
        place_releases(site_, model_, records_.releases, result_.observations, result_.findings);
        decide_matching();
        decide_thrown();
        sort_pools();
        set_operator();
        order_screens();
        name_watched();
        return std::move(result_);
    }

private:
    void find(Severity severity, const char* check, std::string sentence) {
        result_.findings.push_back({severity, check, std::move(sentence)});
    }

    /// Names of places that the site does not have; `section` is where it could.
    void report_unknown(const char* check, const std::string& places, const std::string& section,
                        const std::set<std::string>& unknown, const std::vector<std::string>& names) {
        if (unknown.empty()) return;
        const std::set<std::string> known(names.begin(), names.end());
        find(Severity::Error, check,
             "the observations name " + places + " that the site does not have (" + listed_few(unknown) + "); it has " +
                 (known.empty() ? "none: add [" + section + "] to the site file" : listed_few(known)));
    }

    void name_places() {
        for (const Screen& screen : model_.campaign.screens)
            result_.op.screen_of.push_back(index_of(result_.op.screens, screen.name));
        for (const DepositZone& zone : model_.campaign.deposit_zones)
            result_.op.zone_areas.emplace_back(index_of(result_.op.zones, zone.name), zone.region);
    }

    /// In the order of their ids, "2" before "10": the order of rows says nothing.
    void name_blocks() {
        for (const gis::StopRecord& r : records_.stops) index_.try_emplace(r.body.id);
        for (const gis::CrossingRecord& r : records_.crossings) index_.try_emplace(r.body.id);
        for (const gis::ImpactRecord& r : records_.impacts) index_.try_emplace(r.body.id);
        index_.erase("");
        for (auto& [id, number] : index_) {
            number = static_cast<std::int32_t>(result_.observations.blocks.size());
            result_.observations.blocks.emplace_back().id = id;
        }
    }

    /// The block that a record is about, with what the record says of it; -1 without an id.
    std::int32_t block_of(const gis::ObservedBody& body) {
        if (body.id.empty()) return -1;
        const auto at = index_.find(body.id);
        ObservedBlock& block = result_.observations.blocks[static_cast<std::size_t>(at->second)];
        if (!std::isfinite(block.order)) block.order = body.order;
        if (!std::isfinite(block.mass)) block.mass = body.mass;
        block.size = block.size.array().isFinite().select(block.size, Vec3(body.l1, body.l2, body.l3));
        return at->second;
    }

    static double stated(double error, double otherwise) { return std::isfinite(error) ? error : otherwise; }

    void add_stops() {
        for (const gis::StopRecord& r : records_.stops) {
            ObservedStop stop;
            stop.row = r.row;
            stop.block = block_of(r.body);
            stop.position = r.position;
            stop.error = stated(r.error, s_.position_error);
            stop.censored = r.censored;
            stop.broken = r.broken;
            if (r.broken && s_.broken == BrokenBlocks::LeaveOut) stop.position = Vec3::Constant(kNaN);
            result_.observations.stops.push_back(stop);
        }
    }

    void add_crossings() {
        std::set<std::string> unknown;
        for (const gis::CrossingRecord& r : records_.crossings) {
            ObservedCrossing c;
            c.row = r.row;
            c.block = block_of(r.body);
            c.screen = find_name(result_.op.screens, r.screen);
            c.position = r.position;
            c.value = {r.speed, r.height, r.spin, kJoulePerKj * r.energy, r.rise};
            c.error = {stated(r.speed_error, s_.speed_error), stated(r.height_error, s_.height_error),
                       stated(r.spin_error, s_.spin_error), kJoulePerKj * stated(r.energy_error, s_.energy_error_kj),
                       stated(r.rise_error, s_.speed_error)};
            if (c.screen < 0)
                unknown.insert(r.screen);
            else
                result_.observations.crossings.push_back(c);
        }
        report_unknown("unknown_screen", "screens", "screens", unknown, result_.op.screens);
    }

    /// As what screens see that stand where an impact begins and ends.
    void add_impacts() {
        std::int64_t most = 0;
        for (const gis::ImpactRecord& r : records_.impacts) most = std::max(most, r.impact);
        result_.op.add_impacts(static_cast<std::size_t>(most));
        for (const gis::ImpactRecord& r : records_.impacts) {
            const std::int32_t block = block_of(r.body);
            for (const gis::ImpactEnd* end : {&r.before, &r.after}) {
                ObservedCrossing c;
                c.row = r.row;
                c.block = block;
                c.screen = result_.op.start_of_impact(r.impact - 1) + (end == &r.after ? 1 : 0);
                c.value = {end->speed, kNaN, end->spin, kNaN, end->rise};
                c.error = {stated(r.speed_error, s_.speed_error), 0.0, stated(r.spin_error, s_.spin_error), 0.0,
                           stated(r.rise_error, s_.speed_error)};
                result_.observations.crossings.push_back(c);
            }
        }
    }

    void add_shares() {
        std::set<std::string> unknown, seen, twice;
        for (const gis::ShareRecord& r : records_.shares) {
            if (!seen.insert(r.zone).second) twice.insert(r.zone);
            const std::int32_t zone = find_name(result_.op.zones, r.zone);
            if (zone < 0)
                unknown.insert(r.zone);
            else
                result_.observations.shares.push_back({r.row, zone, r.count, r.thrown});
        }
        const bool stops = std::any_of(result_.observations.stops.begin(), result_.observations.stops.end(),
                                       [](const ObservedStop& s) { return std::isfinite(s.position.x()); });
        if (stops && !records_.shares.empty() && records_.seed.empty())  // results of Scree have both, and agree
            find(Severity::Warning, "shares_unused",
                 "deposit_zones are not compared, as the stops say in which zone each block is");
        if (!twice.empty() && !(stops && !records_.seed.empty()))
            find(Severity::Error, "zone_twice",
                 "deposit_zones have more than one row for " + listed_few(twice) + ": add them up to one per zone");
        report_unknown("unknown_zone", "deposit zones", "deposit_zones", unknown, result_.op.zones);
    }

    void decide_matching() {
        Observations& o = result_.observations;
        if (o.blocks.empty()) return;
        std::set<std::string> without;
        for (ObservedBlock& block : o.blocks) {
            if (!block.has_body()) take_from_list(block);
            if (!block.has_body()) without.insert(block.id);
        }
        std::set<std::string> no_stop = without;  // perhaps an id that is a slip
        for (const ObservedStop& s : o.stops)
            if (s.block >= 0) no_stop.erase(o.blocks[static_cast<std::size_t>(s.block)].id);
        bool some_stops = false, all_stops = true;
        for (const ObservedStop& s : o.stops) (s.block >= 0 ? some_stops : all_stops) = s.block >= 0;
        if (some_stops && !all_stops)
            find(Severity::Error, "ids_incomplete",
                 "some stops have a block_id and some have none: complete them, or leave the column out");
        check_screens_complete();
        const auto incomplete = [](const Finding& f) { return f.check == "ids_incomplete"; };
        if (!s_.matched || std::any_of(result_.findings.begin(), result_.findings.end(), incomplete)) return;
        const auto nameless = [](const auto& record) { return record.block < 0; };
        if (std::any_of(o.stops.begin(), o.stops.end(), nameless) ||
            std::any_of(o.crossings.begin(), o.crossings.end(), nameless)) {
            find(Severity::Warning, "ids_in_some_tables",
                 "some measurements have a block_id and some have none: no block can be followed from one to the "
                 "other, so they are compared as a pool with the site's own population");
            return;
        }
        const auto blocks = static_cast<std::int64_t>(o.blocks.size());
        const bool crossed = !records_.crossings.empty();  // films of impacts alone say nothing of who passes
        if (blocks > 0 && o.stops.empty() && crossed && s_.thrown != blocks) {
            find(Severity::Warning, "only_who_passed",
                 "blocks are known from crossings alone, and those that passed no screen are in no table: they are "
                 "compared as a pool with the site's own population; list every block that was thrown in "
                 "stopping_points, without a position where none was measured, or set observed.thrown = " +
                     std::to_string(blocks) + " if no others were");
            return;
        }
        if (without.size() == o.blocks.size()) {
            find(Severity::Warning, "blocks_unknown",
                 "the measured blocks have ids, but neither observations nor block list give their mass_kg, L1_m, "
                 "L2_m, L3_m: they are compared as a "
                 "pool with the site's own population");
        } else if (!without.empty()) {
            find(Severity::Error, "blocks_unknown",
                 std::to_string(without.size()) + " of " + std::to_string(o.blocks.size()) + " measured blocks (" +
                     listed_few(without) +
                     ") have no mass_kg, L1_m, L2_m, L3_m, neither in the observations nor in the block list" +
                     (no_stop.empty() || o.stops.empty()
                          ? ""
                          : ", and " + listed_few(no_stop) +
                                " crossed a screen but stopped nowhere: a mistaken block_id?") +
                     ": complete "
                     "them, or compare pools with "
                     "--set observed.matched=false");
        } else {
            o.matched = true;
            if (s_.thrown > 0 && s_.thrown != blocks)
                find(Severity::Warning, "thrown_differs",
                     "observed.thrown = " + std::to_string(s_.thrown) + ", but " + std::to_string(blocks) +
                         " blocks have a block_id: these alone are compared; list every block that was thrown in "
                         "stopping_points, without a position where none was measured");
        }
    }

    void take_from_list(ObservedBlock& block) const {
        for (const BlockRow& row : model_.campaign.population.list) {
            if (row.id != block.id) continue;
            if (!(block.mass > 0.0)) block.mass = row.mass;
            block.size = (block.size.array() > 0.0).select(block.size, row.size);
        }
    }

    void check_screens_complete() {
        const Observations& o = result_.observations;
        std::set<std::string> mixed;
        for (std::size_t s = 0; s < result_.op.screens.size(); ++s) {
            bool with = false, without = false;
            for (const ObservedCrossing& c : o.crossings)
                if (static_cast<std::size_t>(c.screen) == s) (c.block >= 0 ? with : without) = true;
            if (with && without) mixed.insert(result_.op.screens[s]);
        }
        if (!mixed.empty())
            find(Severity::Error, "ids_incomplete",
                 "some crossings of " + listed_few(mixed) +
                     " have a block_id and some have none: complete them, or leave the column out");
    }

    void decide_thrown() {
        Observations& o = result_.observations;
        o.thrown = s_.thrown;
        if (o.thrown > 0) return;
        for (const ObservedShare& share : o.shares) o.thrown = std::max(o.thrown, share.thrown);
        o.thrown = std::max(o.thrown, static_cast<std::int64_t>(o.stops.size()));
        if (o.matched || !o.stops.empty()) o.thrown = std::max(o.thrown, static_cast<std::int64_t>(o.blocks.size()));
    }

    /// Chance is drawn by the place in a list: of a pool, too, the order of rows says nothing.
    void sort_pools() {
        Observations& o = result_.observations;
        if (o.matched) return;
        const auto sort = [](auto& records, const auto& numbers_of) {
            std::stable_sort(records.begin(), records.end(), [&](const auto& a, const auto& b) {
                const std::vector<double> of_a = numbers_of(a), of_b = numbers_of(b);
                return std::lexicographical_compare(
                    of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), [](double x, double y) {
                        return std::isnan(y) ? false : std::isnan(x) || x < y;  // what is missing first
                    });
            });
        };
        sort(o.stops, [](const ObservedStop& s) {
            return std::vector<double>{s.position.x(), s.position.y(), s.error, s.censored ? 1.0 : 0.0};
        });
        sort(o.crossings, [](const ObservedCrossing& c) {
            std::vector<double> numbers{static_cast<double>(c.screen)};
            numbers.insert(numbers.end(), c.value.begin(), c.value.end());
            numbers.insert(numbers.end(), c.error.begin(), c.error.end());
            return numbers;
        });
    }

    void set_operator() {
        ObservationOperator& op = result_.op;
        op.least_speed = s_.least_speed;
        for (const Effect& e : model_.terrain.effects)
            if (effect_info(e.kind).hook == EffectHook::Measurement) op.effects.push_back(e);
        op.lateral = s_.lateral && !model_.in_plane();  // blocks on a profile cannot leave it
        if (s_.runout_limit > 0.0) op.runout_limit = s_.runout_limit;
        op.origin = release_centre(model_.release.layer);
        std::ostringstream text;
        text << std::fixed << std::setprecision(0);
        const bool one_profile = model_.profiles && model_.profiles->traces.size() == 1;
        if (s_.axis == AxisChoice::Profile || (s_.axis == AxisChoice::Automatic && one_profile)) {
            op.axis = Axis(the_profile().place);
            text << "along the profile, from its head";
        } else if (s_.axis == AxisChoice::Line) {
            const gis::VectorData data =
                read_site_layer(site_, s_.line, "axis of the observations", {GeometryKind::LineString}, model_.terrain);
            std::vector<Vec2> line;
            std::size_t parts = 0;
            for (const Feature& feature : data.layer.features)
                for (const Polyline& part : std::get<Polylines>(feature.geometry)) {
                    ++parts;
                    for (const Vec3& p : part.points) line.push_back(p.head<2>());
                }
            if (parts != 1)
                throw InputError("The axis of the observations in '" + s_.line.file + "' has " + std::to_string(parts) +
                                 " lines, but an axis is one, from the release down the slope: join them, or leave "
                                 "one in the layer.");
            if (std::all_of(line.begin(), line.end(), [&](const Vec2& p) { return p == line.front(); }))
                throw InputError("The axis of the observations in '" + s_.line.file +
                                 "' has no length; draw it from the release down the slope.");
            op.axis = Axis(std::move(line));
            text << "along the line of " << s_.line.file << ", from its first point";
            result_.inputs.push_back(site_.resolve(s_.line.file).string());
        } else {
            double azimuth = radians_from_degrees(s_.azimuth_deg);
            std::string towards;
            if (s_.axis != AxisChoice::Azimuth) azimuth = measured_azimuth(towards);
            op.axis = Axis(op.origin, azimuth);
            const double degrees = std::fmod(degrees_from_radians(azimuth) + 360.0, 360.0);
            text << "along azimuth " << degrees << " degrees from the centre of the release area" << towards;
        }
        result_.axis_text = text.str();
    }

    /// Along the path, which is the order that blocks come by, in whatever order they were drawn.
    void order_screens() {
        ObservationOperator& op = result_.op;
        const std::vector<double> chainages = screen_chainages(model_, op.axis);
        const std::size_t count = op.screens.size() - 2 * op.impacts;
        std::vector<double> first(count, kInfinity);
        for (std::size_t k = 0; k < chainages.size(); ++k) {
            const std::vector<Vec2>& line = model_.campaign.screens[k].line;
            double at = chainages[k];
            if (std::isnan(at) && !line.empty()) at = op.axis.place(0.5 * (line.front() + line.back())).along;
            double& of_name = first[static_cast<std::size_t>(op.screen_of[k])];
            if (at < of_name) of_name = at;
        }
        std::vector<std::int32_t> order(count), place(op.screens.size());
        std::iota(order.begin(), order.end(), 0);
        std::iota(place.begin(), place.end(), 0);  // impacts stay behind
        std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
            return first[static_cast<std::size_t>(a)] < first[static_cast<std::size_t>(b)];
        });
        const std::vector<std::string> names = op.screens;
        for (std::size_t k = 0; k < count; ++k) {
            op.screens[k] = names[static_cast<std::size_t>(order[k])];
            place[static_cast<std::size_t>(order[k])] = static_cast<std::int32_t>(k);
        }
        for (std::int32_t& screen : op.screen_of) screen = place[static_cast<std::size_t>(screen)];
        for (ObservedCrossing& c : result_.observations.crossings) c.screen = place[static_cast<std::size_t>(c.screen)];
    }

    /// Who passed a screen can be told of nobody where nobody knows how many were thrown.
    void name_watched() {
        std::set<std::string> unknown;
        for (const std::string& name : s_.watched) {
            const std::int32_t screen = find_name(result_.op.screens, name);
            if (screen < 0 || result_.op.is_impact(screen))
                unknown.insert(name);
            else if (!result_.op.is_watched(screen))
                result_.op.watched.push_back(screen);
        }
        for (const std::string& name : records_.screens) {  // what a simulation passed is known
            const std::int32_t screen = find_name(result_.op.screens, name);
            if (screen >= 0 && !result_.op.is_watched(screen)) result_.op.watched.push_back(screen);
        }
        std::vector<std::string> names(result_.op.screens.begin(),
                                       result_.op.screens.end() - static_cast<std::ptrdiff_t>(2 * result_.op.impacts));
        report_unknown("watched", "screens (observed.watched)", "screens", unknown, names);
        if (!result_.op.watched.empty() && result_.observations.thrown == 0)
            find(Severity::Warning, "watched",
                 "observed.watched tells nothing where nobody knows how many blocks were thrown: set observed.thrown, "
                 "or list all of them in stopping_points");
    }

    /// That of [profile], which 3D has to trace for this.
    Profile the_profile() {
        const SiteProfiles traced = model_.profiles ? *model_.profiles : trace_site_profiles(site_, model_.terrain);
        if (!model_.profiles) {
            result_.inputs.insert(result_.inputs.end(), traced.inputs.begin(), traced.inputs.end());
            result_.warnings.insert(result_.warnings.end(), traced.warnings.begin(), traced.warnings.end());
        }
        if (traced.traces.size() != 1)
            throw InputError(site_.file.string() +
                             ": observed.axis = \"profile\" needs one profile, and [profile] gives " +
                             std::to_string(traced.traces.size()) +
                             ": take another axis, or lead one line (profile.start, profile.guide)");
        return traced.traces.front().profile;
    }

    /// From the release to the mean of the stops; where there are none, to the middle of the lowest screen or down the terrain's slope.
    double measured_azimuth(std::string& towards) const {
        Vec2 sum = Vec2::Zero();
        double count = 0.0;
        for (const ObservedStop& s : result_.observations.stops) {
            if (!std::isfinite(s.position.x())) continue;
            sum += s.position.head<2>();
            count += 1.0;
            towards = ", towards the mean of the measured stops";
        }
        const auto& screens = model_.campaign.screens;
        if (count == 0.0 && !screens.empty()) {
            double lowest = kInfinity;
            for (const Screen& screen : screens) {
                if (screen.line.empty()) continue;  // given by its chainage
                const Vec2 middle = 0.5 * (screen.line.front() + screen.line.back());
                const double height = model_.terrain.surface->height(middle);
                if (!(height < lowest)) continue;
                lowest = height;
                towards = ", towards the middle of the screen " + screen.name;
                sum = middle;
                count = 1.0;
            }
        }
        const Vec2 way = count > 0.0 ? Vec2(sum / count - result_.op.origin) : Vec2(Vec2::Zero());
        if (way.norm() > 0.0) return std::atan2(way.x(), way.y());
        towards = ", down the slope there";
        const bool on_terrain = model_.terrain.surface->facet_at(result_.op.origin) >= 0;
        const Vec3 normal = on_terrain ? model_.terrain.surface->normal(result_.op.origin) : Vec3::UnitX();
        return std::atan2(normal.x(), normal.y());
    }

    const SiteFile& site_;
    const ObservedSettings& s_;
    const SiteModel& model_;
    const gis::ObservationRecords& records_;
    struct ByNumber {
        bool operator()(const std::string& a, const std::string& b) const {
            return a.size() != b.size() ? a.size() < b.size() : a < b;
        }
    };
    std::map<std::string, std::int32_t, ByNumber> index_;  ///< of the blocks, by id
    ObservedSite result_;
};

}  // namespace

ObservedSite resolve_observations(const SiteFile& site, const SiteModel& model,
                                  const gis::ObservationRecords& records) {
    return Resolver(site, model, records).resolve();
}

}  // namespace scree::cli
