// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/inference/residual_space.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace scree {

/// Efficient-score tests in residual space: is the model rejected, and which change of it explains why, with everything that a recalibration could absorb
/// taken out (Rao 1948; Neyman's C(alpha), in the form of Le Cessie & van Houwelingen; Cox & Hinkley 1974, Theoretical Statistics, section 9.3).
///
/// With the mean residual r of the measured rows, its covariance S if the model is right, W = S^-1, the derivatives J of the mean residual with respect to
/// the calibrated parameters and their prior variances L:
///     P = W - W J (J^T W J + L^-1)^-1 J^T W,   Q = r^T P r,   z_k = f_k^T P r / d_k,   d_k = sqrt(f_k^T P f_k)
/// where f_k, the fingerprint, is the mean residual that effect k at its reference strength would cause. d_k is the z to expect then, before any
/// measurement; strength = z_k / d_k in units of the reference; the cosine f_k^T P f_l / (d_k d_l) says how alike two effects look.

/// Rows that an average is taken over: means, and how many rows stand behind each and behind each pair.
struct ResidualMean {
    Eigen::VectorXd mean;      ///< 0 where nothing is known [-]
    Eigen::MatrixXd together;  ///< rows that know both [-]
};
ResidualMean mean_residual(const ResidualRows& rows);

/// Covariance of single rows, from pairs that are known; made positive definite by a share of its diagonal.
Eigen::MatrixXd row_covariance(const ResidualRows& rows, const Eigen::VectorXd& least_variance);
/// Of the reference's rows.
Eigen::MatrixXd row_covariance(const ResidualSpace& space);
/// Covariance of the mean over rows with these counts: C_cd n_cd / (n_c n_d).
Eigen::MatrixXd mean_covariance(const Eigen::MatrixXd& of_rows, const Eigen::MatrixXd& together);

struct Fingerprint {
    Eigen::VectorXd change;   ///< of the mean residual at the reference strength [-]
    double rows = kInfinity;  ///< simulated rows behind it: fewer make it look visible by noise [-]
    bool judged =
        true;  ///< takes part in the largest z: one that nobody could see would be noise that looks for a match
};

/// What measured residuals say, with the parameters projected out.
struct ScoreResult {
    double q = kNaN;             ///< Q [-]
    Eigen::VectorXd z;           ///< of each fingerprint [-]
    Eigen::VectorXd visibility;  ///< d of each fingerprint, less what noise adds [-]
    Eigen::VectorXd
        expected;  ///< z to expect at the reference strength: d less what the noise of the fingerprint takes away [-]
    Eigen::VectorXd standardised;     ///< residuals after recalibration, each over its standard deviation [-]
    Eigen::VectorXd shift;            ///< change of the parameters that a recalibration would make [*]
    Eigen::VectorXd shift_deviation;  ///< standard deviation of the parameters after it [*]
};

class ScoreTest {
public:
    /// `covariance` of single rows; `jacobian`: one column per parameter [1/*]; `deviation`: prior standard deviation of each parameter [*].
    ScoreTest(Eigen::MatrixXd covariance, Eigen::MatrixXd jacobian, Eigen::VectorXd deviation,
              std::vector<Fingerprint> fingerprints);

    ScoreResult operator()(const ResidualMean& r) const;
    /// Cosines between fingerprints, for rows with these counts.
    Eigen::MatrixXd cosines(const Eigen::MatrixXd& together) const;
    const std::vector<Fingerprint>& fingerprints() const { return fingerprints_; }
    /// Those that `judge` says no to are left out of the largest z.
    void judge(std::size_t fingerprint, bool yes) { fingerprints_[fingerprint].judged = yes; }
    /// Largest z of those that are judged, -infinity if none is.
    double largest_z(const ScoreResult& result) const;
    const Eigen::MatrixXd& jacobian() const { return jacobian_; }
    const Eigen::VectorXd& deviation() const { return deviation_; }

private:
    struct Projection {
        Eigen::MatrixXd P, S;       ///< as above, S of the mean over the rows at hand [-]
        Eigen::VectorXd deviation;  ///< of the parameters [*]
        Eigen::MatrixXd gain;       ///< parameters from residuals: (J^T W J + L^-1)^-1 J^T W [*]
    };
    Projection project(const Eigen::MatrixXd& together) const;

    Eigen::MatrixXd covariance_;  ///< [-]
    Eigen::MatrixXd jacobian_;    ///< [1/*]
    Eigen::VectorXd deviation_;   ///< of the parameters [*]
    std::vector<Fingerprint> fingerprints_;
    Eigen::MatrixXd changes_;  ///< theirs, side by side [-]
};

/// Rows of the reference put in the place of the measured ones, as often as asked: what chance gives if nothing is missing.
class NullRows {
public:
    /// `own` are simulated rows of these residuals, and `block` says of which blocks; `measured` says which block each row is of and what was not measured at
    /// all of a block that was there. Where screens saw some blocks pass and nobody knows how many were thrown, as many are drawn as would leave so many records. Keeps a reference to `own`.
    NullRows(const ResidualRows& own, std::span<const std::int32_t> block, std::span<const Residual> residuals,
             const ObservationTable& measured);
    /// Those of the reference.
    NullRows(const ResidualSpace& space, const ObservationTable& measured)
        : NullRows(space.of_reference(), space.reference().block, space.residuals(), measured) {}
    /// Same draw, same rows.
    ResidualRows draw(std::uint64_t seed, std::uint64_t number) const;

private:
    void draw_until_as_many_pass(std::span<const Residual> residuals, const ObservationTable& measured);

    const ResidualRows& own_;
    std::vector<std::vector<std::uint32_t>> rows_of_;  ///< simulated ones per block, and behind them all
    std::vector<std::size_t>
        from_;  ///< per drawn row, which are the measured ones if all are known: which of these it is drawn from
    std::vector<std::vector<char>> unmeasured_;  ///< per drawn row and residual
};

/// Probabilities of the global test, each with those that chance gives by the same rule.
struct GlobalTest {
    double p = 1.0;         ///< of the smaller of the two below, with the price of looking twice [-]
    double p_q = 1.0;       ///< of Q: any disagreement [-]
    double p_z = 1.0;       ///< of the largest z: one that an effect explains [-]
    double z_limit = kNaN;  ///< largest z that rejects at `level` whatever Q is; infinite if nothing is judged [-]
    double q_limit = kNaN;  ///< Q that rejects whatever z is [-]
    double q_mean = kNaN, q_deviation = kNaN;  ///< of Q by chance [-]
    Eigen::VectorXd
        residual_p;  ///< of each standardised residual, corrected for the number of them (max-T: Westfall & Young 1993) [-]
    double residual_limit = kNaN;  ///< largest standardised residual that chance exceeds in `level` of the cases [-]
};
/// Of a change whose visibility is d, Q has the mean q_mean + d^2 and about the variance q_deviation^2 + 4 d^2 (of a noncentral chi-squared variable): the expected
/// z by which the largest z would reject as often, by its normal approximation [-].
double z_of_as_much_power(const GlobalTest& test, double visibility);
GlobalTest global_test(const ScoreTest& test, const ScoreResult& measured, const NullRows& null, std::int64_t draws,
                       double level, std::uint64_t seed);

}  // namespace scree
