// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/resample.hpp"

#include "gis/input_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>

namespace scree::gis {

namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Surface = std::function<double(double, double)>;

double plane(double x, double y) {
    return 300.0 + 0.7 * x - 0.4 * y;
}

Dtm sampled(int columns, int rows, double dx, double dy, const Surface& z) {
    Dtm dtm;
    dtm.columns = columns;
    dtm.rows = rows;
    dtm.dx = dx;
    dtm.dy = dy;
    dtm.north_west = {17.0, 900.0};
    dtm.report.file = "dtm.tif";
    const Box2 box = dtm.bounds();
    for (int r = 0; r < rows; ++r) {
        for (int c = 0; c < columns; ++c)
            dtm.heights.push_back(z(box.min.x() + (c + 0.5) * dx, box.min.y() + (r + 0.5) * dy));
    }
    return dtm;
}

// Every height of the model lies on the surface; returns how many there are.
int expect_on(const Grid<double>& grid, const Surface& z) {
    int valid = 0;
    for (int r = 0; r < grid.shape.rows; ++r) {
        for (int c = 0; c < grid.shape.columns; ++c) {
            if (std::isnan(grid.at(c, r))) continue;
            ++valid;
            const Vec2 p = grid.shape.centre(c, r);
            EXPECT_NEAR(grid.at(c, r), z(p.x(), p.y()), 1e-9) << c << ' ' << r;
        }
    }
    return valid;
}

}  // namespace

TEST(Resample, PlaneStaysThatPlaneForAnyRatio) {
    struct Case {
        double dx, dy, resolution;
    };
    for (const Case& c : {Case{1, 1, 5},
                          {1, 1, 1.5},
                          {0.2, 0.2, 1},
                          {0.7, 1.1, 2},
                          {1, 1, 1.0004},
                          {2, 1, 1.5},
                          {1, 1, 0.3},
                          {4.997678, 4.997678, 5}}) {
        const Dtm dtm = sampled(60, 45, c.dx, c.dy, plane);
        const ResampledDtm result = resample(dtm, c.resolution);
        const int valid = expect_on(result.grid, plane);
        const double area = 60 * c.dx * 45 * c.dy,
                     rim = 2 * (60 * c.dx + 45 * c.dy) * std::max({c.dx, c.dy, c.resolution});
        EXPECT_GE(valid * c.resolution * c.resolution, area - rim) << c.dx << ' ' << c.resolution;
        EXPECT_LT(result.report.max_difference, 1e-9);
        EXPECT_EQ(result.grid.shape.bounds().min.x(), 17.0);
        EXPECT_DOUBLE_EQ(result.grid.shape.bounds().max.y(), 900.0);
    }
}

TEST(Resample, EqualResolutionIsTheIdentity) {
    const Dtm dtm = sampled(20, 15, 2, 2, [](double x, double y) { return std::sin(x) * y; });
    const ResampledDtm result = resample(dtm, 2);
    EXPECT_EQ(result.grid.values, dtm.heights);
    EXPECT_THAT(result.report.warnings, IsEmpty());
}

TEST(Resample, IntegerRatioTakesTheMeanAndConservesIt) {
    const Dtm dtm =
        sampled(50, 40, 0.2, 0.2, [](double x, double y) { return std::sin(3 * x) * std::cos(2 * y) + x * y; });
    const ResampledDtm result = resample(dtm, 1.0);
    ASSERT_EQ(result.grid.values.size(), 80u);
    double first = 0;  // south-west cell: mean of the 25 cells in it
    for (int r = 0; r < 5; ++r) {
        for (int c = 0; c < 5; ++c) first += dtm.at(c, r) / 25;
    }
    EXPECT_NEAR(result.grid.at(0, 0), first, 1e-9);
    const auto mean = [](const std::vector<double>& v) {
        return std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
    };
    EXPECT_NEAR(mean(result.grid.values), mean(dtm.heights), 1e-9);
    EXPECT_GT(result.report.rms_difference, 0.0);
    EXPECT_GE(result.report.max_difference, result.report.rms_difference);
}

TEST(Resample, HolesNeitherBleedNorBend) {
    Dtm dtm = sampled(60, 60, 1, 1, plane);
    // a hole of 10 x 10 m, aligned with the cells of the model in no direction
    for (int r = 22; r < 32; ++r) {
        for (int c = 23; c < 33; ++c) dtm.heights[static_cast<std::size_t>(r * 60 + c)] = kNaN;
    }
    const ResampledDtm result = resample(dtm, 3);
    expect_on(result.grid, plane);
    EXPECT_EQ(result.report.source_nodata, 100u);
    EXPECT_GE(result.report.nodata, 9u);   // cells inside
    EXPECT_LE(result.report.nodata, 16u);  // and those covered by less than half
}

TEST(Resample, FinerThanTheSourceIsSaid) {
    const ResampledDtm result = resample(sampled(10, 10, 5, 5, plane), 1);
    EXPECT_THAT(result.report.warnings, Contains(HasSubstr("adds no information")));
}

TEST(Resample, SenselessResolutionsAreRefused) {
    const Dtm dtm = sampled(10, 10, 5, 5, plane);
    for (const double resolution : {0.0, -1.0, kNaN, 40.0, 1e-4}) {
        EXPECT_THAT(test::input_error_of([&] { resample(dtm, resolution); }), HasSubstr("resolution")) << resolution;
    }
}

}  // namespace scree::gis
