// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/diagnose_units.hpp"

#include "cli/text.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>

namespace scree::cli {

namespace {

constexpr std::size_t kLeastPoints = 5;  // of a straight line
constexpr double kBlocksOfOrder = 10.0;  // a trend in the order of the test is told per so many blocks

/// A number of the measured blocks, the same of the simulated ones, and the standard error of the first.
struct Pair {
    const char* name;
    double measured, simulated, error;
    std::string unit;
};

double percent_within(const std::vector<double>& values, double from, double to) {
    const auto inside = std::count_if(values.begin(), values.end(), [&](double v) { return v >= from && v < to; });
    return 100.0 * static_cast<double>(inside) / static_cast<double>(values.size());
}

/// In percent.
Pair share_of(double measured, double simulated, double of) {
    return {"", measured, simulated, std::sqrt(simulated * (100.0 - simulated) / of), " %"};
}

std::optional<Pair> of_shares(const ShareEstimate& measured, const ShareEstimate& simulated) {
    if (measured.of == 0 || simulated.of == 0) return std::nullopt;
    return share_of(100.0 * measured.share(), 100.0 * simulated.share(), static_cast<double>(measured.of));
}

/// Of one observable alone: share, stops in a stretch.
std::optional<Pair> of_observable(const Residual& r, const ComparedObservable& o) {
    if (r.kind == ResidualKind::Passed) return of_shares(o.measured_share, o.simulated_share);
    if (r.kind != ResidualKind::Window || o.measured.empty() || o.simulated.empty()) return std::nullopt;
    return share_of(percent_within(o.measured, r.from, r.to), percent_within(o.simulated, r.from, r.to),
                    static_cast<double>(o.measured.size()));
}

/// The zones are columns of one observable.
std::optional<Pair> of_zone(const DiagnoseStudy& study, const Residual& r) {
    for (const SharePair& zone : study.before.zones)
        if (zone.name == study.zones[static_cast<std::size_t>(r.column.place)])
            return of_shares(zone.measured, zone.simulated);
    return std::nullopt;
}

/// The straight line of least squares, y on x.
struct Line {
    double slope = kNaN, slope_error = kNaN, correlation = kNaN;
    double mean_x = kNaN, mean_y = kNaN;
    std::size_t count = 0;

