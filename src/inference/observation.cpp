// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/inference/observation.hpp"

#include "scree/base/assert.hpp"
#include "scree/base/random.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

namespace scree {

namespace {

/// Fills one row: what the columns ask for, from what is known of a block.
class RowWriter {
public:
    RowWriter(ObservationTable& table, const ObservationOperator& op) : table_(table), op_(op) {}

    void add(std::int32_t block) {
        table_.block.push_back(block);
        for (auto& column : table_.values) column.push_back(kNaN);
    }
    void stop(Vec2 p, bool at_rest) {
        AxisPlace place = op_.axis.place(p);
        if (place.along > op_.runout_limit) {
            p += op_.axis.point(op_.runout_limit) - op_.axis.point(place.along);
            place.along = op_.runout_limit;
        }
        set({Quantity::Along}, place.along);
        set({Quantity::Lateral}, place.lateral);
        set({Quantity::Runout}, ((op_.lateral ? p : op_.axis.point(place.along)) - op_.origin).norm());
        for (std::size_t z = 0; z < op_.zones.size(); ++z)
            set({Quantity::InZone, static_cast<std::int32_t>(z)}, at_rest && in_zone(p, z) ? 1.0 : 0.0);
    }
    void rise(std::int32_t screen, double value) { set({Quantity::Rise, screen}, value); }
    void passed(std::int32_t screen, bool yes) { set({Quantity::Passed, screen}, yes ? 1.0 : 0.0); }
    void kinematics(std::int32_t screen, const KinematicValues& values) {
        for (std::size_t k = 0; k < kKinematics; ++k) set({quantity_of(k), screen}, values[k]);
    }

private:
    bool in_zone(const Vec2& p, std::size_t zone) const {
        return std::any_of(op_.zone_areas.begin(), op_.zone_areas.end(), [&](const auto& area) {
            return area.first == static_cast<std::int32_t>(zone) && area.second.contains(p);
        });
    }
    void set(const Column& column, double value) {
        const std::size_t k = table_.find(column);
        if (k < table_.columns.size()) table_.values[k].back() = value;
    }

    ObservationTable& table_;
    const ObservationOperator& op_;
};

ObservationTable empty_table(const Observations& observations, const ObservationOperator& op) {
    ObservationTable table;
    table.columns = observed_columns(observations, op);
    table.values.resize(table.columns.size());
    return table;
}

/// Who of the known blocks passed this screen is known: one of them has a record, or it was watched and nobody has.
std::vector<bool> screens_that_tell(const Observations& observations, const ObservationOperator& op) {
    std::vector<bool> found(op.screens.size(), false);
    for (const std::int32_t screen : op.watched)
        found[static_cast<std::size_t>(screen)] =
            std::none_of(observations.crossings.begin(), observations.crossings.end(),
                         [&](const ObservedCrossing& c) { return c.screen == screen; });
    for (const ObservedCrossing& c : observations.crossings)
        if (c.block >= 0) found[static_cast<std::size_t>(c.screen)] = true;
    return found;
}

bool known(const Vec2& p) {
    return std::isfinite(p.x()) && std::isfinite(p.y());
}

/// The errors of the measurements, as a simulated block draws them.
class ErrorModel {
public:
    ErrorModel(const Observations& observations, std::size_t screens)
        : matched_(observations.matched), crossings_(screens) {
        const KinematicValues none{kNaN, kNaN, kNaN, kNaN, kNaN};
        block_stop_.assign(observations.blocks.size(), kNaN);
        block_crossing_.assign(observations.blocks.size(), std::vector<KinematicValues>(screens, none));
        for (const ObservedStop& s : observations.stops) {
            if (!known(s.position.head<2>())) continue;
            stops_.push_back(s.error);
            if (s.block >= 0) block_stop_[static_cast<std::size_t>(s.block)] = s.error;
        }
        for (const ObservedCrossing& c : observations.crossings) {
            const auto screen = static_cast<std::size_t>(c.screen);
            if (c.block >= 0) block_crossing_[static_cast<std::size_t>(c.block)][screen] = c.error;
            for (std::size_t k = 0; k < kKinematics; ++k)
                if (std::isfinite(c.value[k])) crossings_[screen][k].push_back(c.error[k]);
        }
        // Drawn by their place in the list: the order of the measured rows must not matter.
        std::sort(stops_.begin(), stops_.end());
        for (auto& screen : crossings_)
            for (std::vector<double>& errors : screen) std::sort(errors.begin(), errors.end());
    }

