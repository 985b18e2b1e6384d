// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/resample.hpp"

#include "gis/words.hpp"
#include "scree/base/error.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace scree::gis {

namespace {

constexpr double kMaxCells = 4e8;          // of the model: the same limit as for the source [-]
constexpr double kMinValidShare = 0.5;     // of a model cell's window [-]
constexpr double kMaxAmplification = 3.0;  // sum of the absolute weights of a height [-]
constexpr double kRoundOff = 1e-9;         // an overlap or offset below this share of a cell is rounding [-]

// One source row or column that a model row or column overlaps.
struct Share {
    int source = 0;     // row or column [-]
    double weight = 0;  // length of the overlap over that of the window [-]
    double offset = 0;  // centre of the source cell minus centre of the model cell, in windows [-]
};

// The overlaps of `count` model cells along one axis. Positions are measured from a common start in the direction of the anchor.
std::vector<std::vector<Share>> overlaps(int count, double cell, int source_count, double source_cell) {
    std::vector<std::vector<Share>> all(static_cast<std::size_t>(count));
    const double window = std::max(cell, source_cell);
    for (int i = 0; i < count; ++i) {
        const double centre = (i + 0.5) * cell, low = centre - 0.5 * window, high = centre + 0.5 * window;
        const int first = std::max(0, static_cast<int>(std::floor(low / source_cell - kRoundOff)));
        for (int s = first; s < source_count && s * source_cell < high; ++s) {
            const double length = std::min(high, (s + 1) * source_cell) - std::max(low, s * source_cell);
            if (length > kRoundOff * window) {
                all[static_cast<std::size_t>(i)].push_back(
                    {s, length / window, ((s + 0.5) * source_cell - centre) / window});
            }
        }
    }
    return all;
}

// The plane through weighted samples, at offset zero.
class PlaneFit {
public:
    void clear() { samples_.clear(); }
    void add(double x, double y, double z, double weight) { samples_.push_back({x, y, z, weight}); }

