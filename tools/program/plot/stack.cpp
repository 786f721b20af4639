#include <fmt/format.h>

#include <algorithm>

#include "tools/program/plot/plot.hpp"

namespace cvtflow::tools {

std::string svg(const std::vector<Plot>& plots) {
    if (plots.size() == 1) return svg(plots.front());
    double width = 0.0, height = 0.0;
    std::string parts;
    for (const Plot& plot : plots) {
        Plot aligned = plot;
        for (const Plot& other : plots) {
            if (other.x.label != plot.x.label || other.width != plot.width) continue;
            const PictureSize size = picture_size(other);
            aligned.left_room = std::max(aligned.left_room, size.left);
            aligned.right_room = std::max(aligned.right_room, size.right);
        }
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