    /// Standard deviation of a stop. Draws one number of the stream, whatever comes of it.
    double of_stop(std::int32_t block, RandomStream& random) const {
        const double drawn = random.uniform();
        const double own = matched_ && block >= 0 ? block_stop_[static_cast<std::size_t>(block)] : kNaN;
        return std::isfinite(own) ? own : pick(stops_, drawn);
    }
    double of_crossing(std::int32_t block, std::size_t screen, std::size_t kinematic, RandomStream& random) const {
        const double drawn = random.uniform();
        const double own =
            matched_ && block >= 0 ? block_crossing_[static_cast<std::size_t>(block)][screen][kinematic] : kNaN;
        return std::isfinite(own) ? own : pick(crossings_[screen][kinematic], drawn);
    }

private:
    static double pick(const std::vector<double>& errors, double drawn) {
        return errors.empty() ? 0.0 : errors[static_cast<std::size_t>(drawn * static_cast<double>(errors.size()))];
    }

    bool matched_;
    std::vector<double> stops_;                                            ///< of all stops [m]
    std::vector<std::array<std::vector<double>, kKinematics>> crossings_;  ///< per screen, of all its crossings
    std::vector<double> block_stop_;                                       ///< per block, NaN: it was not found [m]
    std::vector<std::vector<KinematicValues>> block_crossing_;             ///< per block and screen
};

/// Measurement effects, added up.
class Faults {
public:
    explicit Faults(const ObservationOperator& op) : least_speed_(op.least_speed) {
        for (const Effect& e : op.effects) {
            switch (e.kind) {
                case EffectKind::SpeedError:
                    factor_ *= 1.0 + e.value("bias");
                    variance_ += e.value("noise") * e.value("noise");
                    break;
                case EffectKind::SlowMissed:
                    least_speed_ = std::max(least_speed_, e.value("least_speed"));
                    break;
                case EffectKind::HeightDatum:
                    datum_ += e.value("offset");
                    break;
                case EffectKind::BrokenBlock:
                    at_last_impact_ = std::max(at_last_impact_, e.value("last_impact"));
                    break;
                case EffectKind::IdsShuffled:
                    shuffled_ = std::max(shuffled_, e.value("share"));
                    break;
                default:
                    break;
            }
        }
    }

