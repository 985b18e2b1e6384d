// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/inference/score_test.hpp"

#include "inference/eigenpairs.hpp"

#include "scree/base/assert.hpp"
#include "scree/base/random.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace scree {

namespace {

/// Of the largest eigenvalue of a correlation matrix: smaller ones are noise of pairs that are not known together [-].
constexpr double kLeastEigenvalue = 1e-3;

}  // namespace

ResidualMean mean_residual(const ResidualRows& rows) {
    const Eigen::MatrixXd known = rows.array().isFinite().cast<double>();
    const Eigen::MatrixXd values = rows.array().isFinite().select(rows.array(), 0.0);
    ResidualMean m;
    m.together = known.transpose() * known;
    const Eigen::ArrayXd count = m.together.diagonal().array();
    m.mean = (count > 0.0).select(values.colwise().sum().transpose().array() / count.max(1.0), 0.0);
    return m;
}

Eigen::MatrixXd row_covariance(const ResidualRows& rows, const Eigen::VectorXd& least_variance) {
    const ResidualMean m = mean_residual(rows);
    const Eigen::MatrixXd known = rows.array().isFinite().cast<double>();
    Eigen::MatrixXd centred = rows;
    centred.rowwise() -= m.mean.transpose();
    centred = rows.array().isFinite().select(centred.array(), 0.0);
    Eigen::MatrixXd covariance = (centred.transpose() * centred).array() / m.together.array().max(1.0);
    covariance.diagonal() = covariance.diagonal().cwiseMax(least_variance);
    // as correlations, with the smallest eigenvalues raised: pairs of different rows need not fit each other
    const Eigen::ArrayXd deviation = covariance.diagonal().array().max(1e-12).sqrt();
    const Eigen::MatrixXd correlation =
        covariance.array() / (deviation.matrix() * deviation.matrix().transpose()).array();
    const Eigenpairs pairs = eigenpairs(correlation);
    const Eigen::VectorXd values = pairs.values.cwiseMax(kLeastEigenvalue * pairs.values.maxCoeff());
    covariance = pairs.vectors * values.asDiagonal() * pairs.vectors.transpose();
    return deviation.matrix().asDiagonal() * covariance * deviation.matrix().asDiagonal();
}

Eigen::MatrixXd row_covariance(const ResidualSpace& space) {
    return row_covariance(space.of_reference(), space.least_variance());
}

Eigen::MatrixXd mean_covariance(const Eigen::MatrixXd& of_rows, const Eigen::MatrixXd& together) {
    const Eigen::VectorXd count = together.diagonal().cwiseMax(1.0);
    Eigen::MatrixXd S = of_rows.array() * together.array() / (count * count.transpose()).array();
    for (Eigen::Index k = 0; k < S.rows(); ++k)
        if (together(k, k) < 0.5) S(k, k) = 1e6 * of_rows(k, k);  // nothing is known: no weight
    return S;
}

ScoreTest::ScoreTest(Eigen::MatrixXd covariance, Eigen::MatrixXd jacobian, Eigen::VectorXd deviation,
                     std::vector<Fingerprint> fingerprints)
    : covariance_(std::move(covariance)),
      jacobian_(std::move(jacobian)),
      deviation_(std::move(deviation)),
      fingerprints_(std::move(fingerprints)) {
    SCREE_ASSERT(covariance_.rows() == covariance_.cols() && jacobian_.rows() == covariance_.rows() &&
                 jacobian_.cols() == deviation_.size());
    changes_.resize(covariance_.rows(), static_cast<Eigen::Index>(fingerprints_.size()));
    for (std::size_t k = 0; k < fingerprints_.size(); ++k)
        changes_.col(static_cast<Eigen::Index>(k)) = fingerprints_[k].change;
}

