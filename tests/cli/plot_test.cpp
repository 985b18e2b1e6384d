// SPDX-License-Identifier: GPL-3.0-or-later
// Axes of the reports' pictures.
#include "cli/plot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scree::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

const gis::SvgPanel kPanel{{{50.0, 20.0}, {150.0, 120.0}}, {{0.0, 0.0}, {1.0, 1.0}}};

TEST(Plot, AnAxisThatIsNotInProportionHasItsEnds) {
    gis::Svg svg(200.0, 200.0);
    draw_x_ends(svg, kPanel, "rolling", "0.005", "0.2");
    draw_y_ends(svg, kPanel, "friction", "0.3", "0.9");
    for (const char* text : {">0.005<", ">0.2<", ">rolling<", ">0.3<", ">0.9<", ">friction<"})
        EXPECT_THAT(svg.text(), HasSubstr(text));
}

TEST(Plot, ATitleThatIsLongerThanItsAxisHasSmallerLetters) {
    const std::string usual = "font-size=\"12.5\"";
    gis::Svg brief(200.0, 200.0), lengthy(200.0, 200.0);
    draw_x_ends(brief, kPanel, "rolling", "0", "1");
    draw_x_ends(lengthy, kPanel, "soil.compact waste.rolling", "0", "1");
    EXPECT_THAT(brief.text(), HasSubstr(usual));
    EXPECT_THAT(lengthy.text(), Not(HasSubstr(usual)));
}

}  // namespace
}  // namespace scree::cli