    bool records(double speed) const { return speed >= least_speed_; }
    double factor() const { return factor_; }  ///< of speeds [-]
    /// Whether the block with this number in the campaign was recorded as found where it broke.
    bool found_where_it_broke(const BlockResult& b, std::uint64_t seed, std::uint64_t number) const {
        return at_last_impact_ > 0.0 && std::isfinite(b.broke_at.x()) &&
               effect_stream(seed, EffectKind::BrokenBlock, 0, number).uniform() < at_last_impact_;
    }
    /// The error drawn for the speed comes on top of that of the measurement, from a stream of its own: no other number moves with it.
    void apply(KinematicValues& values, RandomStream& random) const {
        double& speed = values[static_cast<std::size_t>(Kinematic::Speed)];
        const double noise = std::sqrt(variance_) * random.normal();
        speed = std::max(0.0, factor_ * speed + noise);
        values[static_cast<std::size_t>(Kinematic::Height)] += datum_;
    }
    /// The numbers that the blocks of one repeat of the test are recorded under.
    std::vector<std::int32_t> numbers(std::size_t blocks, std::uint64_t seed, std::uint64_t repeat) const {
        std::vector<std::int32_t> number(blocks);
        std::iota(number.begin(), number.end(), 0);
        if (shuffled_ <= 0.0) return number;
        RandomStream random = effect_stream(seed, EffectKind::IdsShuffled, 0, repeat);
        std::vector<std::size_t> mixed;
        for (std::size_t b = 0; b < blocks; ++b)
            if (random.uniform() < shuffled_) mixed.push_back(b);
        for (std::size_t k = mixed.size(); k > 1; --k) std::swap(number[mixed[k - 1]], number[mixed[random.below(k)]]);
        return number;
    }

private:
    double least_speed_ = 0.0;     ///< [m/s]
    double factor_ = 1.0;          ///< of speeds [-]
    double variance_ = 0.0;        ///< of speeds [m^2/s^2]
    double datum_ = 0.0;           ///< added to heights [m]
    double at_last_impact_ = 0.0;  ///< share of the broken blocks [-]
    double shuffled_ = 0.0;        ///< share of the blocks [-]
};

constexpr auto kRise = static_cast<std::size_t>(Kinematic::Rise);

/// Adds normal errors to what the screen would have seen, but for the rise. Speeds and the like stay positive, heights of blocks that roll need not; the numbers drawn do not depend on the values.
KinematicValues seen_at_screen(const KinematicValues& exact, const ErrorModel& errors, std::int32_t block,
                               std::size_t screen, RandomStream& random) {
    KinematicValues seen{};
    for (std::size_t k = 0; k < kRise; ++k) {
        const double error = errors.of_crossing(block, screen, k, random);
        seen[k] = exact[k] + error * random.normal();
        if (quantity_of(k) != Quantity::Height) seen[k] = std::max(0.0, seen[k]);
    }
    return seen;
}

}  // namespace

std::size_t ObservationTable::find(const Column& column) const {
    return static_cast<std::size_t>(std::find(columns.begin(), columns.end(), column) - columns.begin());
}

std::vector<Column> observed_columns(const Observations& observations, const ObservationOperator& op) {
    std::vector<Column> columns;
    const bool stops = std::any_of(observations.stops.begin(), observations.stops.end(),
                                   [](const ObservedStop& s) { return known(s.position.head<2>()); });
    if (stops) columns = {{Quantity::Along}, {Quantity::Runout}};
    if (stops && op.lateral) columns.insert(columns.begin() + 1, Column{Quantity::Lateral});
    for (std::size_t s = 0; s < op.screens.size(); ++s) {
        const auto screen = static_cast<std::int32_t>(s);
        bool any = op.is_watched(screen);
        std::array<bool, kKinematics> measured{};
        for (const ObservedCrossing& c : observations.crossings) {
            if (c.screen != screen) continue;
            any = true;
            for (std::size_t k = 0; k < kKinematics; ++k) measured[k] = measured[k] || std::isfinite(c.value[k]);
        }
        if (any && !op.is_impact(screen)) columns.push_back({Quantity::Passed, screen});
        for (std::size_t k = 0; k < kKinematics; ++k)
            if (measured[k]) columns.push_back({quantity_of(k), screen});
    }
    if (stops || !observations.shares.empty())
        for (std::size_t z = 0; z < op.zones.size(); ++z)
            columns.push_back({Quantity::InZone, static_cast<std::int32_t>(z)});
    return columns;
}

ObservationTable measured_table(const Observations& observations, const ObservationOperator& op) {
    ObservationTable table = empty_table(observations, op);
    RowWriter write(table, op);
    const std::size_t matched = observations.matched ? observations.blocks.size() : 0;
    std::vector<std::vector<const ObservedCrossing*>> crossings(matched);
    std::vector<const ObservedStop*> stops(matched, nullptr);
    for (const ObservedStop& s : observations.stops)
        if (matched > 0 && s.block >= 0) stops[static_cast<std::size_t>(s.block)] = &s;
    for (const ObservedCrossing& c : observations.crossings)
        if (matched > 0 && c.block >= 0) crossings[static_cast<std::size_t>(c.block)].push_back(&c);

    const std::vector<bool> told = screens_that_tell(observations, op);
    for (std::size_t b = 0; b < matched; ++b) {
        write.add(static_cast<std::int32_t>(b));
        if (stops[b] && known(stops[b]->position.head<2>()))
            write.stop(stops[b]->position.head<2>(), !stops[b]->censored);
        for (std::size_t s = 0; s < op.screens.size(); ++s)
            if (told[s]) write.passed(static_cast<std::int32_t>(s), false);
        for (const ObservedCrossing* c : crossings[b]) {
            write.passed(c->screen, true);
            write.kinematics(c->screen, c->value);
        }
    }
    for (const ObservedStop& s : observations.stops) {
        if ((matched > 0 && s.block >= 0) || !known(s.position.head<2>())) continue;
        write.add(-1);
        write.stop(s.position.head<2>(), !s.censored);
    }
    for (const ObservedCrossing& c : observations.crossings) {
        if (matched > 0 && c.block >= 0) continue;
        write.add(-1);
        write.passed(c.screen, true);
        write.kinematics(c.screen, c.value);
    }
    return table;
}

KinematicValues kinematics_of(const ScreenCrossing& c) {
    return {c.measured_speed, c.height, c.spin, c.energy, c.velocity.z()};
}

KinematicValues kinematics_of(const FilmedImpact::End& end) {
    return {end.velocity.norm(), kNaN, end.spin, kNaN, end.velocity.z()};
}

ObservationTable side_by_side(const ObservationTable& measured, std::int64_t thrown,
                              std::span<const ObservedShare> shares) {
    // a row of the pool holds one record: a stop (and its zone), or what one screen saw
    const auto kind_of = [&](std::size_t column) {
        return measured.columns[column].quantity == Quantity::InZone ? -1 : measured.columns[column].place;
    };
    std::vector<std::size_t> rows_known;
    std::map<std::int32_t, std::vector<std::size_t>> records;
    for (std::size_t row = 0; row < measured.rows(); ++row) {
        if (measured.block[row] >= 0) rows_known.push_back(row);
        for (std::size_t k = 0; measured.block[row] < 0 && k < measured.columns.size(); ++k) {
            if (!std::isfinite(measured.values[k][row])) continue;
            records[kind_of(k)].push_back(row);
            break;
        }
    }
    std::size_t rows = records.empty() ? 0 : static_cast<std::size_t>(std::max<std::int64_t>(thrown, 0));
    for (const auto& [kind, of_kind] : records) rows = std::max(rows, of_kind.size());
    for (const ObservedShare& s : shares)
        rows = std::max(
            rows, static_cast<std::size_t>(s.thrown) - std::min(static_cast<std::size_t>(s.thrown), rows_known.size()));
    ObservationTable table{measured.columns, {}, {}};
    for (std::size_t k = 0; k < table.columns.size(); ++k) {
        std::vector<double>& values = table.values.emplace_back();
        for (const std::size_t row : rows_known) values.push_back(measured.values[k][row]);
        const auto of_kind = records.find(kind_of(k));
        const bool unseen = std::none_of(measured.values[k].begin(), measured.values[k].end(),
                                         [](double v) { return std::isfinite(v); });
        const bool passed = table.columns[k].quantity == Quantity::Passed && (of_kind != records.end() || unseen);
        if (of_kind != records.end() && !(passed && thrown <= 0))
            for (const std::size_t row : of_kind->second) values.push_back(measured.values[k][row]);
        values.resize(rows_known.size() + rows, passed && thrown > 0 ? 0.0 : kNaN);
    }
    for (const std::size_t row : rows_known) table.block.push_back(measured.block[row]);
    table.block.resize(rows_known.size() + rows, -1);
    std::size_t counted = 0;
    for (const ObservedShare& s : shares) {
        std::vector<double>& in_zone = table.values[table.find({Quantity::InZone, s.zone})];
        if (std::any_of(in_zone.begin(), in_zone.end(), [](double v) { return std::isfinite(v); })) continue;
        const auto first = in_zone.begin(), last = first + s.thrown;
        std::fill(first, last, 0.0);
        for (std::int64_t k = 0; k < s.count && counted < static_cast<std::size_t>(s.thrown); ++k)
            *(first + static_cast<std::ptrdiff_t>(counted++)) = 1.0;
    }
    return table;
}

ObservationTable simulated_table(const CampaignResult& campaign, const Observations& observations,
                                 const ObservationOperator& op, std::uint64_t seed) {
    ObservationTable table = empty_table(observations, op);
    RowWriter write(table, op);
    const ErrorModel errors(observations, op.screens.size());
    const Faults faults(op);
    const std::size_t test = observations.matched ? observations.blocks.size() : 0;
    const bool rises = std::any_of(table.columns.begin(), table.columns.end(),
                                   [](const Column& c) { return c.quantity == Quantity::Rise; });
    std::vector<std::int32_t> numbers;
    auto next = campaign.crossings.begin();
    auto impact = campaign.impacts.begin();
    for (std::size_t k = 0; k < campaign.blocks.size(); ++k) {
        const BlockResult& b = campaign.blocks[k];
        const auto first = next;
        while (next != campaign.crossings.end() && next->block == static_cast<std::int64_t>(k)) ++next;
        if (test > 0 && k % test == 0) numbers = faults.numbers(test, seed, k / test);
        if (!b.done || b.reason == StopReason::Failed) continue;
        const std::int32_t block = test > 0 ? numbers[k % test] : -1;
        RandomStream random(seed, k, RandomPurpose::Observation);
        RandomStream noise = effect_stream(seed, EffectKind::SpeedError, 0, k);
        write.add(block);
        const double error = errors.of_stop(block, random);
        const double east = random.normal(), north = random.normal();
        const bool broken = faults.found_where_it_broke(b, seed, k);
        write.stop((broken ? b.broke_at : b.stop).head<2>() + error * Vec2(east, north),
                   broken || b.reason == StopReason::AtRest);

        // of what would be recorded
        std::vector<std::optional<KinematicValues>> exact(op.screens.size());
        const auto crossings = first_crossings({first, next}, op.screen_of, op.screens.size());
        for (std::size_t s = 0; s < crossings.size(); ++s)
            if (crossings[s] && faults.records(crossings[s]->measured_speed)) exact[s] = kinematics_of(*crossings[s]);
        for (; impact != campaign.impacts.end() && impact->block == static_cast<std::int64_t>(k); ++impact) {
            if (static_cast<std::size_t>(impact->number) >= op.impacts) continue;
            const auto start = static_cast<std::size_t>(op.start_of_impact(impact->number));
            exact[start] = kinematics_of(impact->before);
            exact[start + 1] = kinematics_of(impact->after);
        }
        for (std::size_t s = 0; s < exact.size(); ++s) {
            KinematicValues values = seen_at_screen(exact[s].value_or(KinematicValues{}), errors, block, s, random);
            if (!op.effects.empty()) faults.apply(values, noise);
            write.passed(static_cast<std::int32_t>(s), exact[s].has_value());
            if (exact[s]) write.kinematics(static_cast<std::int32_t>(s), values);
        }
        // after all others: who measures rises as well draws the same errors of the rest
        for (std::size_t s = 0; rises && s < exact.size(); ++s) {
            const double off = errors.of_crossing(block, s, kRise, random) * random.normal();
            if (exact[s]) write.rise(static_cast<std::int32_t>(s), faults.factor() * ((*exact[s])[kRise] + off));
        }
    }
    return table;
}

void ObservationOperator::add_impacts(std::size_t count) {
    for (std::size_t k = impacts; k < count; ++k) {
        for (const char* end : {"the start of impact ", "the end of impact "}) {
            screens.push_back(end + std::to_string(k + 1));
        }
    }
    impacts = std::max(impacts, count);
}

std::vector<const ScreenCrossing*> first_crossings(std::span<const ScreenCrossing> of_block,
                                                   std::span<const std::int32_t> screen_of, std::size_t screens) {
    std::vector<const ScreenCrossing*> first(screens, nullptr);
    for (const ScreenCrossing& c : of_block) {
        const std::int32_t screen = screen_of[static_cast<std::size_t>(c.screen)];
        if (screen < 0) continue;
        const ScreenCrossing*& known_first = first[static_cast<std::size_t>(screen)];
        if (!known_first || c.time < known_first->time) known_first = &c;
    }
    return first;
}

std::vector<std::vector<const ScreenCrossing*>> first_crossings_of_all(std::span<const ScreenCrossing> crossings,
                                                                       std::span<const std::int32_t> screen_of,
                                                                       std::size_t screens) {
    std::vector<std::vector<const ScreenCrossing*>> at(screens);
    for (std::size_t from = 0, to = 0; from < crossings.size(); from = to) {
        while (to < crossings.size() && crossings[to].block == crossings[from].block) ++to;
        const auto first = first_crossings(crossings.subspan(from, to - from), screen_of, screens);
        for (std::size_t k = 0; k < screens; ++k)
            if (first[k]) at[k].push_back(first[k]);
    }
    return at;
}

void shift_screens(std::span<const Effect> effects, const Axis& axis, CampaignInput& campaign) {
    const auto shift_of = [&](const std::string& screen) {
        double shift = 0.0;
        for (const Effect& e : effects)
            if (e.kind == EffectKind::ScreenShift && (e.place.screen.empty() || e.place.screen == screen))
                shift += e.value("shift");
        return shift;
    };
    for (Screen& screen : campaign.screens) {
        const double shift = shift_of(screen.name);
        if (shift == 0.0 || screen.line.empty()) continue;  // given by its chainage: a mark on the tracks below
        const double at = axis.crossing(screen.line);
        const double along = std::isfinite(at) ? at : axis.place(screen.line[screen.line.size() / 2]).along;
        const Vec2 way = axis.point(along + shift) - axis.point(along);
        for (Vec2& p : screen.line) p += way;
    }
    for (ProfileTrack& track : campaign.tracks) {
        for (ProfileTrack::Mark& mark : track.marks)
            mark.s += shift_of(campaign.screens[static_cast<std::size_t>(mark.screen)].name);
        std::erase_if(track.marks,
                      [&](const ProfileTrack::Mark& m) { return m.s <= 0.0 || m.s >= track.profile.length(); });
    }
}

}  // namespace scree
