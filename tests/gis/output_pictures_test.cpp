// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures: numbers and escapes of the drawing, relief and contours on ground whose look is known, and the pictures of profiles as XML.
#include "gis/profile_picture.hpp"
#include "gis/relief.hpp"
#include "gis/run_picture.hpp"
#include "gis/svg.hpp"

#include <cpl_minixml.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

namespace scree::test {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Svg, RoundSteps) {
    EXPECT_EQ(gis::round_step(100, 10), 10.0);
    EXPECT_EQ(gis::round_step(101, 10), 20.0);
    EXPECT_EQ(gis::round_step(0.7, 4), 0.2);
    EXPECT_EQ(gis::round_step(3000, 7), 500.0);
    EXPECT_EQ(gis::round_step(0.0, 7), 1.0) << "nothing to divide";
}

TEST(Svg, AxisNumbers) {
    EXPECT_EQ(gis::axis_number(6670040, 20), "6 670 040");
    EXPECT_EQ(gis::axis_number(1500, 100), "1500") << "four digits are read as they are";
    EXPECT_EQ(gis::axis_number(0.3, 0.1), "0.3");
    EXPECT_EQ(gis::axis_number(-12345.5, 0.5), "-12 345.5");
    EXPECT_EQ(gis::axis_number(-1e-12, 0.5), "0.0");
}

TEST(Svg, WordsAreEscaped) {
    gis::Svg svg(100, 50);
    svg.text({10, 10}, "a < b & \"c\"", {.halo = true});
    const std::string text = svg.text();
    EXPECT_THAT(text, HasSubstr("a &lt; b &amp; &quot;c&quot;"));
    CPLXMLNode* xml = CPLParseXMLString(text.c_str());
    ASSERT_NE(xml, nullptr);
    CPLDestroyXMLNode(xml);
}

TEST(Svg, PanelsPointUpwards) {
    const gis::SvgPanel panel{{{100, 50}, {300, 150}}, {{0, 10}, {20, 30}}};
    EXPECT_EQ(panel.at({0, 10}), Vec2(100, 150));
    EXPECT_EQ(panel.at({20, 30}), Vec2(300, 50));
    EXPECT_EQ(panel.scale(), 10.0);
}

/// 60 x 40 cells of 2 m that rise by `east` and `north` per metre, with a hole.
Grid<double> slope(double east, double north) {
    Grid<double> grid(GridShape{60, 40, 2.0, {-10.0, 20.0}});
    for (int j = 0; j < 40; ++j)
        for (int i = 0; i < 60; ++i) {
            const Vec2 p = grid.shape.centre(i, j);
            grid.at(i, j) = east * p.x() + north * p.y();
        }
    grid.at(30, 10) = kNaN;
    return grid;
}

/// Grey and alpha of a relief's pixels, row 0 in the north.
struct Pixels {
    int columns = 0, rows = 0;
    std::vector<unsigned char> grey, alpha;
};
Pixels decoded(const gis::ReliefImage& relief) {
    const std::string head = "data:image/png;base64,";
    EXPECT_EQ(relief.uri.rfind(head, 0), 0U);
    std::string code = relief.uri.substr(head.size());
    const int size = CPLBase64DecodeInPlace(reinterpret_cast<GByte*>(code.data()));
    const char* name = "/vsimem/test_relief.png";
    VSIFCloseL(
        VSIFileFromMemBuffer(name, reinterpret_cast<GByte*>(code.data()), static_cast<vsi_l_offset>(size), FALSE));
    Pixels pixels;
    {
        const GDALDatasetUniquePtr image(GDALDataset::Open(name));
        pixels.columns = image->GetRasterXSize();
        pixels.rows = image->GetRasterYSize();
        const auto count = static_cast<std::size_t>(pixels.columns) * static_cast<std::size_t>(pixels.rows);
        for (auto* band : {&pixels.grey, &pixels.alpha}) {
            band->resize(count);
            const int number = band == &pixels.grey ? 1 : 2;
            EXPECT_EQ(image->GetRasterBand(number)->RasterIO(GF_Read, 0, 0, pixels.columns, pixels.rows, band->data(),
                                                             pixels.columns, pixels.rows, GDT_Byte, 0, 0, nullptr),
                      CE_None);
        }
    }
    VSIUnlink(name);
    return pixels;
}

