// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/inference/observation_audit.hpp"

#include "scree/inference/distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <map>
#include <set>
#include <sstream>

namespace scree {

namespace {

constexpr std::size_t kListed = 4;   // offenders that a sentence names [-]
constexpr double kSpeedSlack = 3.0;  // stated errors by which a speed may exceed the fall before it is impossible [-]
constexpr double kRiseSlack[] = {
    3.0, 5.0};  // stated errors by which a vertical speed may exceed the speed, doubtful and impossible [-]
constexpr double kRiseShare = 1.5, kRiseLeast = 2.0;  // and beyond so many times the speed and m/s it is impossible
constexpr std::size_t kVertical = 4;                  // of KinematicValues
constexpr double kDatumOffset = 1.0;                  // [m] beyond the blocks' own size
constexpr double kBack = 5.0;       // a block may bounce back so far from a screen that it crossed [m]
constexpr double kSameMass = 0.01;  // relative difference of masses that are the same [-]

template <class... Parts>
std::string words(const Parts&... parts) {
    std::ostringstream out;
    out.precision(4);
    (out << ... << parts);
    return out.str();
}

std::string fixed(double value, int digits) {
    std::ostringstream s;
    s << std::fixed << std::setprecision(digits) << value;
    return s.str();
}

/// A list of names that stays short: "A, B and 3 more".
class Names {
public:
    void add(const std::string& name) {
        if (count_ < kListed) text_ += (count_ ? ", " : "") + name;
        ++count_;
    }
    std::size_t count() const { return count_; }
    std::string text() const { return count_ > kListed ? words(text_, " and ", count_ - kListed, " more") : text_; }
    std::string counted(const char* one, const char* many) const {
        return words(count_, " ", count_ == 1 ? one : many);
    }

private:
    std::size_t count_ = 0;
    std::string text_;
};

/// Kinetic energy over m v^2 / 2, in the median of at least so many passages [-].
constexpr std::array kEnergyShare{0.8, 2.5};
constexpr std::size_t kLeastEnergies = 3;

/// Chi-squared of one degree of freedom less than values that fewer than one test in a thousand has by chance (Wilson & Hilferty 1931, PNAS 17:684-688).
double least_chi_squared(double freedom) {
    constexpr double kOneInAThousand = -3.0902;
    const double v = 2.0 / (9.0 * freedom);
    return freedom * std::pow(std::max(1.0 - v + kOneInAThousand * std::sqrt(v), 0.0), 3.0);
}
/// Fewer values may lie together by chance [-].
constexpr std::size_t kLeastScattered = 5;
/// The height of a release above the ground, and cells of the DTM, make up for less than this [m].
constexpr double kStartAboveGround = 10.0;

constexpr std::array<const char*, kKinematics> kErrorFields{"speed_error_ms", "height_error_m", "spin_error_rads",
                                                            "energy_error_kj", "rise_error_ms"};
constexpr std::array<const char*, kKinematics> kErrorNames{"speeds", "heights", "spins", "energies", "vertical speeds"};

class Audit {
public:
    Audit(const Observations& observations, const ObservationOperator& op, const AuditSite& site)
        : o_(observations), op_(op), site_(site) {}

    std::vector<Finding> run() {
        stops_on_terrain();
        stops_below_starts();
        datum_offset();
        speeds();
        rises();
        energies();
        densities();
        measured_once();
        block_list();
        crossings_at_screens();
        ways_of_blocks();
        shares();
        stated_errors();
        errors_beyond_scatter();
        strength();
        return std::move(findings_);
    }

private:
    void find(Severity severity, const char* check, std::string sentence) {
        findings_.push_back({severity, check, std::move(sentence)});
    }
    std::string name(std::int32_t block, std::int64_t row) const {
        return block >= 0 ? o_.blocks[static_cast<std::size_t>(block)].id : words("row ", row);
    }

    void stops_on_terrain() {
        Names off;
        bool exchanged = true;  // easting and northing, in all of them
        for (const ObservedStop& s : o_.stops) {
            if (!std::isfinite(s.position.x()) || s.censored) continue;
            if (site_.surface->facet_at(s.position.head<2>()) >= 0) continue;
            off.add(name(s.block, s.row));
            MapPoint map = site_.frame.to_map(s.position);
            std::swap(map.easting, map.northing);
            exchanged = exchanged && site_.surface->facet_at(site_.frame.to_local(map).head<2>()) >= 0;
        }
        if (off.count() > 0)
            find(Severity::Error, "stops_off_terrain",
                 words(off.counted("stop lies", "stops lie"), " off the DTM or over a hole in it (", off.text(),
                       "): no simulated block can rest there; ",
                       exchanged ? "with easting and northing exchanged they would lie on it: exchange the columns"
                                 : "check coordinates and CRS, enlarge the DTM, or mark them as censored"));
    }

