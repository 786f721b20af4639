#pragma once
/// Quantities as people write them: "8.12 mm", "2000 rpm", "5.7e7 N/m", "2.5e10 N/m^1.5", turned into SI; corrections of units, and the
/// shortest text of a value.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace cvtflow::tasks {

/// Exponents of m, kg, s, rad and K, counted in halves (Hertz' stiffness is in N/m^1.5). An angle has a separate dimension: it
/// distinguishes a speed of rotation (rad/s) from a frequency (Hz) and a torque (N*m) from a torsional stiffness (N*m/rad).
struct Dimension {
    int length = 0;
    int mass = 0;
    int time = 0;
    int angle = 0;
    int temperature = 0;
    bool operator==(const Dimension&) const = default;
};

/// A number with its unit, read from text.
struct Quantity {
    double value = 0.0;   ///< number in SI [SI unit of its dimension]
    double number = 0.0;  ///< number as written, before the unit [unit as written]
    Dimension dimension;
    bool has_unit = false;
};

/// Reads "number unit". The unit is a product of symbols with * and /, each with an optional power ^ (halves are allowed); / divides by the
/// one symbol that follows. A torque may be written without a sign (Nm, kNm, Nmm), a temperature in degrees Celsius (80 degC, 80 °C).
/// Prefixes n u m k M G. Unit signs µ · ² ³ ° are understood. A power of ten is moved into the digits, so "8.12 mm" is the same double as
/// 8.12e-3.
/// @return the quantity, or what is wrong with the text (a sentence without the text itself)
[[nodiscard]] std::variant<Quantity, std::string> parse_quantity(std::string_view text);

/// All symbols of single units, with and without prefix: "m", "nm", "um", ….
[[nodiscard]] std::vector<std::string> unit_symbols();

/// Dimension of a unit such as "N*s/m"; "1" is none.
/// @throws std::invalid_argument  unknown unit: an error of the parameter table, not of a user
[[nodiscard]] Dimension dimension_of(std::string_view unit);

/// "a length", "an area", …; empty for a dimension without a name.
[[nodiscard]] std::string_view dimension_name(const Dimension& dimension);

/// Units that people use for a quantity whose SI unit is `unit`, most usual first, without the SI unit itself. "m" -> mm, um, cm.
[[nodiscard]] std::vector<std::string_view> usual_units(std::string_view unit);

/// The unit in which pictures, reports and tables show a quantity.
struct DisplayUnit {
    std::string_view unit;  ///< unit as given, if none is more usual
    double factor = 1.0;    ///< factor from the SI unit
};

/// Unit that shows a quantity whose name contains `part` ('_' for '/' and '.'); the first row that applies counts.
struct DisplayRow {
    std::string_view si, part, shown;
    double factor;  ///< factor from the SI unit
};
[[nodiscard]] std::span<const DisplayRow> display_rows() noexcept;

/// Unit that engineers read: pressures in bar, flows in l/min, speeds of shafts in rpm, slip in %. The only table of these units.
/// @param name of a channel, a column or a key: forces of the chain are in kN, those of a tip in N   @param unit SI unit; empty: none
[[nodiscard]] DisplayUnit display_unit(std::string_view name, std::string_view unit);

/// Shortest decimal text that reads back as the same double: 84, 0.2, 8.12e-3, 2e5. Also valid TOML. number [any unit]
[[nodiscard]] std::string number_text(double number);

/// Corrections for a symbol that is not a unit, best first: "Nms" -> N*m*s, "RPM" -> rpm, "mm2" -> mm^2. Empty: none is near.
[[nodiscard]] std::vector<std::string> likely_symbols(std::string_view symbol);

/// Corrections for a readable quantity with the wrong dimension: "2000 1/min" for rad/s -> 2000 rpm, "12 nm" for N*m -> 12 N*m.
/// @param text the quantity as written   @param unit the SI unit that is expected
[[nodiscard]] std::vector<std::string> likely_quantities(std::string_view text, std::string_view unit);

/// A value with its unit as people write it: "11 deg" for 0.19198621771937624 rad, "8.12 mm". The text reads back as the same double.
/// @param value in `unit`, an SI unit
[[nodiscard]] std::string quantity_text(double value, std::string_view unit);

/// "1 %", "0.01", as a share [1]; nothing unless above 0 and at most a half.
[[nodiscard]] std::optional<double> read_accuracy(std::string_view text);

}  // namespace cvtflow::tasks