    double at(double x) const { return mean_y + slope * (x - mean_x); }
};

/// Over the pairs of which both are known; nothing but their count where they are too few, or x or y do not vary.
Line line_of(const std::vector<double>& x, const std::vector<double>& y) {
    Line line;
    std::vector<Vec2> points;
    Vec2 mean = Vec2::Zero();
    for (std::size_t k = 0; k < x.size(); ++k)
        if (std::isfinite(x[k]) && std::isfinite(y[k])) mean += points.emplace_back(x[k], y[k]);
    line.count = points.size();
    if (line.count < kLeastPoints) return line;
    const auto n = static_cast<double>(line.count);
    mean /= n;
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (const Vec2& p : points) {
        const Vec2 d = p - mean;
        xx += d.x() * d.x();
        xy += d.x() * d.y();
        yy += d.y() * d.y();
    }
    if (!(xx > 0.0) || !(yy > 0.0)) return line;
    line.slope = xy / xx;
    line.slope_error = std::sqrt(std::max(yy - xy * xy / xx, 0.0) / (n - 2.0) / xx);
    line.correlation = xy / std::sqrt(xx * yy);
    line.mean_x = mean.x();
    line.mean_y = mean.y();
    return line;
}

/// What a trend goes with, of a block: once larger by 1 is a doubling, or ten blocks later.
double covariate(ResidualKind kind, const ObservedBlock& b) {
    if (kind == ResidualKind::OrderTrend) return b.order / kBlocksOfOrder;
    if (!b.has_body()) return kNaN;
    return std::log2(kind == ResidualKind::MassTrend ? b.mass : b.size.maxCoeff() / b.size.minCoeff());
}

const std::vector<double>* column_of(const ObservationTable& table, const Column& column) {
    const std::size_t k = table.find(column);
    return k < table.columns.size() ? &table.values[k] : nullptr;
}

/// Mean or spread of those that have the value: a block that did not come to a screen has no speed there, which is not one of 0.
std::optional<Pair> of_values(const DiagnoseStudy& study, const Residual& r) {
    const auto known = [&](const ObservationTable& table) {
        std::vector<double> values;
        if (const std::vector<double>* all = column_of(table, r.column))
            std::copy_if(all->begin(), all->end(), std::back_inserter(values),
                         [](double v) { return std::isfinite(v); });
        return values;
    };
    const std::vector<double> measured = known(study.before.measured), simulated = known(study.before.simulated);
    if (std::min(measured.size(), simulated.size()) < 2) return std::nullopt;
    const SampleSummary m = summary_of(measured), s = summary_of(simulated);
    const double error = m.deviation / std::sqrt(static_cast<double>(measured.size()));
    if (r.kind == ResidualKind::Level) return Pair{"mean ", m.mean, s.mean, error, ""};
    return Pair{"standard deviation ", m.deviation, s.deviation, error / std::numbers::sqrt2, ""};
}

std::optional<Pair> of_trend(const DiagnoseStudy& study, const Residual& r) {
    const auto line = [&](const ObservationTable& table) {
        const std::vector<double>* values = column_of(table, r.column);
        std::vector<double> x(table.rows(), kNaN);
        for (std::size_t row = 0; row < table.rows(); ++row)
            if (const auto b = static_cast<std::size_t>(table.block[row]);
                table.block[row] >= 0 && b < study.known_blocks.size())
                x[row] = covariate(r.kind, study.known_blocks[b]);
        return values ? line_of(x, *values) : Line{};
    };
    const Line measured = line(study.before.measured), simulated = line(study.before.simulated);
    if (!std::isfinite(measured.slope) || !std::isfinite(simulated.slope)) return std::nullopt;
    const char* name = r.kind == ResidualKind::MassTrend    ? "per doubling of the mass "
                       : r.kind == ResidualKind::ShapeTrend ? "per doubling of L1/L3 "
                                                            : "per ten blocks ";
    return Pair{name, measured.slope, simulated.slope, measured.slope_error, ""};
}

std::optional<Pair> of_both(const DiagnoseStudy& study, const Residual& r) {
    const auto line = [&](const ObservationTable& table) {
        const std::vector<double>*x = column_of(table, r.column), *y = column_of(table, r.other);
        return x && y ? line_of(*x, *y) : Line{};
    };
    const Line measured = line(study.before.measured), simulated = line(study.before.simulated);
    if (!std::isfinite(measured.correlation) || !std::isfinite(simulated.correlation)) return std::nullopt;
    const double error =
        (1.0 - measured.correlation * measured.correlation) / std::sqrt(static_cast<double>(measured.count));
    return Pair{"correlation ", measured.correlation, simulated.correlation, error, ""};
}

/// Against what the simulated blocks have that were as fast before, by a straight line.
std::optional<Pair> of_like_blocks(const DiagnoseStudy& study, const Residual& r) {
    const std::vector<double>*x = column_of(study.before.measured, r.other),
          *y = column_of(study.before.measured, r.column), *before = column_of(study.before.simulated, r.other),
          *after = column_of(study.before.simulated, r.column);
    if (!x || !y || !before || !after) return std::nullopt;
    const Line simulated = line_of(*before, *after);
    if (!std::isfinite(simulated.slope)) return std::nullopt;
    double mean = 0.0, count = 0.0, off = 0.0, squares = 0.0;
    for (std::size_t k = 0; k < x->size(); ++k) {
        if (!std::isfinite((*x)[k]) || !std::isfinite((*y)[k])) continue;
        const double difference = (*y)[k] - simulated.at((*x)[k]);
        mean += (*y)[k];
        off += difference;
        squares += difference * difference;
        count += 1.0;
    }
    if (count < static_cast<double>(kLeastPoints)) return std::nullopt;
    mean /= count;
    off /= count;
    const double error = std::sqrt(std::max(squares / count - off * off, 0.0) / (count - 1.0));
    return Pair{"mean ", mean, mean - off, error, ""};
}

std::optional<Pair> pair_of(const DiagnoseStudy& study, const Residual& r) {
    std::optional<Pair> pair;
    double factor = 1.0;
    std::string unit = " m";  // stops in plan view are two columns of one observable
    for (const ComparedObservable& o : study.before.observables) {
        const std::vector<Column>& columns = o.gap.observable.columns;
        if (columns.size() != 1 || columns.front() != r.column) continue;
        if (!pair) pair = of_observable(r, o);
        factor = o.factor;
        unit = " " + o.unit;
    }
    if (r.column.quantity == Quantity::InZone) return of_zone(study, r);
    switch (r.kind) {
        case ResidualKind::Level:
        case ResidualKind::Spread:
            pair = of_values(study, r);
            break;
        case ResidualKind::MassTrend:
        case ResidualKind::ShapeTrend:
        case ResidualKind::OrderTrend:
            pair = of_trend(study, r);
            break;
        case ResidualKind::Innovation:
            pair = of_like_blocks(study, r);
            break;
        case ResidualKind::Together:
            return of_both(study, r);
        default:
            return pair;
    }
    if (pair) *pair = {pair->name, factor * pair->measured, factor * pair->simulated, factor * pair->error, unit};
    return pair;
}

}  // namespace

std::string in_units(const DiagnoseStudy& study, const Residual& residual, bool more) {
    const std::optional<Pair> p = pair_of(study, residual);
    if (!p) return "";
    const double difference = more ? p->measured - p->simulated : p->simulated - p->measured;
    if (!(difference > p->error)) return ", once the parameters fit the rest";
    return std::string(": ") + p->name + short_number(p->measured) + p->unit + " measured, " +
           short_number(p->simulated) + p->unit + " simulated";
}

}  // namespace scree::cli