    /// No block ends higher than it began: where it was let go, or where the highest block can be.
    void stops_below_starts() {
        Names above;
        for (const ObservedStop& s : o_.stops) {
            double start = site_.highest_start;
            if (s.block >= 0) {
                const Vec2& release = o_.blocks[static_cast<std::size_t>(s.block)].release;
                if (release.allFinite()) start = site_.surface->height(release) + kStartAboveGround;
            }
            if (site_.surface->height(s.position.head<2>()) > start + std::max(0.0, s.error))
                above.add(name(s.block, s.row));
        }
        if (above.count() > 0)
            find(Severity::Warning, "stop_above_start",
                 words(above.counted("block stopped", "blocks stopped"),
                       " higher than where it was let go or the site lets any go (", above.text(),
                       "), which no block does: check block_id and coordinates of stops and releases"));
    }

    void datum_offset() {
        std::vector<double> above, scatter;
        double size = 1.0;
        for (const ObservedBlock& b : o_.blocks)
            if (b.has_body()) size = std::max(size, b.size.x());
        for (const ObservedStop& s : o_.stops) {
            const double ground = site_.surface->height(s.position.head<2>());
            if (std::isfinite(s.position.z() - ground)) above.push_back(s.position.z() - ground);
        }
        if (above.size() < 3) return;
        std::sort(above.begin(), above.end());
        const double median = sample_quantile(above, 0.5);
        for (const double a : above) scatter.push_back(std::abs(a - median));
        std::sort(scatter.begin(), scatter.end());
        const double deviation = 1.4826 * sample_quantile(scatter, 0.5);  // that of a normal distribution
        if (median < -0.5 * kDatumOffset || median > size + kDatumOffset)
            find(Severity::Warning, "height_datum",
                 words("the stops lie ", fixed(median, 2), " m above the model terrain in the median, scattered by ",
                       fixed(deviation, 2),
                       " m: their heights have another datum, or the DTM is another surface; heights of stops are not "
                       "used"));
        else if (deviation > kDatumOffset)
            find(Severity::Warning, "height_scatter",
                 words("the heights of the stops scatter by ", fixed(deviation, 2),
                       " m about the model terrain: positions or DTM are less exact than that"));
    }

    /// Lowest ground that a crossing can have been at: a limit on its speed that nothing can break.
    double ground_of(const ObservedCrossing& c) const {
        double ground = site_.surface->height(c.position.head<2>());
        if (std::isfinite(ground)) return ground;
        ground = kInfinity;
        for (std::size_t k = 0; k < site_.screens.size(); ++k) {
            if (op_.screen_of[k] != c.screen) continue;
            const std::vector<Vec2>& line = site_.screens[k].line;
            for (std::size_t i = 1; i < line.size(); ++i) {
                constexpr int kSteps = 100;
                for (int j = 0; j <= kSteps; ++j) {
                    const double h = site_.surface->height(line[i - 1] + j / double{kSteps} * (line[i] - line[i - 1]));
                    if (std::isfinite(h)) ground = std::min(ground, h);
                }
            }
        }
        return ground;
    }

    void speeds() {
        if (!std::isfinite(site_.highest_start)) return;
        Names impossible, doubtful;
        double worst = 0.0, allowed = 0.0;
        std::string worst_screen;
        for (const ObservedCrossing& c : o_.crossings) {
            const double speed = c.value[0], drop = site_.highest_start - ground_of(c);
            if (!std::isfinite(speed) || !std::isfinite(drop)) continue;
            const double limit =
                std::sqrt(std::max(0.0, site_.start_speed * site_.start_speed + 2.0 * site_.gravity * drop));
            if (speed <= limit) continue;
            (speed > limit + kSpeedSlack * c.error[0] ? impossible : doubtful).add(name(c.block, c.row));
            if (speed - limit <= worst - allowed) continue;
            worst = speed;
            allowed = limit;
            worst_screen = op_.screens[static_cast<std::size_t>(c.screen)];
        }
        const std::string worst_text = words(
            "the largest is ", fixed(worst, 1), " m/s at ", worst_screen, ", where a fall from the highest start at ",
            fixed(site_.highest_start + site_.frame.height, 1), " m gives ", fixed(allowed, 1), " m/s");
        if (impossible.count() > 0)
            find(Severity::Error, "speed_above_fall",
                 words(impossible.counted("speed is", "speeds are"), " above what the drop allows (", impossible.text(),
                       "): ", worst_text, "; check units and times of the films, the release height and the screen"));
        if (doubtful.count() > 0)
            find(Severity::Warning, "speed_near_fall",
                 words(doubtful.counted("speed is", "speeds are"),
                       " above what the drop allows, within the stated error (", doubtful.text(),
                       impossible.count() > 0 ? ")" : "): " + worst_text));
    }