TEST(Relief, FacesTheLightAndLeavesHolesOpen) {
    const Box2 all{{-10, 20}, {110, 100}};
    const Pixels lit = decoded(gis::shaded_relief(slope(0.5, -0.5), all));     // falls to the north-west
    const Pixels shadow = decoded(gis::shaded_relief(slope(-0.5, 0.5), all));  // falls to the south-east
    EXPECT_EQ(lit.columns, 60);
    EXPECT_EQ(lit.rows, 40);
    EXPECT_GT(lit.grey[0], shadow.grey[0] + 50);
    EXPECT_EQ(lit.alpha[(39 - 10) * 60 + 30], 0);
    EXPECT_EQ(lit.alpha[(39 - 10) * 60 + 31], 255);
}

TEST(Relief, CoversTheCellsOfTheBox) {
    const gis::ReliefImage relief = gis::shaded_relief(slope(0.5, 0), {{0.5, 30.5}, {19.5, 39.5}});
    const Pixels pixels = decoded(relief);
    EXPECT_EQ(pixels.columns, 10);
    EXPECT_EQ(pixels.rows, 5);
    EXPECT_EQ(relief.extent.min, Vec2(0, 30));
    EXPECT_EQ(relief.extent.max, Vec2(20, 40));
    EXPECT_TRUE(gis::shaded_relief(slope(0.5, 0), {{500, 500}, {600, 600}}).uri.empty());
}

TEST(Relief, ContoursLieAtTheirHeight) {
    int points = 0;
    for (const gis::Contour& c : gis::contours(slope(0.5, 0.25), {{-10, 20}, {110, 100}}, 10.0, 3.0)) {
        EXPECT_NEAR(std::remainder(c.height - 3.0, 10.0), 0.0, 1e-9);
        for (const Vec2& p : c.points) {
            // GDAL draws the outer half cell level
            if (p.x() < -9 || p.x() > 109 || p.y() < 21 || p.y() > 99) continue;
            EXPECT_NEAR(0.5 * p.x() + 0.25 * p.y(), c.height, 1e-6);
            ++points;
        }
    }
    EXPECT_GT(points, 100);
}

TEST(ProfilePicture, SaysWhatItShows) {
    const Grid<double> grid = slope(-0.5, 0.0);
    const std::vector<Vec3> points{{0, 50, 0}, {40, 50, -20}, {80, 50, -40}};
    const std::vector<SoilId> soil{1, 0};
    const Profile profile = make_profile(points, soil);
    gis::ProfileScene scene;
    scene.title = "A & B";
    scene.frame.easting = 900000;
    scene.heights = &grid;
    scene.soils = {"scree", "rock <hard>", "meadow"};
    scene.profiles = {{"1", "80 m long", &profile, {true, false}, 4.0},
                      {"2", "the same", &profile, {false, false}, 0.0}};
    scene.screens = {{"ES1", {{20, 40}, {20, 60}}}, {"far away", {{500, 40}, {500, 60}}}};
    scene.deposit_zones = {{"foot", {Polygon{{{60, 40}, {90, 40}, {90, 60}, {60, 60}}, {}}}}};
    const std::string picture = gis::profile_picture(scene, 0);
    CPLXMLNode* xml = CPLParseXMLString(picture.c_str());
    ASSERT_NE(xml, nullptr);
    CPLDestroyXMLNode(xml);
    for (const char* words :
         {"A &amp; B: profile 1", "80 m long", "scree", "rock &lt;hard&gt;", "ES1, s = 20.0 m", "foot", "Chainage s",
          "Height [m]", "Easting [m]", "900 020", "equal scales", "led straight on"})
        EXPECT_THAT(picture, HasSubstr(words));
    EXPECT_THAT(picture, Not(HasSubstr("meadow"))) << "a soil that the profile does not touch";
    EXPECT_THAT(picture, Not(HasSubstr("far away, s"))) << "a screen that does not cut it";
    EXPECT_THAT(picture, Not(HasSubstr("nan")));
    EXPECT_EQ(picture, gis::profile_picture(scene, 0));
    const std::string plan = gis::profiles_plan(scene);
    EXPECT_THAT(plan, HasSubstr("2 profiles"));
    EXPECT_THAT(plan, Not(HasSubstr("Chainage")));
}

/// A profile straight down a slope, without anything beside it.
struct OneProfile {
    const Grid<double> grid = slope(-0.5, 0.0);
    const Profile profile = make_profile(std::vector<Vec3>{{0, 50, 0}, {80, 50, -40}}, std::vector<SoilId>{0});
    gis::ProfileScene scene;
    OneProfile() {
        scene.heights = &grid;
        scene.soils = {"scree"};
        scene.profiles = {{"1", "", &profile, {false}, 0.0}};
    }
};

