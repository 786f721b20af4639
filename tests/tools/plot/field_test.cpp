#include "tools/program/plot/field.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "tools/program/plot/axis_scale.hpp"

namespace cvtflow::tools {
namespace {

/// z = 2 x + 3 y over a grid of 3 x 2 points.
Field plane() {
    Field field{"z", {0.0, 1.0, 2.0}, {0.0, 1.0}, {}};
    for (const double y : field.y) {
        for (const double x : field.x) field.values.push_back(2.0 * x + 3.0 * y);
    }
    return field;
}

TEST(Field, ContoursOfAPlaneLieOnIt) {
    for (const double level : contour_levels(plane())) {
        for (const Segment& piece : contour(plane(), level)) {
            EXPECT_NEAR(2.0 * piece.from.x + 3.0 * piece.from.y, level, 1e-12);
            EXPECT_NEAR(2.0 * piece.to.x + 3.0 * piece.to.y, level, 1e-12);
        }
    }
    EXPECT_EQ(contour(plane(), 2.5).size(), 2U);  // from (0, 5/6) through (1, 1/6) to (1.25, 0)
}

TEST(Field, ContoursOfASaddleGoRoundTheCornersThatItsMiddleIsNotWith) {
    const Field high{"", {0.0, 1.0}, {0.0, 1.0}, {1.0, 0.0, 0.0, 1.0}};  // z = 1 at (0,0) and (1,1): 0.5 in the middle
    for (const auto& [level, joined] : {std::pair{0.4, true}, {0.6, false}}) {
        const auto segments = contour(high, level);
        ASSERT_EQ(segments.size(), 2U);
        for (const Segment& piece : segments) {
            const double x = 0.5 * (piece.from.x + piece.to.x), y = 0.5 * (piece.from.y + piece.to.y);
            EXPECT_EQ((x - 0.5) * (y - 0.5) < 0.0, joined) << x << ' ' << y;
        }
    }
}

TEST(Field, CellsWithACornerThatIsNotANumberStayEmpty) {
    Field field = plane();
    field.values[0] = NAN;
    for (const Segment& piece : contour(field, 3.5)) EXPECT_GE(std::min(piece.from.x, piece.to.x), 1.0);
    EXPECT_FALSE(contour(field, 3.5).empty());
}

TEST(Field, ValuesThatDoNotFillTheGridAreRefused) {
    Field field = plane();
    field.values.pop_back();
    EXPECT_THROW(static_cast<void>(contour(field, 1.0)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(contour({"", {0.0}, {0.0, 1.0}, {1.0, 2.0}}, 1.0)), std::invalid_argument);
}

TEST(Field, ColoursBecomeBrighter) {
    const auto brightness = [](const std::string& colour) {
        const auto part = [&](std::size_t at) { return std::stoi(colour.substr(at, 2), nullptr, 16); };
        return 0.2126 * part(1) + 0.7152 * part(3) + 0.0722 * part(5);
    };
    for (int k = 0; k < 20; ++k) EXPECT_LT(brightness(heat_colour(0.05 * k)), brightness(heat_colour(0.05 * (k + 1))));
}

TEST(Field, IsInThePictureWithItsColourBar) {
    Plot plot;
    plot.fields = {plane()};
    const std::string text = svg(plot);
    EXPECT_THAT(text, testing::HasSubstr("class=\"contour\""));
    EXPECT_THAT(text, testing::HasSubstr(colour_bar(plane()).svg));
    EXPECT_THAT(text, testing::HasSubstr("class=\"legend\">z<"));
}

/// z = x²: a level's two lines have a label each.
TEST(Field, EveryContourHasALabel) {
    Field field{"z", {-2.0, -1.0, 0.0, 1.0, 2.0}, {0.0, 1.0, 2.0}, {}};
    for (std::size_t row = 0; row < field.y.size(); ++row)
        for (const double x : field.x) field.values.push_back(x * x);
    const std::string text = field_svg(
        field, [](double x) { return 100.0 * x; }, [](double y) { return -100.0 * y; });
    for (const double level : contour_levels(field)) {
        if (contour(field, level).empty()) continue;
        const std::string label = "fill=\"#fff\">" + tick_label(level, 0.5) + "<";
        std::size_t labels = 0;
        for (auto at = text.find(label); at != std::string::npos; at = text.find(label, at + 1)) ++labels;
        EXPECT_EQ(labels, 2U) << level;
    }
}

/// z = log2 x at the corners of one cell: the level 0 is in the middle of the picture, not of the numbers.
TEST(Field, OnALogarithmicAxisContoursAreLinearInThePicture) {
    const Field field{"z", {0.5, 2.0}, {0.0, 1.0}, {-1.0, 1.0, -1.0, 1.0}};
    const std::string text = field_svg(
        field, [](double x) { return 300.0 + 100.0 * std::log2(x); }, [](double y) { return 200.0 - 100.0 * y; });
    EXPECT_THAT(text, testing::HasSubstr("class=\"contour\" d=\"M300.0 200.0L300.0 100.0\""));
}

/// z is 0 … 7: a label lies at its share of the bar's height, where the stripe has the colour that the picture gives to the value.
TEST(Field, TheColourBarHasTheColoursOfTheValuesBesideIt) {
    const ColourBar bar = colour_bar(plane());
    ASSERT_GE(bar.labels.size(), 4u);
    for (const std::string& label : bar.labels) {
        const double share = std::stod(label) / 7.0, y = (1.0 - share) * bar.height;
        EXPECT_THAT(bar.svg, testing::HasSubstr(fmt::format("<path d=\"M12 {:.1f}h4\"", y)));
        EXPECT_THAT(bar.svg, testing::HasSubstr(fmt::format("y=\"{:.1f}\" class=\"legend\">{}<", y + 4.0, label)));
    }
    for (const double y : {0.0, 58.0, 158.0})
        EXPECT_THAT(bar.svg, testing::HasSubstr(fmt::format("y=\"{}\" width=\"24\" height=\"2\" fill=\"{}\"", y,
                                                            heat_colour(1.0 - (y + 1.0) / bar.height))));
    Field flat = plane();
    flat.values.assign(flat.values.size(), 1.0);
    EXPECT_EQ(colour_bar(flat).svg, "");
}

TEST(Field, SeveralPicturesStandBelowOneAnother) {
    Plot plot;
    plot.title = "a";
    Plot other = plot;
    other.title = "b";
    const std::string text = svg(std::vector<Plot>{plot, other});
    EXPECT_THAT(text, testing::HasSubstr("<svg y=\"540\""));
    EXPECT_THAT(text, testing::HasSubstr("viewBox=\"0 0 860 1080\""));
}

}  // namespace
}  // namespace cvtflow::tools