    /// A vertical speed is no larger than the speed, but for errors.
    void rises() {
        Names impossible, doubtful;
        double worst = 0.0, rise = 0.0, speed = 0.0;
        for (const ObservedCrossing& c : o_.crossings) {
            const double excess = std::abs(c.value[kVertical]) - c.value[0],
                         error = std::hypot(c.error[kVertical], c.error[0]);
            if (!(excess > kRiseSlack[0] * error)) continue;
            const bool beyond = excess > kRiseSlack[1] * error && excess > (kRiseShare - 1.0) * c.value[0] + kRiseLeast;
            (beyond ? impossible : doubtful).add(name(c.block, c.row));
            if (excess <= worst) continue;
            worst = excess;
            rise = c.value[kVertical];
            speed = c.value[0];
        }
        const std::string worst_text = words("the worst is ", fixed(rise, 2), " m/s at a speed of ", fixed(speed, 2),
                                             " m/s; check which films they are of, their signs and units");
        if (impossible.count() > 0)
            find(Severity::Error, "rise_above_speed",
                 words(impossible.counted("vertical speed is", "vertical speeds are"), " far above the speed there (",
                       impossible.text(), "): ", worst_text));
        if (doubtful.count() > 0)
            find(Severity::Warning, "rise_above_speed",
                 words(doubtful.counted("vertical speed is", "vertical speeds are"),
                       " above the speed there by more than three stated errors (", doubtful.text(),
                       impossible.count() > 0 ? ")" : "): " + worst_text));
    }

    /// Of a block whose speed and mass are known the kinetic energy is m v^2 / 2 and what turns, which is less than that but for a disc that spins in place.
    void energies() {
        std::vector<double> shares;
        for (const ObservedCrossing& c : o_.crossings) {
            const double speed = c.value[static_cast<std::size_t>(Kinematic::Speed)],
                         energy = c.value[static_cast<std::size_t>(Kinematic::Energy)];
            if (c.block < 0 || !(speed > 0.0) || !std::isfinite(energy)) continue;
            const double share = energy / (0.5 * o_.blocks[static_cast<std::size_t>(c.block)].mass * speed * speed);
            if (std::isfinite(share)) shares.push_back(share);
        }
        if (shares.size() < kLeastEnergies) return;
        std::sort(shares.begin(), shares.end());
        const double median = sample_quantile(shares, 0.5);
        if (median < kEnergyShare[0] || median > kEnergyShare[1])
            find(Severity::Warning, "energies",
                 words("the energies at the screens are ", fixed(median, 2), " times m v^2 / 2 in the median of ",
                       shares.size(), " passages, and ", kEnergyShare[0], " to ", kEnergyShare[1],
                       " is what blocks can have: are they in kJ, of whole blocks, with their rotation?"));
    }

    void densities() {
        Names impossible, heavy, light;
        double most = 0.0, least = kInfinity;
        for (const ObservedBlock& b : o_.blocks) {
            if (!b.has_body()) continue;
            const double density = b.mass / (b.size.x() * b.size.y() * b.size.z());
            const std::string text = words(b.id, " ", fixed(density, 0));
            if (density < kImpossibleBox[0] || density > kImpossibleBox[1])
                impossible.add(text);
            else if (density > kHeaviestBox)
                heavy.add(text);
            else if (density < kLightestBox)
                light.add(text);
            most = std::max(most, density);
            least = std::min(least, density);
        }
        const char* what = " with mass / (L1 L2 L3) ";
        if (impossible.count() > 0)
            find(Severity::Error, "density",
                 words(impossible.counted("block", "blocks"), what, "that no rock has (", impossible.text(),
                       " kg/m3): check the units, kg and m"));
        if (heavy.count() > 0)
            find(Severity::Warning, "density",
                 words(heavy.counted("block", "blocks"), what, "above ", kHeaviestBox, " kg/m3 (", heavy.text(),
                       "): too heavy for the box, so mass or lengths are wrong; they are used as they are"));
        if (light.count() > 0)
            find(Severity::Warning, "density",
                 words(light.counted("block", "blocks"), what, "below ", kLightestBox, " kg/m3 (", light.text(),
                       "): too light for the box, so mass or lengths are wrong; they are used as they are"));
    }

