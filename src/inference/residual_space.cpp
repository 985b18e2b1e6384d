// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/inference/residual_space.hpp"

#include "scree/base/assert.hpp"
#include "scree/base/random.hpp"
#include "scree/inference/distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <sstream>

namespace scree {

namespace {

const double kLevel = std::sqrt(12.0), kSpread = std::sqrt(180.0);
/// Shares are scaled by about their standard deviation, so that all residuals are of order one [-].
constexpr double kPassedScale = 0.5, kWindowScale = 0.3;
/// Columns of a table have numbers of their own for ties up to so many [-].
constexpr std::size_t kMostColumns = 128;
/// Neighbours are the nearest of so many times as many in speed [-].
constexpr std::size_t kPoolShare = 4;
/// Standardised logarithms of masses and heights [m] that make two states as unlike as the speeds of such a pool do.
constexpr double kMassUnit = 2.0, kHeightUnit = 1.0;

/// What a block does along the whole of its path.
bool is_course(Quantity q) {
    return q == Quantity::Along || q == Quantity::Speed;
}

/// The speed says what the energy would.
bool is_level(const Column& c, const ObservationTable& table) {
    if (c.quantity == Quantity::Energy) return table.find({Quantity::Speed, c.place}) == table.columns.size();
    return c.quantity != Quantity::Passed && c.quantity != Quantity::InZone && c.quantity != Quantity::Runout;
}

/// Logarithms, orders: zero mean and unit variance over the blocks of the test; empty where they do not vary.
std::vector<double> standardised(std::vector<double> values) {
    double sum = 0.0, squares = 0.0;
    std::size_t count = 0;
    for (const double v : values) {
        if (!std::isfinite(v)) continue;
        sum += v;
        squares += v * v;
        ++count;
    }
    if (count < ResidualSpace::kLeastRows) return {};
    const double n = static_cast<double>(count), mean = sum / n, variance = squares / n - mean * mean;
    if (!(variance > 1e-12 * (1.0 + mean * mean))) return {};
    for (double& v : values) v = (v - mean) / std::sqrt(variance);
    return values;
}

/// The k-th of non-negative values in ascending order, k from 1: by counting, as sorting so few of them costs what mispredicted branches do. `classes` is room for as many.
double kth_smallest(const std::vector<double>& values, std::size_t k, std::vector<std::int32_t>& classes) {
    constexpr std::size_t kLast = 127;
    constexpr double kClasses = 64.0;  // to a unit; the last one is open
    for (std::size_t i = 0; i < values.size(); ++i)
        classes[i] = static_cast<std::int32_t>(std::min(static_cast<double>(kLast), values[i] * kClasses));
    std::array<std::uint32_t, kLast + 1> count{};
    for (const std::int32_t c : classes) ++count[static_cast<std::size_t>(c)];
    std::int32_t c = 0;
    for (; k > count[static_cast<std::size_t>(c)]; ++c) k -= count[static_cast<std::size_t>(c)];
    std::vector<double> members;
    members.reserve(count[static_cast<std::size_t>(c)]);
    for (std::size_t i = 0; i < values.size(); ++i)
        if (classes[i] == c) members.push_back(values[i]);
    const auto kth = members.begin() + static_cast<std::ptrdiff_t>(k) - 1;
    std::nth_element(members.begin(), kth, members.end());
    return *kth;
}

/// A tie is broken by a number that depends on the value's place only.
double tie_breaker(std::uint64_t seed, std::size_t row, std::size_t column) {
    return RandomStream(seed, row * 2 * kMostColumns + column, RandomPurpose::Observation).uniform();
}

}  // namespace

ResidualSpace::ResidualSpace(ObservationTable reference, const ObservationTable& measured,
                             std::span<const ObservedBlock> blocks, const ResidualSettings& settings,
                             std::span<const Residual> residuals)
    : reference_(std::move(reference)), settings_(settings), known_(!blocks.empty()) {
    SCREE_ASSERT(reference_.columns == measured.columns);
    std::vector<double> mass, shape, order;
    for (const ObservedBlock& b : blocks) {
        mass.push_back(b.has_body() ? std::log(b.mass) : kNaN);
        shape.push_back(b.has_body() ? std::log(b.size.maxCoeff() / b.size.minCoeff()) : kNaN);
        order.push_back(b.order);
    }
    log_mass_ = standardised(mass);
    log_shape_ = standardised(shape);
    order_ = standardised(order);
    const std::int32_t last =
        reference_.block.empty() ? -1 : *std::max_element(reference_.block.begin(), reference_.block.end());
    sorted_.resize(reference_.columns.size());
    pooled_.resize(reference_.columns.size());
    sums_.resize(reference_.columns.size());
    for (std::size_t k = 0; k < sorted_.size(); ++k) {
        sorted_[k].resize(static_cast<std::size_t>(last + 2));
        for (std::size_t row = 0; row < reference_.rows(); ++row) {
            const double v = reference_.values[k][row];
            if (!std::isfinite(v)) continue;
            sorted_[k][stratum(reference_.block[row])].push_back(v);
            pooled_[k].push_back(v);
        }
        std::sort(pooled_[k].begin(), pooled_[k].end());
        for (auto& values : sorted_[k]) std::sort(values.begin(), values.end());
        for (const auto& values : sorted_[k]) sums_[k].push_back(std::accumulate(values.begin(), values.end(), 0.0));
    }
    choose(measured, settings, residuals);
    own_ = raw(reference_, true);
    mean_ = Eigen::VectorXd::Zero(own_.cols());
    for (Eigen::Index k = 0; k < own_.cols(); ++k) {
        double sum = 0.0;
        Eigen::Index count = 0;
        for (Eigen::Index row = 0; row < own_.rows(); ++row) {
            if (!std::isfinite(own_(row, k))) continue;
            sum += own_(row, k);
            ++count;
        }
        mean_[k] = count > 0 ? sum / static_cast<double>(count) : 0.0;
        own_.col(k).array() -= mean_[k];
    }
    least_variance_ = Eigen::VectorXd::Zero(own_.cols());
    for (std::size_t k = 0; k < residuals_.size(); ++k) {
        const ResidualKind kind = residuals_[k].kind;
        if (kind != ResidualKind::Passed && kind != ResidualKind::Window) continue;
        const double scale = kind == ResidualKind::Passed ? kPassedScale : kWindowScale;
        const auto n = static_cast<double>(std::max<std::size_t>(measured.rows(), 1));
        least_variance_[static_cast<Eigen::Index>(k)] = 1.0 / (n * scale * scale);
    }
}

/// Unknown blocks are one stratum, the first.
std::size_t ResidualSpace::stratum(std::int32_t block) const {
    return static_cast<std::size_t>(block + 1);
}

void ResidualSpace::choose(const ObservationTable& measured, const ResidualSettings& settings,
                           std::span<const Residual> residuals) {
    std::vector<Residual> wanted;
    std::vector<Column> levels;
    std::vector<Column> screens;                   // that recorded speeds, in their order along the path
    std::vector<Column> impacts;                   // speeds at the start and at the end of each
    const auto of_impact = [&](const Column& c) {  // only what a screen saw is known not to have passed
        return c.place >= 0 && measured.find({Quantity::Passed, c.place}) == measured.columns.size();
    };
    // where single stops are known, windows say what zones would
    const bool zones = measured.find({Quantity::Along, -1}) == measured.columns.size();
    for (const Column& c : measured.columns) {
        if (c.quantity == Quantity::Passed || (zones && c.quantity == Quantity::InZone))
            wanted.push_back({ResidualKind::Passed, c, {}, kNaN, kNaN});
        if (is_level(c, measured)) levels.push_back(c);
        if (c.quantity == Quantity::Speed) (of_impact(c) ? impacts : screens).push_back(c);
    }
    for (const Column& c : levels) {
        wanted.push_back({ResidualKind::Level, c, {}, kNaN, kNaN});
        wanted.push_back({ResidualKind::Spread, c, {}, kNaN, kNaN});
        if (!log_mass_.empty()) wanted.push_back({ResidualKind::MassTrend, c, {}, kNaN, kNaN});
        if (of_impact(c)) continue;
        if (!log_shape_.empty()) wanted.push_back({ResidualKind::ShapeTrend, c, {}, kNaN, kNaN});
        if (!order_.empty() && is_course(c.quantity)) wanted.push_back({ResidualKind::OrderTrend, c, {}, kNaN, kNaN});
    }
    for (std::size_t a = 0; a < levels.size(); ++a)
        for (std::size_t b = a + 1; b < levels.size(); ++b)
            if (levels[a].quantity != Quantity::Lateral && levels[b].quantity != Quantity::Lateral &&
                !of_impact(levels[a]) && !of_impact(levels[b]) &&
                (levels[a].place == levels[b].place ||
                 (known_ && is_course(levels[a].quantity) && is_course(levels[b].quantity))))
                wanted.push_back({ResidualKind::Together, levels[a], levels[b], kNaN, kNaN});
    // from screen to screen and on to the stop
    for (std::size_t s = 0; known_ && s < screens.size(); ++s) {
        const Column from = screens[s];
        if (s + 1 < screens.size())
            wanted.push_back({ResidualKind::Innovation, screens[s + 1], from, kNaN, kNaN});
        else
            wanted.push_back({ResidualKind::Innovation, {Quantity::Along, -1}, from, kNaN, kNaN});
    }
    // from the start of an impact to its end
    for (std::size_t k = 0; known_ && k + 1 < impacts.size(); k += 2)
        for (const Quantity q : {Quantity::Speed, Quantity::Rise, Quantity::Spin})
            if (const Column end{q, impacts[k + 1].place}; measured.find(end) < measured.columns.size())
                wanted.push_back({ResidualKind::Innovation, end, impacts[k], kNaN, kNaN});
    const std::size_t along = measured.find({Quantity::Along, -1});
    if (along < measured.columns.size()) {
        std::vector<double> stops;
        for (const double v : reference_.values[along])
            if (std::isfinite(v)) stops.push_back(v);
        std::sort(stops.begin(), stops.end());
        for (std::size_t w = 0; stops.size() > settings.windows && w < settings.windows; ++w) {
            const double n = static_cast<double>(settings.windows);
            const double from = w == 0 ? -kInfinity : sample_quantile(stops, static_cast<double>(w) / n);
            const double to =
                w + 1 == settings.windows ? kInfinity : sample_quantile(stops, static_cast<double>(w + 1) / n);
            if (to > from) wanted.push_back({ResidualKind::Window, {Quantity::Along, -1}, {}, from, to});
        }
        if (!wanted.empty() && wanted.back().kind == ResidualKind::Window)
            wanted.pop_back();  // the shares of all windows sum to one
    }
    if (!residuals.empty()) wanted.assign(residuals.begin(), residuals.end());
    for (const Residual& r : wanted)
        if (r.kind == ResidualKind::Innovation) add_state(r.other, r.column);
    residuals_ = wanted;
    if (!residuals.empty()) return;
    const ResidualRows rows = raw(measured, false);
    residuals_.clear();
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        const auto count = rows.col(static_cast<Eigen::Index>(k)).array().isFinite().count();
        if (count >= static_cast<Eigen::Index>(kLeastRows)) residuals_.push_back(wanted[k]);
    }
}

