#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "tools/program/plot/plot.hpp"

namespace cvtflow::tools {

namespace {

/// Room beside the axes of plots that share a horizontal axis and a width.
struct Room {
    double left = 0.0, right = 0.0;  ///< [px]
};

}  // namespace

std::string svg(const std::vector<Plot>& plots) {
    if (plots.size() == 1) return svg(plots.front());
    std::map<std::pair<std::string, double>, Room> rooms;
    for (const Plot& plot : plots) {
        const PictureSize size = picture_size(plot);
        Room& room = rooms[{plot.x.label, plot.width}];
        room = {std::max(room.left, size.left), std::max(room.right, size.right)};
    }
    double width = 0.0, height = 0.0;
    std::string parts;
    for (const Plot& plot : plots) {
        Plot aligned = plot;
        const Room& room = rooms.at({plot.x.label, plot.width});
        aligned.left_room = std::max(aligned.left_room, room.left);
        aligned.right_room = std::max(aligned.right_room, room.right);
        std::string part = svg(aligned);
        part.insert(part.find("<svg") + 4, fmt::format(" y=\"{:g}\"", height));
        parts += part;
        width = std::max(width, plot.width);
        height += picture_size(aligned).height;
    }
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 {0:g} {1:g}\" role=\"img\">\n"
        "<rect width=\"{0:g}\" height=\"{1:g}\" fill=\"#ffffff\"/>\n{2}</svg>\n",
        width, height, parts);
}

}  // namespace cvtflow::tools