    void measured_once() {
        std::set<std::int32_t> stopped;
        std::set<std::pair<std::int32_t, std::int32_t>> crossed;
        Names stops, crossings;
        for (const ObservedStop& s : o_.stops)
            if (s.block >= 0 && !stopped.insert(s.block).second) stops.add(name(s.block, s.row));
        for (const ObservedCrossing& c : o_.crossings)
            if (c.block >= 0 && !crossed.insert({c.block, c.screen}).second)
                crossings.add(name(c.block, c.row) + " at " + op_.screens[static_cast<std::size_t>(c.screen)]);
        if (stops.count() > 0)
            find(Severity::Error, "duplicate_id",
                 words(stops.counted("block_id has", "block_ids have"), " more than one stop (", stops.text(),
                       "): give every throw an id of its own, also of a block thrown again"));
        if (crossings.count() > 0)
            find(Severity::Error, "duplicate_id",
                 words(crossings.counted("passage is", "passages are"), " measured more than once (", crossings.text(),
                       "): keep the first one, and give every throw a block_id of its own"));
    }

    void block_list() {
        if (site_.blocks.empty()) return;
        std::map<std::string, double> mass;
        for (const BlockRow& row : site_.blocks) mass[row.id] = row.mass;
        Names unknown, other;
        for (const ObservedBlock& b : o_.blocks) {
            const auto row = mass.find(b.id);
            if (row == mass.end())
                unknown.add(b.id);
            else if (b.has_body() && std::abs(b.mass - row->second) > kSameMass * row->second)
                other.add(words(b.id, " ", fixed(b.mass, 0), " for ", fixed(row->second, 0), " kg"));
        }
        // where no id is known at all, the list is a population and not a register of the test
        if (unknown.count() > 0 && unknown.count() < o_.blocks.size())
            find(Severity::Warning, "id_not_in_list",
                 words(unknown.counted("block_id is", "block_ids are"), " not in the block list of the site (",
                       unknown.text(), "): mass and lengths of the observations are used"));
        if (other.count() > 0)
            find(Severity::Warning, "mass_differs",
                 words(other.counted("block has", "blocks have"),
                       " another mass in the observations than in the block list (", other.text(),
                       "): that of the observations is used"));
    }

    double distance_to_screen(const ObservedCrossing& c) const {
        double nearest = kInfinity;
        for (std::size_t k = 0; k < site_.screens.size(); ++k) {
            if (op_.screen_of[k] != c.screen) continue;
            const std::vector<Vec2>& line = site_.screens[k].line;
            for (std::size_t i = 1; i < line.size(); ++i) {
                const Vec2 span = line[i] - line[i - 1], p = c.position.head<2>() - line[i - 1];
                const double share = std::clamp(p.dot(span) / std::max(span.squaredNorm(), 1e-300), 0.0, 1.0);
                nearest = std::min(nearest, (p - share * span).norm());
            }
        }
        return nearest;
    }

    void crossings_at_screens() {
        Names far;
        double farthest = 0.0;
        for (const ObservedCrossing& c : o_.crossings) {
            if (!std::isfinite(c.position.x())) continue;
            const double distance = distance_to_screen(c);
            if (distance <= kFarFromScreen || std::isinf(distance)) continue;  // given by its chainage: it has no line
            far.add(name(c.block, c.row) + " at " + op_.screens[static_cast<std::size_t>(c.screen)]);
            farthest = std::max(farthest, distance);
        }
        if (far.count() > 0)
            find(Severity::Warning, "far_from_screen",
                 words(far.counted("crossing lies", "crossings lie"), " more than ", kFarFromScreen,
                       " m from the line of its screen (", far.text(), "; the farthest by ", fixed(farthest, 1),
                       " m): check the names of the screens and where the site draws them"));
    }