void ResidualSpace::add_state(const Column& screen, const Column& target) {
    const std::size_t speed = reference_.find(screen), value = reference_.find(target);
    if (speed == reference_.columns.size() || value == reference_.columns.size()) return;
    ByState state{screen, target, {}, {}, {}, {}, {}, {}};
    const std::vector<double>& speeds = reference_.values[speed];
    for (std::size_t row = 0; row < reference_.rows(); ++row)
        if (std::isfinite(speeds[row]) && std::isfinite(reference_.values[value][row]))
            state.rows.push_back(static_cast<std::uint32_t>(row));
    std::sort(state.rows.begin(), state.rows.end(),
              [&](std::uint32_t a, std::uint32_t b) { return speeds[a] < speeds[b]; });
    const auto in_order = [&](std::size_t column) {
        std::vector<double> values;
        if (column < reference_.columns.size())
            for (const std::uint32_t row : state.rows) values.push_back(reference_.values[column][row]);
        return values;
    };
    state.speed = in_order(speed);
    state.value = in_order(value);
    state.height = in_order(reference_.find({Quantity::Height, screen.place}));
    state.rise = in_order(reference_.find({Quantity::Rise, screen.place}));
    for (const std::uint32_t row : state.rows) state.mass.push_back(mass_of(reference_.block[row]));
    states_.push_back(std::move(state));
}

