#include "tools/program/plot/field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "tools/program/plot/axis_scale.hpp"

namespace cvtflow::tools {

namespace {

constexpr double piece = 5.0;  ///< length of what has a colour of its own, either way [px]

struct Range {
    double least = INFINITY, largest = -INFINITY;
    [[nodiscard]] double share(double value) const { return largest > least ? (value - least) / (largest - least) : 0.5; }
};

Range range_of(const Field& field) {
    Range range;
    for (const double value : field.values) {
        if (!std::isfinite(value)) continue;
        range.least = std::min(range.least, value);
        range.largest = std::max(range.largest, value);
    }
    return range;
}

/// One cell: its corners at the lower left, lower right, upper right, upper left.
struct Cell {
    double x[2], y[2];
    std::array<double, 4> corners;

    [[nodiscard]] double at(double a, double b) const {
        return (1.0 - b) * ((1.0 - a) * corners[0] + a * corners[1]) + b * ((1.0 - a) * corners[3] + a * corners[2]);
    }
    [[nodiscard]] Point corner(int number) const { return {x[number == 1 || number == 2 ? 1 : 0], y[number >= 2 ? 1 : 0]}; }
    /// Where the side from corner `number` to the next has the value.
    [[nodiscard]] Point crossing(int number, double level) const {
        const int next = (number + 1) % 4;
        const double a = corners[static_cast<std::size_t>(number)], b = corners[static_cast<std::size_t>(next)];
        const double share = (level - a) / (b - a);
        const Point from = corner(number), to = corner(next);
        return {from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)};
    }
};

std::vector<Cell> cells_of(const Field& field) {
    const std::size_t columns = field.x.size(), rows = field.y.size();
    if (columns < 2 || rows < 2 || field.values.size() != columns * rows)
        throw std::invalid_argument(fmt::format("{} values over a grid of {} x {} points", field.values.size(), columns, rows));
    std::vector<Cell> cells;
    const auto value = [&](std::size_t row, std::size_t column) { return field.values[row * columns + column]; };
    for (std::size_t j = 0; j + 1 < rows; ++j) {
        for (std::size_t i = 0; i + 1 < columns; ++i) {
            const Cell cell{{field.x[i], field.x[i + 1]},
                            {field.y[j], field.y[j + 1]},
                            {value(j, i), value(j, i + 1), value(j + 1, i + 1), value(j + 1, i)}};
            if (std::ranges::all_of(cell.corners, [](double corner) { return std::isfinite(corner); })) cells.push_back(cell);
        }
    }
    return cells;
}

int pieces(double length) { return std::max(1, static_cast<int>(std::ceil(std::abs(length) / piece))); }

/// One of 128 colours, so that pieces beside each other often have the same.
std::string colour_of(double share) { return heat_colour(std::round(127.0 * share) / 127.0); }

/// Pieces of a row that have the same colour are one rectangle.
std::string colours(const std::vector<Cell>& cells, const Range& range) {
    std::string made = "<g shape-rendering=\"crispEdges\">\n";
    for (const Cell& cell : cells) {
        const double left = cell.x[0], across = cell.x[1] - left, bottom = cell.y[0], up = bottom - cell.y[1];
        const int columns = pieces(across), rows = pieces(up);
        const double width = across / columns, height = up / rows;
        for (int row = 0; row < rows; ++row) {
            const auto colour = [&](int column) { return colour_of(range.share(cell.at((column + 0.5) / columns, (row + 0.5) / rows))); };
            for (int from = 0, to = 0; from < columns; from = to) {
                const std::string fill = colour(from);
                for (to = from + 1; to < columns && colour(to) == fill;) ++to;
                made += fmt::format("<path fill=\"{}\" d=\"M{:.1f} {:.1f}h{:.1f}v{:.1f}h{:.1f}z\"/>\n", fill, left + from * width,
                                    bottom - (row + 1) * height, (to - from) * width + 0.6, height + 0.6, -(to - from) * width - 0.6);
            }
        }
    }
    return made + "</g>\n";
}

/// Segments that are joined end to end, as the lines that they make.
std::vector<std::vector<Segment>> lines_of(const std::vector<Segment>& segments) {
    const auto near = [](double p, double q) { return std::abs(p - q) <= 1e-9 * (std::abs(p) + std::abs(q)); };  // two cells round alike
    const auto joined = [&](const Segment& a, const Segment& b) {
        const auto same = [&](const Point& p, const Point& q) { return near(p.x, q.x) && near(p.y, q.y); };
        return same(a.from, b.from) || same(a.from, b.to) || same(a.to, b.from) || same(a.to, b.to);
    };
    std::vector<std::vector<Segment>> lines;
    for (const Segment& segment : segments) {
        std::vector<Segment> line{segment};
        std::erase_if(lines, [&](const std::vector<Segment>& other) {
            const bool touches = std::ranges::any_of(other, [&](const Segment& each) { return joined(each, segment); });
            if (touches) line.insert(line.end(), other.begin(), other.end());
            return touches;
        });
        lines.push_back(std::move(line));
    }
    return lines;
}

double level_step(const std::vector<double>& levels) { return levels.size() > 1 ? levels[1] - levels[0] : std::abs(levels.front()); }

/// A line's label, at the piece that is nearest to its middle; none at a line that is shorter than two labels.
std::string label_of(const std::vector<Segment>& line, const std::string& text) {
    constexpr double letter = 6.5, size = 11.0;  // [px]
    double length = 0.0, across = 0.0, up = 0.0;
    for (const Segment& each : line) {
        const double part = std::hypot(each.to.x - each.from.x, each.to.y - each.from.y);
        length += part, across += 0.5 * part * (each.from.x + each.to.x), up += 0.5 * part * (each.from.y + each.to.y);
    }
    if (length < 2.0 * letter * static_cast<double>(text.size())) return "";
    const auto off = [&](const Segment& each) {
        return std::hypot(0.5 * (each.from.x + each.to.x) - across / length, 0.5 * (each.from.y + each.to.y) - up / length);
    };
    const Segment& middle = *std::ranges::min_element(line, {}, off);
    return fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" font-size=\"{}\" stroke=\"#222\" stroke-width=\"2.5\" "
        "paint-order=\"stroke\" fill=\"#fff\">{}</text>\n",
        0.5 * (middle.from.x + middle.to.x), 0.5 * (middle.from.y + middle.to.y) + 4.0, size, text);
}

}  // namespace

