/// Pictures: scales of axes, fields with contours, and the SVG.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <regex>

#include "tools/program/plot/axis_scale.hpp"
#include "tools/program/plot/field.hpp"
#include "tools/program/plot/plot.hpp"

namespace cvtflow::tools {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::vector<std::string> labels(const AxisScale& scale, int count) {
    std::vector<std::string> texts;
    for (const Tick& tick : scale.ticks(count)) {
        if (!tick.label.empty()) texts.push_back(tick.label);
    }
    return texts;
}

const Axis logarithmic{"h", Scale::logarithmic, 1.0, {}, {}};

TEST(AxisScale, PlacesAndValuesAreInverse) {
    for (const Scale kind : {Scale::linear, Scale::logarithmic, Scale::symlog}) {
        const AxisScale scale({"", kind, 10.0, 1.0, 1e6}, {});
        for (const double value : {1.0, 3.0, 10.0, 77.0, 1e6}) EXPECT_NEAR(scale.value(scale.place(value)) / value, 1.0, 1e-9);
        EXPECT_EQ(scale.place(1.0), 0.0);
        EXPECT_EQ(scale.place(1e6), 1.0);
    }
}

TEST(AxisScale, DecadesAreEquallyLongOnALogarithmicAxis) {
    const AxisScale scale({"", Scale::logarithmic, 1.0, 1e-8, 1e-4}, {});
    EXPECT_DOUBLE_EQ(scale.place(1e-7), 0.25);
    EXPECT_DOUBLE_EQ(scale.place(1e-6), 0.5);
}

TEST(AxisScale, SymlogIsOddAndContinuesSmoothlyWhereItsLinearPartEnds) {
    const AxisScale scale({"", Scale::symlog, 1e3, -1e6, 1e6}, {});
    EXPECT_DOUBLE_EQ(scale.place(0.0), 0.5);
    for (const double value : {1.0, 999.0, 1001.0, 1e5}) EXPECT_NEAR(scale.place(value) - 0.5, 0.5 - scale.place(-value), 1e-15);
    EXPECT_NEAR(scale.place(1e3 + 1e-9), scale.place(1e3 - 1e-9), 1e-11);
    // 1 of the linear part and 3 decades on either side.
    EXPECT_DOUBLE_EQ(scale.place(1e3) - 0.5, 0.5 / 4.0);
}

TEST(AxisScale, EndsEncloseTheValuesWithAMargin) {
    const AxisScale scale({"", Scale::linear, 1.0, {}, {}}, {2.0, 12.0, NAN, INFINITY});
    EXPECT_NEAR(scale.value(0.0), 1.6, 1e-12);
    EXPECT_NEAR(scale.value(1.0), 12.4, 1e-12);
}

TEST(AxisScale, WithoutValuesOrWithOneStillHasALength) {
    EXPECT_LT(AxisScale({}, {}).place(0.0), AxisScale({}, {}).place(1.0));
    const AxisScale one(logarithmic, {1e-3});
    EXPECT_GT(one.place(1e-3), 0.0);
    EXPECT_LT(one.place(1e-3), 1.0);
    const AxisScale zero({}, {0.0});
    EXPECT_DOUBLE_EQ(zero.place(0.0), 0.5);
}

TEST(AxisScale, LogarithmicLeavesOutWhatIsNotPositive) {
    const AxisScale scale(logarithmic, {-1.0, 0.0, 1e-2, 1.0});
    EXPECT_FALSE(scale.shows(0.0));
    EXPECT_FALSE(scale.shows(-1.0));
    EXPECT_GT(scale.value(0.0), 5e-3);
}

TEST(AxisScale, TicksAreRoundNumbersBetweenTheEnds) {
    EXPECT_THAT(labels(AxisScale({"", Scale::linear, 1.0, 0.0, 1.0}, {}), 5), ElementsAre("0", "0.2", "0.4", "0.6", "0.8", "1"));
    EXPECT_THAT(labels(AxisScale({"", Scale::linear, 1.0, -6e7, 1e6}, {}), 4), ElementsAre("−6·10⁷", "−4·10⁷", "−2·10⁷", "0"));
    EXPECT_THAT(labels(AxisScale({"", Scale::logarithmic, 1.0, 1e-8, 1e-2}, {}), 3), ElementsAre("10⁻⁸", "10⁻⁶", "10⁻⁴", "10⁻²"));
    EXPECT_THAT(labels(AxisScale({"", Scale::logarithmic, 1.0, 1e-7, 1e-6}, {}), 9), ElementsAre("10⁻⁷", "2·10⁻⁷", "5·10⁻⁷", "10⁻⁶"));
    EXPECT_THAT(labels(AxisScale({"", Scale::symlog, 10.0, -1e3, 100.0}, {}), 9), ElementsAre("−10³", "−10²", "−10", "0", "10", "10²"));
}

TEST(AxisScale, WithinADecadeTicksOfALogarithmicAxisAreNiceRatios) {
    const Axis ratio{"ratio", Scale::logarithmic, 1.0, {}, {}};
    EXPECT_THAT(labels(AxisScale(ratio, {0.417, 2.4}), 6), ElementsAre("0.5", "0.75", "1", "1.5", "2"));
    EXPECT_THAT(labels(AxisScale({"", Scale::logarithmic, 1.0, 2e-7, 1.4e-6}, {}), 6),
                ElementsAre("2·10⁻⁷", "3·10⁻⁷", "5·10⁻⁷", "7.5·10⁻⁷", "10⁻⁶"));
    EXPECT_THAT(labels(AxisScale({"", Scale::logarithmic, 1.0, 0.9, 1.1}, {}), 4), ElementsAre("0.9", "0.95", "1", "1.05", "1.1"))
        << "one of them would be too few";
}

TEST(AxisScale, TicksAscendAndAreSeenByTheAxis) {
    for (const Scale kind : {Scale::linear, Scale::logarithmic, Scale::symlog}) {
        const AxisScale scale({"", kind, 5.0, {}, {}}, {0.3, 4e4});
        double last = -INFINITY;
        for (const Tick& tick : scale.ticks(6)) {
            EXPECT_GT(tick.value, last);
            EXPECT_GE(scale.place(tick.value), -1e-9);
            EXPECT_LE(scale.place(tick.value), 1.0 + 1e-9);
            last = tick.value;
        }
        EXPECT_TRUE(std::isfinite(last));
    }
}

TEST(AxisScale, LabelsAreAsShortAsTheStepAllows) {
    EXPECT_EQ(tick_label(0.25, 0.05), "0.25");
    EXPECT_EQ(tick_label(1200.0, 200.0), "1200");
    EXPECT_EQ(tick_label(1.5e6, 5e5), "1.5·10⁶");
    EXPECT_EQ(tick_label(-2e-8, 1e-8), "−2·10⁻⁸");
    EXPECT_EQ(tick_label(1e-25, 1.0), "0");
    EXPECT_EQ(power_of_ten(0), "1");
    EXPECT_EQ(power_of_ten(12, true), "−10¹²");
}

TEST(AxisScale, WithoutLengthIsRefused) {
    EXPECT_THROW(AxisScale({"x", Scale::linear, 1.0, 2.0, 2.0}, {}), std::invalid_argument);
    EXPECT_THROW(AxisScale({"x", Scale::symlog, 0.0, {}, {}}, {}), std::invalid_argument);
}

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

Plot simple() {
    Plot plot;
    plot.title = "A & B";
    plot.x = {"step [s]", Scale::logarithmic, 1.0, 1e-8, 1e-6};
    plot.y = {"error", Scale::linear, 1.0, 0.0, 1.0};
    plot.series = {{"rk4", {{1e-8, 0.0}, {1e-7, 0.5}, {1e-6, 1.0}}, Mark::dot, Line::solid, ""},
                   {"limit", {{1e-8, 1.0}, {1e-6, 0.0}}, Mark::none, Line::dashed, "#888"}};
    return plot;
}

/// Whether every tag is closed, in the right order, and no attribute lacks a quote.
bool well_formed(const std::string& text) {
    static const std::regex tag(R"(<(/?)([a-zA-Z]+)((?: [a-zA-Z:_-]+="[^"<]*")*)\s*(/?)>)");
    std::vector<std::string> open;
    std::size_t covered = 0;
    for (auto match = std::sregex_iterator(text.begin(), text.end(), tag); match != std::sregex_iterator(); ++match) {
        covered += 1;
        if ((*match)[1].length() > 0) {
            if (open.empty() || open.back() != (*match)[2].str()) return false;
            open.pop_back();
        } else if ((*match)[4].length() == 0) {
            open.push_back((*match)[2].str());
        }
    }
    return open.empty() && covered == static_cast<std::size_t>(std::count(text.begin(), text.end(), '<'));
}

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t number = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++number;
    return number;
}

