// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/soil_zones.hpp"

#include "gis/input_files.hpp"
#include "scree/base/random.hpp"
#include "scree/geometry/surface.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace scree::gis {

namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::vector<std::string> kSoils{"rock", "scree", "meadow"};

struct Zone {
    Ring ring;
    std::string soil;
    double priority = 0;
};

Ring rectangle(double x0, double y0, double x1, double y1) {
    return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

VectorData layer_of(const std::vector<Zone>& zones) {
    VectorData data;
    data.report.file = "zones.gpkg";
    data.report.layer = "zones";
    data.layer.kind = GeometryKind::Polygon;
    data.layer.fields = {{"soil", FieldType::Text, ""}, {"priority", FieldType::Real, ""}};
    for (const Zone& zone : zones) {
        const auto id = static_cast<std::int64_t>(data.layer.features.size()) + 1;
        data.layer.features.push_back({id, MultiPolygon{Polygon{zone.ring, {}}}, {zone.soil, zone.priority}});
    }
    return data;
}

SoilZones zones_of(const std::vector<Zone>& zones, const std::string& priority = "") {
    return SoilZones(layer_of(zones),
                     {.field = "soil", .priority_field = priority, .soils = kSoils, .default_soil = 2});
}

Grid<double> flat(int columns, int rows) {
    return Grid<double>({columns, rows, 1.0, {-0.5, -0.5}}, 5.0);
}

}  // namespace

TEST(SoilZones, EveryFacetTakesTheSoilAtItsCentroid) {
    // nodes at integer coordinates; a zone that covers x < 3.5: the boundary divides one column of cells
    const SoilZones zones = zones_of({{rectangle(-10, -10, 3.5, 50), "rock"}, {rectangle(3.5, -10, 8, 50), "scree"}});
    const Grid<double> grid = flat(11, 5);
    const FacetSoils soils = assign_soils(zones, grid);
    ASSERT_EQ(soils.soil.size(), 2u * 10 * 4);
    for (int j = 0; j < 4; ++j) {
        for (int i = 0; i < 10; ++i) {
            const std::size_t f = 2 * static_cast<std::size_t>(j * 10 + i);
            EXPECT_EQ(soils.soil[f], i + 1 / 3.0 < 3.5 ? 0 : i + 1 / 3.0 < 8 ? 1 : 2) << i;
            EXPECT_EQ(soils.soil[f + 1], i + 2 / 3.0 < 3.5 ? 0 : i + 2 / 3.0 < 8 ? 1 : 2) << i;
        }
    }
    EXPECT_NEAR(soils.report.area[0] + soils.report.area[1] + soils.report.area[2], 40.0, 1e-9);
    EXPECT_NEAR(soils.report.gap_area, 8.0, 1e-9);
    EXPECT_NEAR(soils.report.divided_area, 4.0,
                1e-9);  // the cells from x = 3 to 4; at x = 8 the boundary runs along edges
    EXPECT_THAT(soils.report.warnings, testing::ElementsAre(HasSubstr("8.0 m2 (20.0 %)")));
}

TEST(SoilZones, WarnsWhereBoundariesDivideMuchOfTheTerrain) {
    const FacetSoils soils = assign_soils(zones_of({{rectangle(-10, -10, 1.5, 50), "rock"}}), flat(4, 5));
    EXPECT_NEAR(soils.report.divided_area, 4.0, 1e-9);  // of 12
    EXPECT_THAT(soils.report.warnings, Contains(HasSubstr("divide facets of 4.0 m2 (33.3 %)")));
}

TEST(SoilZones, MeshAndGridAgree) {
    const SoilZones zones = zones_of({{{{1.2, 0.7}, {8.1, 1.9}, {6.3, 7.7}}, "rock"}});
    const Grid<double> grid = flat(10, 10);
    TriangleMesh mesh;
    for (int j = 0; j < 10; ++j) {
        for (int i = 0; i < 10; ++i) mesh.vertices.emplace_back(i, j, 5.0);
    }
    for (int j = 0; j < 9; ++j) {
        for (int i = 0; i < 9; ++i) {
            const int a = j * 10 + i;
            mesh.facets.push_back({a, a + 1, a + 10});
            mesh.facets.push_back({a + 1, a + 11, a + 10});
        }
    }
    const FacetSoils on_grid = assign_soils(zones, grid), on_mesh = assign_soils(zones, mesh);
    EXPECT_EQ(on_grid.soil, on_mesh.soil);
    EXPECT_NEAR(on_grid.report.divided_area, on_mesh.report.divided_area, 1e-9);
    // the bound holds: the assigned area differs from that of the polygon by less
    EXPECT_LT(std::abs(on_grid.report.area[0] - 0.5 * (6.9 * 7.0 - 1.2 * 5.1)), on_grid.report.divided_area);
}