    /// Chainage of every screen that crosses the axis; NaN: it does not, or has no line; starts and ends of impacts have none.
    std::vector<double> chainages() const {
        std::vector<double> at(op_.screens.size(), kNaN);
        for (std::size_t k = 0; k < site_.screens.size(); ++k)
            if (op_.screen_of[k] >= 0 && site_.screens[k].line.size() > 1) {
                double& one = at[static_cast<std::size_t>(op_.screen_of[k])];
                one = std::fmin(one, op_.axis.crossing(site_.screens[k].line));
            }
        return at;
    }

    /// What the records of one block say of its way down: past a screen, and never seen there, or back above it.
    void ways_of_blocks() {
        const std::vector<double> at = chainages();
        const std::size_t screens = at.size();
        std::vector<double> reached(o_.blocks.size(), -kInfinity), stopped(o_.blocks.size(), kNaN);
        std::vector<bool> crossed(o_.blocks.size() * screens, false), known(screens, false);
        for (const std::int32_t s : op_.watched) known[static_cast<std::size_t>(s)] = true;
        for (const ObservedStop& s : o_.stops) {
            if (s.block < 0 || !std::isfinite(s.position.x())) continue;
            const auto b = static_cast<std::size_t>(s.block);
            stopped[b] = op_.axis.place(s.position.head<2>()).along;
            reached[b] = stopped[b] - kBack;
        }
        for (const ObservedCrossing& c : o_.crossings) {
            if (c.block < 0) continue;
            const auto b = static_cast<std::size_t>(c.block), s = static_cast<std::size_t>(c.screen);
            crossed[b * screens + s] = known[s] = true;
            reached[b] = std::fmax(reached[b], at[s]);
        }
        for (std::size_t s = 0; s < screens; ++s) {
            Names back, unseen;
            for (std::size_t b = 0; b < o_.blocks.size(); ++b) {
                if (crossed[b * screens + s] && stopped[b] < at[s] - kBack) back.add(o_.blocks[b].id);
                if (known[s] && !crossed[b * screens + s] && reached[b] > at[s]) unseen.add(o_.blocks[b].id);
            }
            if (back.count() > 0)
                find(Severity::Warning, "stop_above_screen",
                     words(back.counted("block", "blocks"), " crossed ", op_.screens[s], " and stopped more than ",
                           kBack, " m above it (", back.text(),
                           "): check their numbers at the screen and at the stops"));
            if (unseen.count() > 0)
                find(
                    Severity::Warning, "not_seen_at_screen",
                    words(unseen.counted("block", "blocks"), " came past ", op_.screens[s], " without a record there (",
                          unseen.text(),
                          "), and what has none counts as not passed: if the camera missed it, complete the records or "
                          "leave the numbers of blocks away at that screen"));
        }
    }

    void shares() {
        std::int64_t sum = 0, thrown = 0;
        bool possible = true;
        for (const ObservedShare& s : o_.shares) {
            sum += s.count;
            thrown = std::max(thrown, s.thrown);
            if (s.thrown > 0 && s.count >= 0 && s.count <= s.thrown) continue;
            possible = false;
            find(Severity::Error, "share",
                 words("deposit zone ", op_.zones[static_cast<std::size_t>(s.zone)], " holds ", s.count, " of ",
                       s.thrown, " blocks: a count lies between 0 and the number thrown"));
        }
        if (possible && sum > thrown)
            find(Severity::Warning, "share",
                 words("the deposit zones hold ", sum, " of ", thrown, " blocks thrown: right only if zones overlap"));
        if (o_.thrown <= 0) return;
        std::vector<std::int64_t> passed(op_.screens.size(), 0);
        for (const ObservedCrossing& c : o_.crossings) ++passed[static_cast<std::size_t>(c.screen)];
        std::string what;
        for (std::size_t s = 0; s < passed.size(); ++s)
            if (passed[s] > o_.thrown) what = words(passed[s], " blocks crossed screen ", op_.screens[s]);
        if (static_cast<std::int64_t>(o_.stops.size()) > o_.thrown) what = words(o_.stops.size(), " blocks stopped");
        if (!what.empty())
            find(Severity::Error, "thrown", words(what, ", but only ", o_.thrown, " were thrown: set observed.thrown"));
    }