ScoreTest::Projection ScoreTest::project(const Eigen::MatrixXd& together) const {
    Projection p;
    p.S = mean_covariance(covariance_, together);
    const Eigen::LLT<Eigen::MatrixXd> factor(p.S);
    const Eigen::MatrixXd W = factor.solve(Eigen::MatrixXd::Identity(p.S.rows(), p.S.cols()));
    const Eigen::MatrixXd WJ = W * jacobian_;
    Eigen::MatrixXd information = jacobian_.transpose() * WJ;
    information.diagonal().array() += deviation_.array().square().inverse();
    p.gain = information.ldlt().solve(WJ.transpose());
    p.deviation = information.inverse().diagonal().cwiseMax(0.0).cwiseSqrt();
    p.P = W - WJ * p.gain;
    return p;
}

ScoreResult ScoreTest::operator()(const ResidualMean& r) const {
    const Projection p = project(r.together);
    const Eigen::VectorXd Pr = p.P * r.mean;
    ScoreResult result;
    result.q = r.mean.dot(Pr);
    result.shift = p.gain * r.mean;
    result.shift_deviation = p.deviation;
    const auto count = static_cast<Eigen::Index>(fingerprints_.size());
    result.z.resize(count);
    result.visibility.resize(count);
    result.expected.resize(count);
    const double n = r.together.diagonal().maxCoeff(), trace = p.P.cwiseProduct(p.S).sum();  // of P S: symmetric both
    const Eigen::VectorXd squared = changes_.cwiseProduct(p.P * changes_).colwise().sum(),
                          product = changes_.transpose() * Pr;
    for (Eigen::Index k = 0; k < count; ++k) {
        // a fingerprint from N rows has the covariance of N rows: E f^T P f grows by trace(P S) n / N
        const double noise = trace * n / fingerprints_[static_cast<std::size_t>(k)].rows;
        result.z[k] = squared[k] > 0.0 ? product[k] / std::sqrt(squared[k]) : 0.0;
        result.visibility[k] = std::sqrt(std::max(squared[k] - noise, 0.0));
        result.expected[k] = squared[k] > noise ? (squared[k] - noise) / std::sqrt(squared[k]) : 0.0;
    }
    // residuals after recalibration: (I - J gain) r, with covariance (I - J gain) S (I - J gain)^T
    const Eigen::MatrixXd left = Eigen::MatrixXd::Identity(p.S.rows(), p.S.cols()) - jacobian_ * p.gain;
    const Eigen::ArrayXd variance = (left * p.S).cwiseProduct(left).rowwise().sum().array();
    result.standardised = ((left * r.mean).array() / variance.max(1e-24).sqrt()).matrix();
    return result;
}

Eigen::MatrixXd ScoreTest::cosines(const Eigen::MatrixXd& together) const {
    const Projection p = project(together);
    const Eigen::MatrixXd products = changes_.transpose() * p.P * changes_;
    const Eigen::VectorXd length = products.diagonal().cwiseMax(1e-24).cwiseSqrt();
    return products.array() / (length * length.transpose()).array();
}

double ScoreTest::largest_z(const ScoreResult& result) const {
    double largest = -kInfinity;
    for (std::size_t k = 0; k < fingerprints_.size(); ++k)
        if (fingerprints_[k].judged) largest = std::max(largest, result.z[static_cast<Eigen::Index>(k)]);
    return largest;
}