/// Coordinates of a path, in order.
std::vector<Point> path_with(const std::string& text, const std::string& style) {
    const std::regex path("<path d=\"([^\"]*)\"[^>]*" + style);
    std::smatch found;
    std::vector<Point> points;
    if (!std::regex_search(text, found, path)) return points;
    const std::string data = found[1];
    static const std::regex pair(R"([ML](-?[0-9.]+) (-?[0-9.]+))");
    for (auto match = std::sregex_iterator(data.begin(), data.end(), pair); match != std::sregex_iterator(); ++match)
        points.push_back({std::stod((*match)[1]), std::stod((*match)[2])});
    return points;
}

TEST(Svg, IsOneWellFormedDocument) {
    const std::string text = svg(simple());
    EXPECT_TRUE(well_formed(text));
    EXPECT_EQ(text.rfind("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"860\" height=\"540\"", 0), 0u);
    EXPECT_EQ(count(text, "<svg"), 1u);
}

TEST(Svg, ShowsTitleLabelsAndLegend) {
    const std::string text = svg(simple());
    EXPECT_THAT(text, HasSubstr(">step [s]</text>"));
    EXPECT_THAT(text, HasSubstr(">error</text>"));
    EXPECT_THAT(text, HasSubstr("class=\"legend\">rk4</text>"));
    EXPECT_THAT(text, HasSubstr("class=\"legend\">limit</text>"));
    for (const char* tick : {"10⁻⁸", "10⁻⁷", "10⁻⁶"}) EXPECT_THAT(text, HasSubstr("class=\"x\">" + std::string(tick) + "</text>"));
    for (const char* tick : {"0", "0.2", "1"}) EXPECT_THAT(text, HasSubstr("class=\"y\">" + std::string(tick) + "</text>"));
}