    void stated_errors() {
        std::string missing;
        const bool stops = std::any_of(o_.stops.begin(), o_.stops.end(), [](const auto& s) { return s.error > 0.0; });
        if (!o_.stops.empty() && !stops) missing += "position_error_m";
        for (std::size_t k = 0; k < kKinematics; ++k) {
            bool measured = false, stated = false;
            for (const ObservedCrossing& c : o_.crossings) {
                measured = measured || std::isfinite(c.value[k]);
                stated = stated || c.error[k] > 0.0;
            }
            if (measured && !stated) missing += (missing.empty() ? "" : ", ") + std::string(kErrorFields[k]);
        }
        if (!missing.empty())
            find(Severity::Warning, "no_error_stated",
                 words("no measurement error is stated (", missing, "): the values are taken as exact"));
    }

    struct Measured {
        double value, error;  ///< [unit of the values]
    };
    /// Values scatter by their errors, whatever else they do: is that too little? Columns that are measured together count together.
    static bool too_close(const std::vector<std::vector<Measured>>& columns) {
        double squares = 0.0, freedom = 0.0;
        for (const std::vector<Measured>& values : columns) {
            if (values.size() < kLeastScattered) return false;
            double sum = 0.0, weights = 0.0;
            for (const Measured& m : values) {
                if (!(m.error > 0.0)) return false;
                sum += m.value / (m.error * m.error);
                weights += 1.0 / (m.error * m.error);
            }
            for (const Measured& m : values) squares += std::pow((m.value - sum / weights) / m.error, 2.0);
            freedom += static_cast<double>(values.size() - 1);
        }
        return squares < least_chi_squared(freedom);
    }

    /// Errors that are stated too large make every model fit: simulated blocks are measured with them.
    void errors_beyond_scatter() {
        Names hidden;
        std::vector<std::vector<Measured>> plan(2);
        for (const ObservedStop& s : o_.stops)
            for (const Eigen::Index k : {0, 1})
                if (std::isfinite(s.position[k])) plan[static_cast<std::size_t>(k)].push_back({s.position[k], s.error});
        if (too_close(plan)) hidden.add("stops (position_error_m)");
        for (std::size_t s = 0; s < op_.screens.size(); ++s)
            for (std::size_t k = 0; k < kKinematics; ++k) {
                std::vector<Measured> values;
                for (const ObservedCrossing& c : o_.crossings)
                    if (static_cast<std::size_t>(c.screen) == s && std::isfinite(c.value[k]))
                        values.push_back({c.value[k], c.error[k]});
                if (too_close({values}))
                    hidden.add(words(kErrorNames[k], " at ", op_.screens[s], " (", kErrorFields[k], ")"));
            }
        if (hidden.count() > 0)
            find(
                Severity::Warning, "error_beyond_scatter",
                words("measured values lie closer together than their stated errors alone would scatter them, of ",
                      hidden.text(),
                      ": these errors are too large, and simulated blocks get them, too, which hides what is missing"));
    }

    void strength() {
        Names censored, broken;
        for (const ObservedStop& s : o_.stops) {
            if (s.censored) censored.add(name(s.block, s.row));
            if (s.broken) broken.add(name(s.block, s.row));
        }
        if (censored.count() > 0)
            find(Severity::Warning, "censored",
                 words(censored.counted("stop is", "stops are"), " only where a block was last seen (", censored.text(),
                       "): they count as stops there, like simulated blocks that leave the terrain"));
        if (broken.count() > 0)
            find(Severity::Warning, "broken",
                 words(broken.counted("block", "blocks"), " broke on the way (", broken.text(),
                       "): simulated blocks stay whole; see observed.broken"));
        std::map<std::int32_t, std::size_t> at_screen;
        for (const ObservedCrossing& c : o_.crossings) ++at_screen[c.screen];
        std::size_t blocks = o_.matched ? o_.blocks.size() : o_.stops.size();
        for (const auto& [screen, crossings] : at_screen)
            if (!o_.matched) blocks = std::max(blocks, crossings);
        if (blocks < kFewBlocks && o_.shares.empty())
            find(Severity::Warning, "few_blocks",
                 words("only ", blocks, blocks == 1 ? " block was" : " blocks were",
                       " measured: gaps within chance then mean little"));
    }

    const Observations& o_;
    const ObservationOperator& op_;
    const AuditSite& site_;
    std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> audit_observations(const Observations& observations, const ObservationOperator& op,
                                        const AuditSite& site) {
    return Audit(observations, op, site).run();
}

}  // namespace scree