    double value() const {
        double total = 0, mean_z = 0;
        Vec2 mean = Vec2::Zero();
        for (const Sample& s : samples_) {
            total += s.weight;
            mean += s.weight * Vec2{s.x, s.y};
            mean_z += s.weight * s.z;
        }
        if (total < kMinValidShare - kRoundOff) return kNaN;
        mean /= total;
        mean_z /= total;
        if (mean.cwiseAbs().maxCoeff() < kRoundOff) return mean_z;  // symmetric: the slope does not matter

        // height = mean_z - slope . mean = sum of h_k z_k with h_k = w_k (1 - d_k . C^-1 mean); C: covariance, d_k: from the mean
        Mat2 covariance = Mat2::Zero();
        for (const Sample& s : samples_) {
            const Vec2 d = Vec2{s.x, s.y} - mean;
            covariance += s.weight / total * d * d.transpose();
        }
        Eigen::SelfAdjointEigenSolver<Mat2> eigen;
        eigen.computeDirect(covariance);
        Vec2 lever = Vec2::Zero();
        for (int k = 0; k < 2; ++k) {
            const Vec2 axis = eigen.eigenvectors().col(k);
            const double along = axis.dot(mean), variance = eigen.eigenvalues()[k];
            if (std::abs(along) < kRoundOff) continue;
            if (variance < 1e-12) return kNaN;  // all samples in one line that does not pass through the centre
            lever += along / variance * axis;
        }
        double height = 0, amplification = 0;
        for (const Sample& s : samples_) {
            const double h = s.weight / total * (1 - (Vec2{s.x, s.y} - mean).dot(lever));
            height += h * s.z;
            amplification += std::abs(h);
        }
        return amplification <= kMaxAmplification ? height : kNaN;
    }

private:
    struct Sample {
        double x, y;    // from the centre, in windows [-]
        double z;       // [m]
        double weight;  // share of the window's area [-]
    };
    std::vector<Sample> samples_;
};

// Bilinear height of the model at a place, NaN outside of its cell centres or beside a hole.
double bilinear(const Grid<double>& grid, const Vec2& p) {
    const double u = (p.x() - grid.shape.origin.x()) / grid.shape.cell - 0.5,
                 v = (p.y() - grid.shape.origin.y()) / grid.shape.cell - 0.5;
    if (u < -kRoundOff || v < -kRoundOff || u > grid.shape.columns - 1 + kRoundOff ||
        v > grid.shape.rows - 1 + kRoundOff)
        return kNaN;
    const int i = std::clamp(static_cast<int>(u), 0, grid.shape.columns - 2),
              j = std::clamp(static_cast<int>(v), 0, grid.shape.rows - 2);
    const double fu = u - i, fv = v - j;
    return (1 - fv) * ((1 - fu) * grid.at(i, j) + fu * grid.at(i + 1, j)) +
           fv * ((1 - fu) * grid.at(i, j + 1) + fu * grid.at(i + 1, j + 1));
}

void compare(const Dtm& dtm, ResampledDtm& result) {
    double sum = 0;
    std::size_t count = 0;
    ResampleReport& report = result.report;
    const Box2 bounds = dtm.bounds();
    for (int r = 0; r < dtm.rows; ++r) {
        for (int c = 0; c < dtm.columns; ++c) {
            const double z = dtm.at(c, r);
            if (std::isnan(z)) {
                ++report.source_nodata;
                continue;
            }
            const double difference = std::abs(
                z - bilinear(result.grid, {bounds.min.x() + (c + 0.5) * dtm.dx, bounds.min.y() + (r + 0.5) * dtm.dy}));
            if (std::isnan(difference)) continue;
            sum += difference * difference;
            report.max_difference = std::max(report.max_difference, difference);
            ++count;
        }
    }
    if (count > 0) report.rms_difference = std::sqrt(sum / static_cast<double>(count));
    report.nodata = static_cast<std::size_t>(
        std::count_if(result.grid.values.begin(), result.grid.values.end(), [](double z) { return std::isnan(z); }));
}

GridShape model_shape(const Dtm& dtm, double resolution) {
    const std::string place =
        words("The resolution of ", resolution, " m for the terrain model '", dtm.report.file, "'");
    if (!(resolution > 0) || !std::isfinite(resolution))
        throw InputError(words(place, " must be a number greater than 0."));
    // cells at the east and south edge that are covered by half or more
    const double columns = std::floor(dtm.columns * dtm.dx / resolution + 0.5 + kRoundOff);
    const double rows = std::floor(dtm.rows * dtm.dy / resolution + 0.5 + kRoundOff);
    if (columns < 2 || rows < 2) {
        throw InputError(words(place, " leaves ", columns, " x ", rows,
                               " cells, too few for a surface (at least 2 x 2); choose a finer one."));
    }
    if (columns * rows > kMaxCells) {
        throw InputError(words(place, " gives ", columns, " x ", rows, " cells, more than the ", kMaxCells,
                               " that are allowed; choose a coarser one or cut "
                               "out the site with gdal_translate -projwin."));
    }
    return {static_cast<int>(columns),
            static_cast<int>(rows),
            resolution,
            {dtm.north_west.x(), dtm.north_west.y() - rows * resolution}};
}

}  // namespace

ResampledDtm resample(const Dtm& dtm, double resolution) {
    ResampledDtm result;
    Grid<double>& grid = result.grid = Grid<double>(model_shape(dtm, resolution), kNaN);
    result.report.resolution = resolution;
    const std::string place = words("The terrain model '", dtm.report.file, "'");

    // rows are counted from the north here, because the anchor lies there
    const auto across = overlaps(grid.shape.columns, resolution, dtm.columns, dtm.dx);
    const auto down = overlaps(grid.shape.rows, resolution, dtm.rows, dtm.dy);
    PlaneFit fit;
    for (int j = 0; j < grid.shape.rows; ++j) {
        for (int i = 0; i < grid.shape.columns; ++i) {
            fit.clear();
            for (const Share& y : down[static_cast<std::size_t>(j)]) {
                for (const Share& x : across[static_cast<std::size_t>(i)]) {
                    const double z = dtm.at(x.source, dtm.rows - 1 - y.source);
                    if (!std::isnan(z)) fit.add(x.offset, -y.offset, z, x.weight * y.weight);
                }
            }
            grid.at(i, grid.shape.rows - 1 - j) = fit.value();
        }
    }

    compare(dtm, result);
    if (result.report.nodata == grid.values.size()) {
        throw InputError(words(place, " has no cell of ", resolution,
                               " m that is covered by heights for at least half; choose a finer resolution or fill "
                               "its holes with gdal_fillnodata.py."));
    }
    if (resolution < (1 - kRoundOff) * std::max(dtm.dx, dtm.dy)) {
        result.report.warnings.push_back(words(place, " has cells of ", dtm.dx, " x ", dtm.dy,
                                               " m: the finer resolution of ", resolution,
                                               " m is interpolated and adds no information about the ground."));
    }
    return result;
}

}  // namespace scree::gis
