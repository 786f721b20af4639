#pragma once
/// Quantities as people write them: corrections of units, and the shortest text of a value.

#include <string>
#include <string_view>
#include <vector>

namespace cvtflow::tasks {

/// Corrections for a symbol that is not a unit, best first: "Nms" -> N*m*s, "RPM" -> rpm, "mm2" -> mm^2. Empty: none is near.
[[nodiscard]] std::vector<std::string> likely_symbols(std::string_view symbol);

/// Corrections for a readable quantity with the wrong dimension: "2000 1/min" for rad/s -> 2000 rpm, "12 nm" for N*m -> 12 N*m.
/// @param text the quantity as written   @param unit the SI unit that is expected
[[nodiscard]] std::vector<std::string> likely_quantities(std::string_view text, std::string_view unit);

/// A value with its unit as people write it: "11 deg" for 0.19198621771937624 rad, "8.12 mm". The text reads back as the same double.
/// @param value in `unit`, an SI unit
[[nodiscard]] std::string quantity_text(double value, std::string_view unit);

}  // namespace cvtflow::tasks