TEST(ProfilePicture, NamesAreasWhereThereIsRoom) {
    OneProfile one;
    gis::ProfileScene& scene = one.scene;
    auto zone = [](const char* name, double from) {
        return gis::DrawnArea{name, {Polygon{{{from, 40}, {from + 1.0, 40}, {from + 1.0, 60}, {from, 60}}, {}}}};
    };
    scene.deposit_zones = {zone("behind", 42), zone("the first", 10), zone("the last", 40)};
    const std::string picture = gis::profile_picture(scene, 0);
    const std::string section = picture.substr(picture.find("Height [m]"));
    EXPECT_THAT(section, HasSubstr("the first"));
    EXPECT_THAT(section, HasSubstr("the last"));
    EXPECT_THAT(section, Not(HasSubstr("behind"))) << "its place is taken by the one before it";
}

// In a zone that lies obliquely the middle of its box is outside it.
TEST(ProfilePicture, NamesOfZonesLieInThem) {
    OneProfile one;
    gis::ProfileScene& scene = one.scene;
    const auto x_of_name = [&](const Polygon& polygon) {
        scene.deposit_zones = {{"zone", {polygon}}};
        std::smatch found;
        const std::string plan = gis::profiles_plan(scene);
        EXPECT_TRUE(std::regex_search(plan, found, std::regex("<text x=\"([0-9.]+)\"[^>]*>zone<")));
        return std::stod(found[1]);
    };
    const Polygon leaning{{{10, 40}, {20, 40}, {70, 60}, {60, 60}}, {}},
        there{{{17.5, 40}, {27.5, 40}, {27.5, 60}, {17.5, 60}}, {}},
        with_a_hole{{{10, 40}, {70, 40}, {70, 60}, {10, 60}}, {{{20, 41}, {60, 41}, {60, 45}, {20, 45}}}},
        beside_it{{{10, 40}, {20, 40}, {20, 60}, {10, 60}}, {}};
    EXPECT_NEAR(x_of_name(leaning), x_of_name(there), 0.2);
    EXPECT_NEAR(x_of_name(with_a_hole), x_of_name(beside_it), 0.2);
}

TEST(RunPicture, DrawsPanelsOverTheSameChainages) {
    const std::vector<Vec3> points{{0, 50, 0}, {40, 50, -20}, {80, 50, -40}};
    const std::vector<SoilId> soil{1, 0};
    const Profile profile = make_profile(points, soil);
    gis::ProfileScene scene;
    scene.soils = {"scree", "rock"};
    scene.profiles = {{"1", "", &profile, {false, false}, 4.0, {{60.0, "road & rail"}}}};
    scene.screens = {{"ES1", {{20, 40}, {20, 60}}}};
    gis::DrawnRun run;
    run.title = "A & B: run";
    run.facts = "7 blocks";
    run.cell = 20.0;
    run.paths = {{{4.0, 0.0}, {30.0, -10.0}}, {{4.0, 0.0}, {70.0, -35.0}}};
    run.stops = {{70.0, -35.0}};
    run.panels = {{"Stops [%]", {{"stops", "#0072b2", {0.0, 25.0, 75.0, 0.0}}}, true},
                  {"Energy [kJ]",
                   {{"mean", "#009e73", {1.0, 4.0, kNaN, 2.0}}, {"maximum", "#7f7f7f", {2.0, 8.0, kNaN, 2.0}, "3 2"}}}};
    const std::string picture = gis::run_picture(scene, 0, run);
    CPLXMLNode* xml = CPLParseXMLString(picture.c_str());
    ASSERT_NE(xml, nullptr);
    CPLDestroyXMLNode(xml);
    for (const char* words : {"A &amp; B: run", "7 blocks", "2 paths", "ES1, s = 20.0 m", "road &amp; rail, s = 60.0 m",
                              "Stops [%]", "Energy [kJ]", "maximum", "Chainage s"})
        EXPECT_THAT(picture, HasSubstr(words));
    EXPECT_THAT(picture, Not(HasSubstr("nan")));
    EXPECT_EQ(picture.find("Chainage s"), picture.rfind("Chainage s")) << "the axis is named once, below";
    EXPECT_EQ(picture, gis::run_picture(scene, 0, run));
}

}  // namespace
}  // namespace scree::test