ResidualRows ResidualSpace::of(const ObservationTable& table) const {
    SCREE_ASSERT(table.columns == reference_.columns);
    ResidualRows rows = raw(table, false);
    rows.rowwise() -= mean_.transpose();
    return rows;
}

double ResidualSpace::covariate(const std::vector<double>& of_block, std::int32_t block) const {
    return block >= 0 && static_cast<std::size_t>(block) < of_block.size() ? of_block[static_cast<std::size_t>(block)]
                                                                           : kNaN;
}

/// Standardised logarithm; an unknown one counts as the middle.
double ResidualSpace::mass_of(std::int32_t block) const {
    const double m = covariate(log_mass_, block);
    return std::isfinite(m) ? m : 0.0;
}

/// sqrt(12) (u - 1/2); a row of the reference counts among the others only.
double ResidualSpace::level(const ObservationTable& table, std::size_t row, std::size_t column, bool own) const {
    const double v = table.values[column][row];
    if (!std::isfinite(v)) return kNaN;
    const std::size_t s = stratum(table.block[row]);
    if (s >= sorted_[column].size()) return kNaN;
    const bool few = sorted_[column][s].size() <= kLeastMembers;  // for rows of the reference and others alike
    const std::vector<double>& members = few ? pooled_[column] : sorted_[column][s];
    if (few && members.size() <= kLeastPooled) return kNaN;
    const auto [first, last] = std::equal_range(members.begin(), members.end(), v);
    const double below = static_cast<double>(first - members.begin());
    const double equal = static_cast<double>(last - first) - (own ? 1.0 : 0.0);
    const double count = static_cast<double>(members.size()) - (own ? 1.0 : 0.0);
    const double u = (below + tie_breaker(settings_.seed, row, column) * (1.0 + equal)) / (count + 1.0);
    return kLevel * (u - 0.5);
}

