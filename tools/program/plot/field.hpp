#pragma once
/// Draws a field: colours between its points, contours at round values.

#include <functional>
#include <string>
#include <vector>

#include "tools/program/plot/plot.hpp"

namespace cvtflow::tools {

/// Where a value lies in the picture [px].
using Place = std::function<double(double value)>;

/// Round values between minimum and maximum of the field, ascending: the levels of the contours.
[[nodiscard]] std::vector<double> contour_levels(const Field& field);

/// A piece of a contour, in the field's coordinates.
struct Segment {
    Point from, to;
};
/// Where the field, linear along the sides of its cells, has that value.
[[nodiscard]] std::vector<Segment> contour(const Field& field, double level);

/// Colours and contours as SVG.
/// @throws std::invalid_argument for a grid of less than 2 x 2 points, or another number of values than it has points
[[nodiscard]] std::string field_svg(const Field& field, const Place& x, const Place& y);

/// All colours from the minimum of a field, at the bottom, to its maximum; the levels of the contours are marked and labelled.
struct ColourBar {
    std::vector<std::string> labels;  ///< from the bottom upwards; none for a field of one value, which has no bar
    std::string svg;                  ///< 24 px wide around x = 0, from y = 0 down to the height
    double height = 0.0;              ///< [px]
};
[[nodiscard]] ColourBar colour_bar(const Field& field);

/// From dark blue (0) over green to yellow (1), as bright as it is large: distinguishable by colour-blind readers and in grey.
[[nodiscard]] std::string heat_colour(double share);

}  // namespace cvtflow::tools