// However squares are parted, soils have the numbers of the facets of the surface.
TEST(SoilZones, FacetsAreNumberedAsThoseOfTheSurface) {
    const SoilZones zones = zones_of({{{{1.3, 1.1}, {8.2, 1.1}, {1.3, 8.1}}, "rock"}});
    Grid<double> grid = flat(10, 10);
    for (int j = 0; j < 10; ++j)
        for (int i = 0; i < 10; ++i) grid.at(i, j) = std::sin(5.0 * i + 3.0 * j * j);
    grid.at(4, 3) = kNaN;
    for (const DiagonalRule rule : {DiagonalRule::Alike, DiagonalRule::ByRelief}) {
        const FacetSoils soils = assign_soils(zones, grid, rule);
        const auto surface = make_grid_surface(grid, soils.soil, rule);
        double area = 0.0;
        for (std::int64_t f = 0; f < surface->facet_count(); ++f) {
            std::array<Vec3, 3> corners;
            SoilId soil = 0;
            if (!surface->facet(f, corners, soil)) continue;
            area += 0.5;
            EXPECT_EQ(soil, zones.soil_at(((corners[0] + corners[1] + corners[2]) / 3.0).head<2>())) << f;
        }
        EXPECT_NEAR(soils.report.area[0] + soils.report.area[1] + soils.report.area[2], area, 1e-9);
        EXPECT_EQ(area, 81.0 - (rule == DiagonalRule::Alike ? 3.0 : 2.0));
    }
}

TEST(SoilZones, HolesInTheTerrainCountForNothing) {
    Grid<double> grid = flat(3, 3);
    grid.at(0, 0) = kNaN;
    const FacetSoils soils = assign_soils(zones_of({{rectangle(-1, -1, 5, 5), "rock"}}), grid);
    EXPECT_NEAR(soils.report.area[0], 3.5, 1e-12);
    EXPECT_EQ(soils.soil[0], 2);
    EXPECT_THAT(soils.report.warnings, IsEmpty());
}

TEST(SoilZones, NamesAreChecked) {
    EXPECT_THAT(test::input_error_of([] {
                    zones_of({{rectangle(0, 0, 1, 1), "rock"}, {rectangle(2, 2, 3, 3), "Rock"}});
                }),
                AllOf(HasSubstr("'Rock'"), HasSubstr("feature 2"), HasSubstr("'rock', 'scree', 'meadow'")));
}

TEST(SoilZones, OverlapsNeedAPriority) {
    const std::vector<Zone> overlapping{{rectangle(0, 0, 6, 4), "rock", 1}, {rectangle(4, 0, 9, 4), "scree", 2}};
    EXPECT_THAT(test::input_error_of([&] { zones_of(overlapping); }),
                AllOf(HasSubstr("features 1 ('rock') and 2 ('scree') by 8.0 m2"), HasSubstr("priority")));
    const SoilZones zones = zones_of(overlapping, "priority");
    EXPECT_EQ(zones.soil_at({5, 2}), 1);
    EXPECT_EQ(zones.soil_at({3, 2}), 0);
    EXPECT_EQ(zones.soil_at({20, 2}), 2);

    const std::vector<Zone> same{{rectangle(0, 0, 6, 4), "rock", 1}, {rectangle(4, 0, 9, 4), "scree", 1}};
    EXPECT_THAT(test::input_error_of([&] { zones_of(same, "priority"); }), HasSubstr("different priorities"));
    EXPECT_NO_THROW(zones_of({{rectangle(0, 0, 6, 4), "rock"}, {rectangle(4, 0, 9, 4), "rock"}}));
}

TEST(SoilZones, SliversOfDigitisingAreWarnedOf) {
    const SoilZones zones = zones_of({{rectangle(0, 0, 5.01, 40), "rock"}, {rectangle(5, 0, 9, 40), "scree"}});
    EXPECT_THAT(zones.warnings(), Contains(HasSubstr("0.40 m2")));
    EXPECT_EQ(zones.soil_at({5.005, 20}), 0);
}

// A field drawn into its neighbour by 1 m, at the end of a long border that is drawn a little inexactly.
TEST(SoilZones, AnOverlapDoesNotHideBehindSlivers) {
    const Ring scree{{5, 0}, {90, 0}, {90, 400}, {4, 400}, {4, 399}, {5, 399}};
    const std::vector<Zone> zones{{rectangle(0, 0, 5.01, 400), "rock"}, {scree, "scree"}};  // 5 m2 along 800 m
    EXPECT_THAT(test::input_error_of([&] { zones_of(zones); }),
                HasSubstr("features 1 ('rock') and 2 ('scree') by 5.0 m2"));
}

TEST(SoilZones, WithoutPolygonsTheDefaultHolds) {
    const FacetSoils soils = assign_soils(
        SoilZones({.field = "soil", .priority_field = "", .soils = kSoils, .default_soil = 1}), flat(4, 4));
    EXPECT_EQ(soils.soil, std::vector<SoilId>(18, 1));
    EXPECT_THAT(soils.report.warnings, IsEmpty());
}

TEST(SoilZones, ManyZonesAreLocated) {
    std::vector<Zone> tiles;
    for (int j = 0; j < 30; ++j) {
        for (int i = 0; i < 30; ++i)
            tiles.push_back(
                {rectangle(i * 10, j * 10, i * 10 + 10, j * 10 + 10), kSoils[static_cast<std::size_t>(i + j) % 3]});
    }
    const SoilZones zones = zones_of(tiles);
    RandomStream random(3, 0, RandomPurpose::ReleasePosition);
    for (int k = 0; k < 2000; ++k) {
        const Vec2 p{random.uniform(0, 300), random.uniform(0, 300)};
        ASSERT_EQ(zones.soil_at(p), (static_cast<int>(p.x() / 10) + static_cast<int>(p.y() / 10)) % 3);
    }
}

}  // namespace scree::gis