namespace {

bool any_known(const std::vector<double>& values) {
    return std::any_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

/// Records of screens alone, of unknown blocks, and not how many were thrown.
bool nobody_knows_how_many(const ObservationTable& measured) {
    bool any = false;
    for (std::size_t k = 0; k < measured.columns.size(); ++k) {
        const Column& c = measured.columns[k];
        if (!any_known(measured.values[k])) continue;
        if (c.place < 0 || c.quantity == Quantity::Passed || c.quantity == Quantity::InZone) return false;
        any = true;
    }
    return any && std::all_of(measured.block.begin(), measured.block.end(), [](std::int32_t b) { return b < 0; });
}

}  // namespace

/// So many blocks that at the screens there are about as many records as were taken: where few pass, most of those thrown have none.
void NullRows::draw_until_as_many_pass(std::span<const Residual> residuals, const ObservationTable& measured) {
    std::vector<char> hidden;
    std::map<std::int32_t, std::pair<double, double>> at;  // records, and the share of simulated rows that have one
    for (std::size_t k = 0; k < residuals.size(); ++k) {
        const Residual& r = residuals[k];
        const auto known = [&](const Column& c) {
            const std::size_t column = measured.find(c);
            return column < measured.columns.size() && any_known(measured.values[column]);
        };
        hidden.push_back(!known(r.column) || (r.kind == ResidualKind::Together && !known(r.other)));
        if (hidden.back() || r.kind != ResidualKind::Level) continue;
        const std::vector<double>& values = measured.values[measured.find(r.column)];
        const auto records = std::count_if(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
        auto& [most, share] = at[r.column.place];
        most = std::max(most, static_cast<double>(records));
        share = std::max(share, static_cast<double>(own_.col(static_cast<Eigen::Index>(k)).array().isFinite().count()) /
                                    static_cast<double>(std::max<Eigen::Index>(own_.rows(), 1)));
    }
    double records = 0.0, shares = 0.0;
    for (const auto& [place, of_place] : at)
        if (of_place.second > 0.0) {
            records += of_place.first;
            shares += of_place.second;
        }
    const auto thrown = shares > 0.0 ? static_cast<std::size_t>(std::lround(records / shares)) : measured.rows();
    from_.assign(std::max(thrown, std::size_t{1}), rows_of_.size() - 1);
    unmeasured_.assign(from_.size(), hidden);
}

NullRows::NullRows(const ResidualRows& own, std::span<const std::int32_t> block, std::span<const Residual> residuals,
                   const ObservationTable& measured)
    : own_(own) {
    std::vector<std::uint32_t> all(block.size());
    std::iota(all.begin(), all.end(), std::uint32_t{0});
    for (const std::uint32_t row : all) {
        if (block[row] < 0) continue;
        const auto b = static_cast<std::size_t>(block[row]);
        if (rows_of_.size() <= b) rows_of_.resize(b + 1);
        rows_of_[b].push_back(row);
    }
    rows_of_.push_back(std::move(all));
    if (nobody_knows_how_many(measured)) {
        draw_until_as_many_pass(residuals, measured);
        return;
    }
    auto unmeasured = [&](std::size_t row, const Column& c) {
        const std::size_t k = measured.find(c);
        if (k == measured.columns.size()) return true;
        if (std::isfinite(measured.values[k][row])) return false;
        const std::size_t passed = measured.find({Quantity::Passed, c.place});
        const bool known_not_to_pass = c.place >= 0 && c.quantity != Quantity::InZone &&
                                       passed < measured.columns.size() && measured.values[passed][row] == 0.0;
        return !known_not_to_pass;
    };
    for (std::size_t row = 0; row < measured.rows(); ++row) {
        const auto b = static_cast<std::size_t>(measured.block[row]);  // -1 lies beyond all
        from_.push_back(b < rows_of_.size() - 1 && !rows_of_[b].empty() ? b : rows_of_.size() - 1);
        std::vector<char> hidden;
        for (const Residual& r : residuals)
            hidden.push_back(
                unmeasured(row, r.column) ||
                ((r.kind == ResidualKind::Together || r.kind == ResidualKind::Innovation) && unmeasured(row, r.other)));
        unmeasured_.push_back(std::move(hidden));
    }
}

ResidualRows NullRows::draw(std::uint64_t seed, std::uint64_t number) const {
    RandomStream random(seed, number, RandomPurpose::Resampling);
    ResidualRows rows(static_cast<Eigen::Index>(from_.size()), own_.cols());
    for (std::size_t row = 0; row < from_.size(); ++row) {
        const auto i = static_cast<Eigen::Index>(row);
        const std::vector<std::uint32_t>& among = rows_of_[from_[row]];
        rows.row(i) = own_.row(static_cast<Eigen::Index>(among[random.below(among.size())]));
        for (std::size_t k = 0; k < unmeasured_[row].size(); ++k)
            if (unmeasured_[row][k]) rows(i, static_cast<Eigen::Index>(k)) = kNaN;
    }
    return rows;
}

namespace {

/// Share of chance that is at least as large, with the measured one counted.
double share_at_least(const std::vector<double>& sorted, double value) {
    const auto below = std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin();
    return (static_cast<double>(sorted.size()) - static_cast<double>(below) + 1.0) /
           (static_cast<double>(sorted.size()) + 1.0);
}

}  // namespace

double z_of_as_much_power(const GlobalTest& test, double visibility) {
    const double squared = visibility * visibility;
    return test.z_limit +
           (test.q_mean + squared - test.q_limit) / std::sqrt(test.q_deviation * test.q_deviation + 4.0 * squared);
}

GlobalTest global_test(const ScoreTest& test, const ScoreResult& measured, const NullRows& null, std::int64_t draws,
                       double level, std::uint64_t seed) {
    std::vector<double> q, z, largest;
    const bool any = std::isfinite(test.largest_z(measured));
    for (std::int64_t k = 0; k < draws; ++k) {
        const ScoreResult s = test(mean_residual(null.draw(seed, static_cast<std::uint64_t>(k))));
        q.push_back(s.q);
        z.push_back(any ? test.largest_z(s) : 0.0);
        largest.push_back(s.standardised.cwiseAbs().maxCoeff());
    }
    std::vector<double> sorted_q = q, sorted_z = z;
    std::sort(sorted_q.begin(), sorted_q.end());
    std::sort(sorted_z.begin(), sorted_z.end());
    std::sort(largest.begin(), largest.end());
    GlobalTest g;
    g.p_q = share_at_least(sorted_q, measured.q);
    g.p_z = any ? share_at_least(sorted_z, test.largest_z(measured)) : 1.0;
    // each is ranked among all others, the measured one among them, as that is among these
    const auto share_of = [&](const std::vector<double>& sorted, double value, double of_measured) {
        return share_at_least(sorted, value) -
               (of_measured >= value ? 0.0 : 1.0) / (static_cast<double>(sorted.size()) + 1.0);
    };
    std::vector<double> smaller;
    for (std::size_t k = 0; k < q.size(); ++k)
        smaller.push_back(std::min(share_of(sorted_q, q[k], measured.q),
                                   any ? share_of(sorted_z, z[k], test.largest_z(measured)) : 1.0));
    std::sort(smaller.begin(), smaller.end());
    const auto as_small = std::upper_bound(smaller.begin(), smaller.end(), std::min(g.p_q, g.p_z)) - smaller.begin();
    g.p = (static_cast<double>(as_small) + 1.0) / (static_cast<double>(draws) + 1.0);
    const auto at = [](const std::vector<double>& sorted, double share) {
        const auto n = static_cast<double>(sorted.size());
        return sorted.empty() ? kNaN
                              : sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(std::max(share, 0.0) * n))];
    };
    g.z_limit = any ? at(sorted_z, 1.0 - at(smaller, level)) : kInfinity;
    g.q_limit = at(sorted_q, 1.0 - at(smaller, level));
    const Eigen::Map<const Eigen::ArrayXd> by_chance(q.data(), static_cast<Eigen::Index>(q.size()));
    g.q_mean = by_chance.mean();
    g.q_deviation = std::sqrt((by_chance - g.q_mean).square().mean());
    g.residual_limit = at(largest, 1.0 - level);
    g.residual_p.resize(measured.standardised.size());
    for (Eigen::Index k = 0; k < g.residual_p.size(); ++k)
        g.residual_p[k] = share_at_least(largest, std::abs(measured.standardised[k]));
    return g;
}

}  // namespace scree
