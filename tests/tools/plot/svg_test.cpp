#include <gmock/gmock.h>

#include <cmath>
#include <regex>

#include "tools/program/plot/plot.hpp"

namespace cvtflow::tools {
namespace {

using testing::HasSubstr;
using testing::Not;

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