TEST(Svg, BreaksALongSubtitleIntoLinesThatFit) {
    Plot plot = simple();
    for (int k = 0; k < 60; ++k) plot.subtitle += (k == 0 ? "word" : " word") + std::to_string(k);
    const std::string text = svg(plot);
    static const std::regex line("y=\"([0-9.]+)\" fill=\"#555\">([^<]*)<");
    std::string joined;
    for (std::sregex_iterator each(text.begin(), text.end(), line), end; each != end; ++each) {
        EXPECT_LT((*each)[2].length(), 130);
        joined += (joined.empty() ? "" : " ") + (*each)[2].str();
    }
    EXPECT_EQ(joined, plot.subtitle);
    EXPECT_THAT(text, HasSubstr("y=\"62\" fill=\"#555\">"));
}

TEST(Svg, EscapesWhatXmlWouldRead) {
    Plot plot = simple();
    plot.series[0].name = "a<b>&\"c\"\x01";
    plot.series[1].colour = "red\" onload=\"x";
    const std::string text = svg(plot);
    EXPECT_THAT(text, HasSubstr(">A &amp; B</text>"));
    EXPECT_THAT(text, HasSubstr(">a&lt;b&gt;&amp;&quot;c&quot;</text>"));
    EXPECT_THAT(text, Not(HasSubstr("\" onload")));
    EXPECT_TRUE(well_formed(text));
}