/// Share of the reference's rows of that stratum that passed; of the others, if the row is one of them.
double ResidualSpace::expected_share(const ObservationTable& table, std::size_t column, std::size_t row,
                                     bool own) const {
    const std::size_t s = stratum(table.block[row]);
    if (s >= sorted_[column].size()) return kNaN;
    const std::vector<double>& members = sorted_[column][s];
    if (members.size() < kLeastMembers + (own ? 1 : 0)) return kNaN;
    return (sums_[column][s] - (own ? table.values[column][row] : 0.0)) /
           static_cast<double>(members.size() - (own ? 1 : 0));
}

/// Level of the target among the reference's rows that were in the most similar states: speed, height and vertical speed at the screen before or the start of
/// the impact, and mass.
void ResidualSpace::innovations(const ObservationTable& table, const Residual& residual, bool own,
                                RowsOfOne out) const {
    out.setConstant(kNaN);
    const auto state = std::find_if(states_.begin(), states_.end(), [&](const ByState& s) {
        return s.screen == residual.other && s.target == residual.column;
    });
    if (state == states_.end() || state->rows.size() < settings_.neighbours + 1) return;
    const auto values_of = [&](const Column& c) {
        const std::size_t k = table.find(c);
        return k < table.columns.size() ? &table.values[k] : nullptr;
    };
    const std::vector<double>*const speeds = values_of(residual.other), *const values = values_of(residual.column),
                                    *const heights = values_of({Quantity::Height, residual.other.place}),
                                    *const rises = values_of({Quantity::Rise, residual.other.place});
    if (speeds == nullptr || values == nullptr) return;
    const std::size_t tie_column = kMostColumns + reference_.find(residual.column),
                      pool = std::min(kPoolShare * settings_.neighbours, state->rows.size());
    std::vector<double> distance(pool);
    std::vector<std::int32_t> classes(pool);
    for (std::size_t row = 0; row < table.rows(); ++row) {
        const double v = (*speeds)[row], value = (*values)[row];
        if (!std::isfinite(v) || !std::isfinite(value)) continue;
        if (v < state->speed.front() || v > state->speed.back()) continue;  // nothing like it was simulated
        const auto at = static_cast<std::size_t>(std::lower_bound(state->speed.begin(), state->speed.end(), v) -
                                                 state->speed.begin());
        const std::size_t begin = std::min(at > pool / 2 ? at - pool / 2 : 0, state->rows.size() - pool);
        const double spread = std::max(state->speed[begin + pool - 1] - state->speed[begin], 1e-9);
        std::fill(distance.begin(), distance.end(), 0.0);
        const auto add = [&](const std::vector<double>& of_rows, double own_one, double unit) {
            if (!std::isfinite(own_one)) return;
            const double per_unit = 1.0 / unit;
            const double* const other = of_rows.data() + begin;
            for (std::size_t k = 0; k < pool; ++k) distance[k] += std::abs(other[k] - own_one) * per_unit;
        };
        add(state->speed, v, spread);
        add(state->mass, mass_of(table.block[row]), kMassUnit);
        if (heights != nullptr) add(state->height, (*heights)[row], kHeightUnit);
        if (rises != nullptr) add(state->rise, (*rises)[row], spread);
        for (std::size_t k = at; own && k < begin + pool && state->speed[k] == v; ++k)
            if (state->rows[k] == row) distance[k - begin] = kInfinity;
        const double farthest = kth_smallest(distance, settings_.neighbours, classes);
        const double* const others = state->value.data() + begin;
        std::int64_t below = 0, equal = 0, count = 0;  // as wide as what is compared
        for (std::size_t k = 0; k < pool; ++k) {
            const std::int64_t near = distance[k] <= farthest ? 1 : 0;
            count += near;
            below += near & (others[k] < value ? 1 : 0);
            equal += near & (others[k] == value ? 1 : 0);
        }
        const double tie = tie_breaker(settings_.seed, row, tie_column);
        const double u =
            (static_cast<double>(below) + tie * static_cast<double>(1 + equal)) / static_cast<double>(count + 1);
        out[static_cast<Eigen::Index>(row)] = kLevel * (u - 0.5);
    }
}

