// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/qml.hpp"
#include "gis/styles.hpp"
#include "gis/xml.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <regex>

namespace scree::gis {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST(Xml, TextIsEscapedAndForbiddenCharactersAreGone) {
    EXPECT_EQ(xml_text("a < b & \"c\" > d\n"), "a &lt; b &amp; &quot;c&quot; &gt; d&#10;");
    EXPECT_EQ(xml_text(std::string_view("a\0b\x1b", 4)), "a b ");
    EXPECT_EQ(xml_text("Éboulis – 30 °"), "Éboulis – 30 °");
}

TEST(Xml, NumbersAreShortAndReadBackTheSame) {
    EXPECT_EQ(number_text(0.1), "0.1");
    EXPECT_EQ(number_text(0.0), "0");
    EXPECT_EQ(number_text(10000), "10000");
    EXPECT_EQ(number_text(6455600.25), "6455600.25");
    EXPECT_EQ(number_text(-std::numeric_limits<double>::infinity()), "-inf");
    for (const double value : {1.0 / 3.0, 1e300, 1e-300, 6455600.123456789, -0.1 - 0.2}) {
        EXPECT_EQ(std::stod(number_text(value)), value);
    }
}

TEST(Styles, RoundLimitsAreRoundAndInside) {
    EXPECT_THAT(round_limits(0, 70), ElementsAre(0.01, 0.1, 1, 10));
    EXPECT_THAT(round_limits(100, 10000), ElementsAre(200, 500, 1000, 2000, 5000));
    EXPECT_THAT(round_limits(20, 55), ElementsAre(25, 30, 35, 40, 45, 50));
    EXPECT_THAT(round_limits(0.1, 0.45), ElementsAre(0.15, 0.2, 0.25, 0.3, 0.35, 0.4));
    EXPECT_THAT(round_limits(-30, 40), ElementsAre(-20, -10, 0, 10, 20, 30));
    EXPECT_THAT(round_limits(5, 5), IsEmpty());
    EXPECT_THAT(round_limits(793.7999999999998, 793.8), IsEmpty()) << "one mass, computed in two ways";
    EXPECT_THAT(round_limits(ValueRange{}.low, ValueRange{}.high), IsEmpty());
    for (const double high : {0.013, 0.9, 7.3, 88.0, 1234.5, 9.9e8}) {
        for (const double low : {0.0, 0.3 * high, 0.001 * high, -high}) {
            const std::vector<double> limits = round_limits(low, high);
            EXPECT_GE(limits.size(), 2U) << low << ' ' << high;
            EXPECT_LE(limits.size(), 10U) << low << ' ' << high;
            EXPECT_TRUE(std::ranges::is_sorted(limits));
            EXPECT_GT(limits.front(), low);
            EXPECT_LT(limits.back(), high);
        }
    }
}

TEST(Styles, RampsRunFromLightToDark) {
    for (const Ramp ramp : {Ramp::Viridis, Ramp::Inferno, Ramp::Plasma, Ramp::Mako}) {
        double before = 256.0;
        for (std::size_t i = 0; i < 10; ++i) {
            const std::string colour = ramp_colour(ramp, i, 10);
            ASSERT_TRUE(std::regex_match(colour, std::regex("#[0-9a-f]{6}"))) << colour;
            const auto part = [&](std::size_t at) { return std::stoi(colour.substr(at, 2), nullptr, 16); };
            const double light = 0.2126 * part(1) + 0.7152 * part(3) + 0.0722 * part(5);  // Rec. 709 luma
            EXPECT_LT(light, before) << "class " << i;
            before = light;
        }
    }
}

VectorLayer stopping_points() {
    VectorLayer layer;
    layer.data = {"stopping_points",
                  GeometryKind::Point,
                  {{"mass_kg", FieldType::Real, "Mass [kg]"}, {"stop_reason", FieldType::Text, "Reason <of> stopping"}},
                  {}};
    return layer;
}

TEST(Styles, HouseStylesFollowTheFields) {
    VectorLayer layer = stopping_points();
    std::vector<VectorStyle> styles = house_styles(layer.data);
    ASSERT_EQ(styles.size(), 2U);
    EXPECT_EQ(styles[0].colour_by, "mass_kg");
    EXPECT_EQ(styles[1].colour_by, "stop_reason");
    layer.data.fields.clear();
    styles = house_styles(layer.data);
    ASSERT_EQ(styles.size(), 1U);
    EXPECT_THAT(styles[0].colour_by, IsEmpty());
}

// What was measured lies among simulated stops of many colours, what is an input over rasters.
TEST(Styles, MeasuredStopsStandOutAndAreasHideNothing) {
    FeatureLayer layer;
    layer.kind = GeometryKind::Point;
    layer.name = "observed_stops";
    const VectorStyle measured = house_styles(layer).front(), simulated = house_styles(stopping_points().data).front();
    EXPECT_NE(measured.marker, simulated.marker);
    EXPECT_GT(measured.size_mm, simulated.size_mm);
    layer.kind = GeometryKind::Polygon;
    for (const char* name : {"effect_zone", "effect_zone_2", "release", "release_zones", "profile_starts"}) {
        layer.name = name;
        EXPECT_EQ(house_styles(layer).front().opacity, 0.0) << name;
    }
}

TEST(Qml, ClassesOfAVectorLayerCoverAllValuesAndCarryTheUnit) {
    const VectorLayer layer = stopping_points();
    ValueRange range;
    range.add(150.0);
    range.add(9000.0);
    const std::string qml = qml_document(vector_qgis_style(layer, house_styles(layer.data)[0], range));
    EXPECT_THAT(qml, HasSubstr("lower=\"0\" upper=\"200\" label=\"&lt; 200 kg\""));
    EXPECT_THAT(qml, HasSubstr("lower=\"5000\" upper=\"9000\" label=\"&gt; 5000 kg\""));
    EXPECT_THAT(qml, HasSubstr("field=\"mass_kg\" name=\"Mass [kg]\""));
    EXPECT_THAT(qml, HasSubstr("name=\"Reason &lt;of&gt; stopping\""));
}

TEST(Qml, CategoriesHaveARestSoThatNoBlockIsInvisible) {
    const VectorLayer layer = stopping_points();
    const std::string qml = qml_document(vector_qgis_style(layer, house_styles(layer.data)[1], {}));
    for (const char* reason : {"at_rest", "left_terrain", "time_limit", "failed", ""}) {
        EXPECT_THAT(qml, HasSubstr("<category value=\"" + std::string(reason) + "\""));
    }
}

RasterLayer raster(RasterTheme theme, std::string unit, std::vector<float> values) {
    RasterLayer layer{.name = "test", .unit = std::move(unit), .theme = theme};
    layer.values.shape = {.columns = static_cast<int>(values.size()), .rows = 1};
    layer.values.values = std::move(values);
    return layer;
}

TEST(Qml, EnergyClassesKeepTheSwissLimits) {
    const std::string qml = raster_qgis_style(raster(RasterTheme::Energy, "kJ", {0.5F, 40.0F, std::nanf("")})).elements;
    EXPECT_THAT(qml, HasSubstr("<item value=\"30\" label=\"10 – 30 kJ (low)\""));
    EXPECT_THAT(qml, HasSubstr("<item value=\"300\" label=\"100 – 300 kJ (medium)\""));
    EXPECT_THAT(qml, HasSubstr("<item value=\"1000\" label=\"300 – 1000 kJ (high)\""));
    EXPECT_THAT(qml, HasSubstr("<item value=\"inf\" label=\"&gt; 10000 kJ (high)\""));
}

TEST(Qml, CountsAreWholeNumbersAndNoneIsTransparent) {
    const std::string few = raster_qgis_style(raster(RasterTheme::Count, "-", {0.0F, 7.0F})).elements;
    EXPECT_TRUE(std::regex_search(few, std::regex("value=\"0\" label=\"0\" color=\"#ffffff\" alpha=\"0\"")));
    EXPECT_THAT(few, HasSubstr("<item value=\"1\" label=\"1\""));
    EXPECT_THAT(few, HasSubstr("<item value=\"5\" label=\"3 – 5\""));
    EXPECT_THAT(few, HasSubstr("<item value=\"inf\" label=\"6 – 10\""));
    EXPECT_THAT(few, Not(HasSubstr("11 – 20")));
    const std::string many = raster_qgis_style(raster(RasterTheme::Count, "-", {0.0F, 3e6F})).elements;
    EXPECT_THAT(many, HasSubstr("label=\"1000001 – 10000000\""));
    EXPECT_LE(std::count(many.begin(), many.end(), '\n'), 30) << "too many classes to read";
}

TEST(Qml, EmptyRastersHaveAStyleToo) {
    for (const RasterTheme theme :
         {RasterTheme::Generic, RasterTheme::Count, RasterTheme::Terrain, RasterTheme::Energy}) {
        const std::string qml = raster_qgis_style(raster(theme, "m", {std::nanf("")})).elements;
        EXPECT_THAT(qml, Not(HasSubstr("nan")));
    }
}

}  // namespace
}  // namespace scree::gis
