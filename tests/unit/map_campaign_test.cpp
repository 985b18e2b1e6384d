// SPDX-License-Identifier: GPL-3.0-or-later
// Campaigns in 3D: what is counted in the cells of the map.
#include "scree/ensemble/campaign.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

namespace scree::test {
namespace {

double at(const CellValues& values, CellQuantity quantity) {
    return values[static_cast<std::size_t>(quantity)];
}
const QuantityStatistics& at(const CellStatistics& cell, CellQuantity quantity) {
    return cell.quantities[static_cast<std::size_t>(quantity)];
}

/// A slope that falls to the east and a little to the north, cut into cells that are those of no facet, more of them from west to east than from south to north.
class MapCampaign : public testing::Test {
protected:
    static double ground(double x, double y) { return -0.6 * x - 0.2 * y; }
    MapCampaign() : surface_(grid_terrain(60.0, 1.0, ground)) {
        area_.emplace(release_layer({Points{{kStart.x(), kStart.y(), 0.0}}}), *surface_, ReleasePattern::Random,
                      input_.result_cells);
        input_.surface = surface_.get();
        input_.area = &*area_;
        input_.result_cells = {.columns = 60, .rows = 45, .cell = 1.7, .origin = {-47.3, -33.9}};
        input_.soils = {{"slope", 0.2, 0.5, 0.05}};
        input_.population.shape.shape = BlockShape::Box;  // a cube: its spin does not change in flight
        input_.population.distribution.volume = 0.5;
        input_.population.distribution.ratio_21 = input_.population.distribution.ratio_32 = {1.0, 1.0};
        input_.release.height = 6.0;
        input_.release.speed = 7.0;
        input_.release.azimuth = 60.0 * kDegree;
        input_.release.elevation = 25.0 * kDegree;
        input_.release.spin = 3.0;
        input_.release.count = 1;
    }
    CampaignResult run() const {
        const std::atomic<bool> stop{false};
        return run_campaign(input_, {}, stop);
    }