/// Inside the window or not, less the share of the reference's rows that are.
void ResidualSpace::windows(const ObservationTable& table, const Residual& residual, bool own, RowsOfOne out) const {
    const std::size_t column = reference_.find(residual.column);
    std::vector<double> inside;  // per stratum
    for (const std::vector<double>& members : sorted_[column])
        inside.push_back(static_cast<double>(std::lower_bound(members.begin(), members.end(), residual.to) -
                                             std::lower_bound(members.begin(), members.end(), residual.from)));
    for (std::size_t row = 0; row < table.rows(); ++row) {
        const double v = table.values[column][row];
        const std::size_t s = stratum(table.block[row]);
        double& of_row = out[static_cast<Eigen::Index>(row)];
        of_row = kNaN;
        if (!std::isfinite(v) || s >= inside.size() || sorted_[column][s].size() < kLeastMembers) continue;
        const double is_inside = v >= residual.from && v < residual.to ? 1.0 : 0.0, itself = own ? 1.0 : 0.0;
        of_row =
            is_inside - (inside[s] - itself * is_inside) / (static_cast<double>(sorted_[column][s].size()) - itself);
    }
}

ResidualRows ResidualSpace::raw(const ObservationTable& table, bool own) const {
    const auto rows = static_cast<Eigen::Index>(table.rows());
    Eigen::MatrixXd levels(rows, static_cast<Eigen::Index>(table.columns.size()));
    for (std::size_t k = 0; k < table.columns.size(); ++k)
        for (std::size_t row = 0; row < table.rows(); ++row)
            levels(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k)) =
                is_level(table.columns[k], table) ? level(table, row, k, own) : kNaN;
    const auto of_blocks = [&](const std::vector<double>& of_block) {
        Eigen::ArrayXd values(rows);
        for (std::size_t row = 0; row < table.rows(); ++row)
            values[static_cast<Eigen::Index>(row)] = covariate(of_block, table.block[row]);
        return values;
    };
    const Eigen::ArrayXd log_mass = of_blocks(log_mass_), log_shape = of_blocks(log_shape_), order = of_blocks(order_);
    ResidualRows all(rows, static_cast<Eigen::Index>(residuals_.size()));
    for (std::size_t r = 0; r < residuals_.size(); ++r) {
        const Residual& residual = residuals_[r];
        const std::size_t column = table.find(residual.column);
        const auto level_of = [&](std::size_t k) { return levels.col(static_cast<Eigen::Index>(k)).array(); };
        auto out = all.col(static_cast<Eigen::Index>(r));
        switch (residual.kind) {
            case ResidualKind::Passed: {
                for (std::size_t row = 0; row < table.rows(); ++row)
                    out[static_cast<Eigen::Index>(row)] =
                        (table.values[column][row] - expected_share(table, column, row, own)) / kPassedScale;
                break;
            }
            case ResidualKind::Level:
                out = level_of(column);
                break;
            case ResidualKind::Spread:
                out = kSpread * ((level_of(column) / kLevel).square() - 1.0 / 12.0);
                break;
            case ResidualKind::MassTrend:
                out = level_of(column) * log_mass;
                break;
            case ResidualKind::ShapeTrend:
                out = level_of(column) * log_shape;
                break;
            case ResidualKind::OrderTrend:
                out = level_of(column) * order;
                break;
            case ResidualKind::Together:
                out = level_of(column) * level_of(table.find(residual.other));
                break;
            case ResidualKind::Innovation:
                innovations(table, residual, own, out);
                break;
            case ResidualKind::Window:
                windows(table, residual, own, out);
                out /= kWindowScale;
                break;
        }
    }
    return all;
}