TEST(Svg, PutsPointsWhereTheAxesSay) {
    const std::vector<Point> line = path_with(svg(simple()), "stroke-dasharray");
    const std::vector<Point> rising = path_with(svg(simple()), "stroke=\"#0072b2\" stroke-width=\"1.6\"");
    ASSERT_EQ(line.size(), 2u);
    ASSERT_EQ(rising.size(), 3u);
    // A decade is half of the axis; up is a smaller y. A tenth of a pixel is drawn.
    EXPECT_NEAR(rising[1].x, 0.5 * (rising[0].x + rising[2].x), 0.11);
    EXPECT_NEAR(rising[1].y, 0.5 * (rising[0].y + rising[2].y), 0.11);
    EXPECT_LT(rising[2].y, rising[0].y);
    EXPECT_NEAR(line[0].y, rising[2].y, 0.01);
    EXPECT_NEAR(line[1].x, rising[2].x, 0.01);
}

TEST(Svg, PointsWithoutAPlaceInterruptTheLine) {
    Plot plot = simple();
    plot.series = {{"rk4", {{1e-8, 0.1}, {1e-7, NAN}, {0.0, 0.2}, {2e-7, 0.3}, {1e-6, 0.4}}, Mark::none, Line::solid, ""}};
    const std::string text = svg(plot);
    EXPECT_THAT(text, Not(HasSubstr("nan")));
    EXPECT_EQ(path_with(text, "stroke=\"#0072b2\"").size(), 3u);
}

TEST(Svg, ShadesARegionWhereItsConditionHolds) {
    Plot plot = simple();
    plot.x = {"x", Scale::linear, 1.0, -1.0, 1.0};
    plot.y = {"y", Scale::linear, 1.0, -1.0, 1.0};
    plot.series.clear();
    plot.regions = {{"circle", [](double x, double y) { return x * x + y * y <= 0.25; }, "#abc"}};
    const std::string text = svg(plot);
    const std::regex run(R"(M([0-9.]+) ([0-9.]+)H([0-9.]+)V([0-9.]+)H[0-9.]+z)");
    std::smatch frame;
    ASSERT_TRUE(std::regex_search(
        text, frame, std::regex("<clipPath[^>]*><rect x=\"([0-9.]+)\" y=\"([0-9.]+)\" width=\"([0-9.]+)\" height=\"([0-9.]+)\"")));
    double area = 0.0;
    for (auto match = std::sregex_iterator(text.begin(), text.end(), run); match != std::sregex_iterator(); ++match)
        area += (std::stod((*match)[3]) - std::stod((*match)[1])) * 1.5;  // rows overlap a little
    const double share = area / (std::stod(frame[3]) * std::stod(frame[4]));
    EXPECT_NEAR(share, 3.14159 * 0.25 / 4.0, 0.01 * share);
    EXPECT_THAT(text, HasSubstr(">circle</text>"));
    EXPECT_TRUE(well_formed(text));
}

TEST(Svg, HasRoomForEveryMark) {
    for (const Mark mark : {Mark::dot, Mark::small_dot, Mark::ring, Mark::square, Mark::diamond, Mark::triangle, Mark::cross}) {
        Plot plot = simple();
        plot.series = {{"", {{1e-7, 0.5}}, mark, Line::none, ""}};
        const std::string text = svg(plot);
        EXPECT_TRUE(well_formed(text));
        EXPECT_EQ(count(text, "stroke=\"#0072b2\""), 1u);
        EXPECT_THAT(text, Not(HasSubstr("class=\"legend\"")));
    }
}

TEST(Svg, OfThousandsOfPointsStaysSmall) {
    Plot plot = simple();
    plot.x = plot.y = Axis{};
    for (int k = 0; k < 5000; ++k) plot.series[0].points.push_back({std::cos(k), std::sin(k)});
    EXPECT_LT(svg(plot).size(), 200000u);
}

TEST(Svg, IsTheSameEveryTime) { EXPECT_EQ(svg(simple()), svg(simple())); }

}  // namespace
}  // namespace cvtflow::tools