    static inline const Vec2 kStart{-20.3, -11.2};
    std::unique_ptr<Surface> surface_;
    CampaignInput input_;
    std::optional<ReleaseArea> area_;
};

// Until it lands a block flies along a parabola that is known: in small steps along it, the largest of every cell.
TEST_F(MapCampaign, CellsHoldTheTrueLargestValues) {
    const CampaignResult r = run();
    const double mass = r.blocks[0].mass, side = std::cbrt(0.5);
    EXPECT_NEAR(mass, 0.5 * input_.population.distribution.density, 1e-9);
    // azimuths count clockwise from north
    const double plan = 7.0 * std::cos(25.0 * kDegree);
    const Vec3 velocity(plan * std::sin(60.0 * kDegree), plan * std::cos(60.0 * kDegree),
                        7.0 * std::sin(25.0 * kDegree));
    std::map<std::size_t, CellValues> expected;
    std::size_t landing = 0;
    double apex = 0.0;
    bool rose = false, fell = false;
    for (double t = 0.0;; t += 1e-5) {
        const Vec3 moved(t * velocity.x(), t * velocity.y(),
                         t * velocity.z() - 0.5 * kStandardGravity * t * t + ground(kStart.x(), kStart.y()) + 6.0);
        const Vec2 p = kStart + moved.head<2>();
        const double height = moved.z() - ground(p.x(), p.y());
        const double speed = std::hypot(plan, velocity.z() - kStandardGravity * t);
        const std::size_t cell =
            input_.result_cells.index(input_.result_cells.column_of(p.x()), input_.result_cells.row_of(p.y()));
        landing = cell;
        if (height < side) break;  // half the diagonal of the cube is 0.87 of it
        rose = rose || height > apex;
        fell = fell || height < apex;
        apex = std::max(apex, height);
        CellValues& values = expected[cell];
        const double energy = 0.5 * mass * speed * speed + 0.5 * mass * side * side / 6.0 * 9.0;
        const CellValues here{energy, height, speed, 3.0};
        for (std::size_t k = 0; k < kCellQuantities; ++k) values[k] = std::max(values[k], here[k]);
    }
    EXPECT_TRUE(rose && fell) << "the flight has its highest point above the ground on the way";
    expected.erase(landing);
    ASSERT_GT(expected.size(), 8U);
    for (const auto& [cell, values] : expected) {
        ASSERT_TRUE(r.cells.contains(cell)) << cell;
        const CellStatistics& found = r.cells.at(cell);
        EXPECT_EQ(found.passages, 1);
        EXPECT_EQ(found.deposits, 0);
        EXPECT_NEAR(at(found, CellQuantity::KineticEnergy).largest, at(values, CellQuantity::KineticEnergy), 4.0);
        EXPECT_NEAR(at(found, CellQuantity::PassingHeight).largest, at(values, CellQuantity::PassingHeight), 2e-4);
        EXPECT_NEAR(at(found, CellQuantity::Speed).largest, at(values, CellQuantity::Speed), 2e-4);
        EXPECT_NEAR(at(found, CellQuantity::Spin).largest, 3.0, 1e-9);
    }
}

TEST_F(MapCampaign, CountsClose) {
    input_.release.count = 60;
    input_.release.height_spread = 2.0;
    input_.deposit_zones.push_back(
        {"east", Region(MultiPolygon{Polygon{{{0, -60}, {60, -60}, {60, 60}, {0, 60}}, {}}})});
    input_.soils = {{"slope", 0.1, 0.8, 0.3}};
    const CampaignResult r = run();
    EXPECT_EQ(r.reasons[0] + r.reasons[1] + r.reasons[2] + r.reasons[3], 60);
    std::map<std::size_t, std::int64_t> stops;
    std::int64_t at_rest = 0, in_east = 0;
    for (const BlockResult& b : r.blocks) {
        if (b.reason != StopReason::AtRest) continue;
        ++at_rest;
        in_east += b.stop.x() > 0.0;
        const int column = input_.result_cells.column_of(b.stop.x()), row = input_.result_cells.row_of(b.stop.y());
        if (input_.result_cells.contains(column, row)) ++stops[input_.result_cells.index(column, row)];
    }
    EXPECT_GT(at_rest, 30);
    EXPECT_EQ(r.deposits[0].count, in_east);
    std::int64_t start = 0;
    for (const auto& [cell, found] : r.cells) {
        EXPECT_EQ(found.deposits, stops[cell]);
        EXPECT_GE(found.passages, found.deposits) << "who stops in a cell has come into it";
        EXPECT_LE(found.passages, 60);
        for (const QuantityStatistics& q : found.quantities) EXPECT_EQ(q.histogram.count(), found.passages);
        start = std::max(start, found.passages);
    }
    EXPECT_EQ(start, 60) << "all cross the cell in which they start";
}

// What a net holds lies uphill of it: no block of it stops beyond its line, none passes a screen there, no cell beyond knows of it.
TEST_F(MapCampaign, ANetHoldsBlocksOnItsUphillSide) {
    input_.release.count = 40;
    Effect net = make_effect(EffectKind::Net);
    net.set("capacity", 2e4);
    net.set("height", 30.0);
    net.place.lines = {{{5.0, -60.0, kNaN}, {5.0, 60.0, kNaN}}};
    input_.effects = {net};
    input_.result_cells = {.columns = 60, .rows = 60, .cell = 2.0, .origin = {-61.0, -60.0}};  // a border at x = 5
    const auto half = [](double west, double east) {
        return Region(MultiPolygon{Polygon{{{west, -60}, {east, -60}, {east, 60}, {west, 60}}, {}}});
    };
    input_.deposit_zones = {{"uphill", half(-60.0, 5.0)}, {"downhill", half(5.0, 60.0)}};
    input_.screens = {{"net", {{5.0, -60.0}, {5.0, 60.0}}, -1}, {"above", {{0.0, -60.0}, {0.0, 60.0}}, -1}};
    const CampaignResult r = run();
    EXPECT_EQ(r.reasons[static_cast<std::size_t>(StopReason::AtRest)], 40);
    EXPECT_EQ(r.counters.crossings_struck, 40);
    EXPECT_EQ(r.deposits[0].count, 40);
    EXPECT_EQ(r.deposits[1].count, 0);
    EXPECT_EQ(std::ranges::count(r.crossings, 0, &ScreenCrossing::screen), 0);
    EXPECT_EQ(std::ranges::count(r.crossings, 1, &ScreenCrossing::screen), 40);
    for (const auto& [cell, found] : r.cells) EXPECT_LT(cell % 60, 33U);
    input_.effects[0].set("capacity", 1.0);  // lets nearly all of their energy through
    const CampaignResult weak = run();
    EXPECT_EQ(std::ranges::count(weak.crossings, 0, &ScreenCrossing::screen), 40);
}

}  // namespace
}  // namespace scree::test