namespace {

std::string column_words(const Column& c, std::span<const std::string> screens, std::span<const std::string> zones) {
    const bool named = c.place >= 0 && static_cast<std::size_t>(c.place) < screens.size();
    std::string words;
    switch (c.quantity) {
        case Quantity::Along:
            return "stop along the path";
        case Quantity::Lateral:
            return "stop beside the path";
        case Quantity::Runout:
            return "runout";
        case Quantity::InZone:
            words = "share that stops in ";
            return words += static_cast<std::size_t>(c.place) < zones.size() ? zones[static_cast<std::size_t>(c.place)]
                                                                             : "a zone";
        case Quantity::Passed:
            words = "share that passes";
            if (named) words.append(" ").append(screens[static_cast<std::size_t>(c.place)]);
            return words;
        case Quantity::Speed:
            words = "speed";
            break;
        case Quantity::Height:
            words = "passing height";
            break;
        case Quantity::Spin:
            words = "spin";
            break;
        case Quantity::Energy:
            words = "energy";
            break;
        case Quantity::Rise:
            words = "vertical speed";
            break;
    }
    if (named) words.append(" at ").append(screens[static_cast<std::size_t>(c.place)]);
    return words;
}

}  // namespace

std::string residual_name(const Residual& r, std::span<const std::string> screens, std::span<const std::string> zones) {
    const std::string what = column_words(r.column, screens, zones);
    switch (r.kind) {
        case ResidualKind::Passed:
        case ResidualKind::Level:
            return what;
        case ResidualKind::Spread:
            return "spread of " + what;
        case ResidualKind::MassTrend:
            return what + " with mass";
        case ResidualKind::ShapeTrend:
            return what + " with elongation";
        case ResidualKind::OrderTrend:
            return what + " with the order of the test";
        case ResidualKind::Together:
            return what + " together with " + column_words(r.other, screens, zones);
        case ResidualKind::Innovation:
            return what + " of blocks with like " + column_words(r.other, screens, zones);
        case ResidualKind::Window: {
            std::ostringstream s;
            s.precision(3);
            s << "stops ";
            if (std::isinf(r.from))
                s << "before " << r.to << " m";
            else if (std::isinf(r.to))
                s << "beyond " << r.from << " m";
            else
                s << "between " << r.from << " and " << r.to << " m";
            return s.str();
        }
    }
    return what;
}

}  // namespace scree