std::vector<double> contour_levels(const Field& field) {
    const Range range = range_of(field);
    if (!(range.largest > range.least)) return {};
    std::vector<double> levels;
    for (const Tick& tick : AxisScale({"", Scale::linear, 1.0, range.least, range.largest}, {}).ticks(8)) levels.push_back(tick.value);
    return levels;
}

std::vector<Segment> contour(const Field& field, double level) {
    std::vector<Segment> segments;
    for (const Cell& cell : cells_of(field)) {
        std::vector<Point> crossings;
        for (int side = 0; side < 4; ++side) {
            const bool here = cell.corners[static_cast<std::size_t>(side)] >= level;
            const bool there = cell.corners[static_cast<std::size_t>((side + 1) % 4)] >= level;
            if (here != there) crossings.push_back(cell.crossing(side, level));
        }
        // Four crossings are a saddle: they are on sides 0, 1, 2, 3. Where its middle is on the side of corner 0, that corner and the
        // opposite one are joined, and the crossings around corners 1 and 3 belong together: sides 0 and 1, 2 and 3; else 3 and 0, 1 and 2.
        if (crossings.size() == 4 && (cell.at(0.5, 0.5) >= level) != (cell.corners[0] >= level))
            std::rotate(crossings.begin(), crossings.begin() + 3, crossings.end());
        for (std::size_t k = 0; k + 1 < crossings.size(); k += 2) segments.push_back({crossings[k], crossings[k + 1]});
    }
    return segments;
}

std::string heat_colour(double share) {
    static constexpr std::array<std::array<double, 3>, 6> colours{
        {{68, 1, 84}, {65, 68, 135}, {42, 120, 142}, {34, 168, 132}, {122, 209, 81}, {253, 231, 37}}};
    const double at = std::clamp(share, 0.0, 1.0) * (colours.size() - 1);
    const std::size_t below = std::min(static_cast<std::size_t>(at), colours.size() - 2);
    const double part = at - static_cast<double>(below);
    const auto mixed = [&](std::size_t k) {
        return static_cast<int>(std::lround((1.0 - part) * colours[below][k] + part * colours[below + 1][k]));
    };
    return fmt::format("#{:02x}{:02x}{:02x}", mixed(0), mixed(1), mixed(2));
}

ColourBar colour_bar(const Field& field) {
    constexpr double height = 160.0, stripe = 2.0;
    const Range range = range_of(field);
    const std::vector<double> levels = contour_levels(field);
    if (levels.empty()) return {};
    ColourBar bar{{}, "<g shape-rendering=\"crispEdges\">\n", height};
    for (double y = 0.0; y < height; y += stripe)
        bar.svg += fmt::format("<rect x=\"-12\" y=\"{}\" width=\"24\" height=\"{}\" fill=\"{}\"/>\n", y, stripe,
                               heat_colour(1.0 - (y + 0.5 * stripe) / height));
    bar.svg += "</g>\n";
    for (const double level : levels) {
        const double y = (1.0 - range.share(level)) * height;
        bar.labels.push_back(tick_label(level, level_step(levels)));
        bar.svg += fmt::format("<path d=\"M12 {0:.1f}h4\" stroke=\"#222\"/><text x=\"20\" y=\"{1:.1f}\" class=\"legend\">{2}</text>\n", y,
                               y + 4.0, bar.labels.back());
    }
    return bar;
}

std::string field_svg(const Field& field, const Place& x, const Place& y) {
    Field placed = field;  // colours and contours are linear in the picture, also on a logarithmic axis
    std::ranges::transform(field.x, placed.x.begin(), x);
    std::ranges::transform(field.y, placed.y.begin(), y);
    std::string made = colours(cells_of(placed), range_of(field));
    const std::vector<double> levels = contour_levels(field);
    std::string labels;
    for (const double level : levels) {
        const std::vector<Segment> segments = contour(placed, level);
        if (segments.empty()) continue;
        std::string path;
        for (const Segment& piece : segments)
            path += fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", piece.from.x, piece.from.y, piece.to.x, piece.to.y);
        made += fmt::format("<path class=\"contour\" d=\"{}\" stroke=\"#fff\" stroke-width=\"1.3\" fill=\"none\"/>\n", path);
        for (const std::vector<Segment>& line : lines_of(segments)) labels += label_of(line, tick_label(level, level_step(levels)));
    }
    return made + labels;
}

}  // namespace cvtflow::tools
