#include "tasks/scene/units.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "engine/base/text.hpp"
#include "model/basis/portable_math.hpp"
#include "tasks/scene/parameter_table.hpp"

namespace cvtflow::tasks {

namespace {

/// One unit in SI is 10^decimal · numerator / denominator. The power of ten is kept apart because it can be applied without rounding.
struct Unit {
    std::string_view symbol;
    Dimension dimension;  // in halves
    int decimal;
    double numerator;
    double denominator;
    bool takes_prefix;
};

constexpr std::array units{
    Unit{"1", {}, 0, 1, 1, false},
    Unit{"-", {}, 0, 1, 1, false},
    Unit{"%", {}, -2, 1, 1, false},
    Unit{"m", {2, 0, 0, 0}, 0, 1, 1, true},
    Unit{"cm", {2, 0, 0, 0}, -2, 1, 1, false},
    Unit{"g", {0, 2, 0, 0}, -3, 1, 1, true},
    Unit{"s", {0, 0, 2, 0}, 0, 1, 1, true},
    Unit{"min", {0, 0, 2, 0}, 0, 60, 1, false},
    Unit{"h", {0, 0, 2, 0}, 0, 3600, 1, false},
    Unit{"rad", {0, 0, 0, 2}, 0, 1, 1, true},
    Unit{"deg", {0, 0, 0, 2}, 0, std::numbers::pi, 180, false},
    Unit{"rpm", {0, 0, -2, 2}, 0, 2 * std::numbers::pi, 60, false},
    Unit{"Hz", {0, 0, -2, 0}, 0, 1, 1, true},
    Unit{"N", {2, 2, -4, 0}, 0, 1, 1, true},
    Unit{"Pa", {-2, 2, -4, 0}, 0, 1, 1, true},
    Unit{"bar", {-2, 2, -4, 0}, 5, 1, 1, false},
    Unit{"K", {0, 0, 0, 0, 2}, 0, 1, 1, false},
    Unit{"W", {4, 2, -6, 0}, 0, 1, 1, true},
    Unit{"J", {4, 2, -4, 0}, 0, 1, 1, true},
};

/// The one unit with an offset: it stands alone, not in products.
constexpr std::string_view celsius = "degC";
constexpr double celsius_zero = 27315;  // [0.01 K]

constexpr std::array<std::pair<char, int>, 6> prefixes{{{'n', -9}, {'u', -6}, {'m', -3}, {'k', 3}, {'M', 6}, {'G', 9}}};

struct NamedDimension {
    std::string_view name;
    std::string_view unit;
};

// clang-format off
constexpr std::array<NamedDimension, 33> named_dimensions{{
    {"a plain number", "1"}, {"a length", "m"}, {"an area", "m^2"}, {"a volume", "m^3"}, {"a mass", "kg"},
    {"a time", "s"}, {"an angle", "rad"}, {"a speed", "m/s"}, {"an acceleration", "m/s^2"}, {"an inverse speed", "s/m"},
    {"a rotational speed", "rad/s"}, {"a frequency", "Hz"}, {"a force", "N"}, {"a force rate", "N/s"},
    {"a torque", "N*m"}, {"a pressure", "Pa"}, {"a stiffness", "N/m"}, {"a Hertz stiffness", "N/m^1.5"},
    {"a rotational stiffness", "N*m/rad"}, {"a bending stiffness", "N*m^2"}, {"a damping", "N*s/m"},
    {"a rotational damping", "N*m*s/rad"}, {"a rotational drag", "N*m*s^2/rad^2"}, {"a moment of inertia", "kg*m^2"},
    {"an unbalance", "kg*m"}, {"a density", "kg/m^3"}, {"a pressure rate", "Pa/s"}, {"a flow per pressure", "m^3/s/Pa"},
    {"a temperature", "K"}, {"a viscosity", "Pa*s"}, {"an inverse pressure", "1/Pa"},
    {"a heat capacity", "J/K"}, {"a thermal conductance", "W/K"},
}};
// clang-format on

struct UsualUnits {
    std::string_view si;
    std::array<std::string_view, 3> usual;  // unused places are empty
};

constexpr std::array<UsualUnits, 13> usual_table{{
    {"m", {"mm", "um", "cm"}},
    {"m^2", {"mm^2", "cm^2"}},
    {"m^3", {"cm^3", "mm^3"}},
    {"kg", {"g", "mg"}},
    {"s", {"ms", "us", "ns"}},
    {"rad", {"deg", "mrad"}},
    {"m/s", {"mm/s", "um/s"}},
    {"rad/s", {"rpm"}},
    {"N", {"kN", "MN"}},
    {"Pa", {"GPa", "MPa", "bar"}},
    {"N/m", {"kN/mm", "N/mm", "MN/m"}},
    {"N*m", {"kN*m", "N*mm"}},
    {"K", {celsius}},
}};

constexpr double degrees = 180.0 / std::numbers::pi;
constexpr std::array<DisplayRow, 23> display_table{{
    {"1", "slip", "%", 100.0},
    {"1", "efficiency", "%", 100.0},
    {"1", "creep", "%", 100.0},
    {"1", "error_of", "%", 100.0},
    {"Pa", "tip_pressure", "MPa", 1e-6},
    {"Pa", "modulus", "GPa", 1e-9},
    {"Pa", "", "bar", 1e-5},
    {"m^3/s", "", "l/min", 6e4},
    {"rad/s", "", "rpm", degrees / 6.0},
    {"rad", "", "deg", degrees},
    {"N", "plate", "N", 1.0},
    {"N", "tension", "kN", 1e-3},
    {"N", "clamping", "kN", 1e-3},
    {"N", "tip", "kN", 1e-3},
    {"N", "pin force", "kN", 1e-3},
    {"N", "sheaves", "kN", 1e-3},
    {"N", "bearing_force", "kN", 1e-3},
    {"W", "power_drive", "kW", 1e-3},
    {"W", "power_load", "kW", 1e-3},
    {"m", "deepest", "um", 1e6},
    {"m", "", "mm", 1e3},
    {"s", "time", "ms", 1e3},
    {"s", "interval", "ms", 1e3},
}};

/// A product of units, while it is read.
struct Product {
    Dimension dimension;
    int decimal_halves = 0;
    double numerator = 1.0, denominator = 1.0;
};

std::optional<Unit> find_simple_unit(std::string_view symbol) {
    if (const auto unit = std::ranges::find(units, symbol, &Unit::symbol); unit != units.end()) return *unit;
    if (symbol.size() < 2) return std::nullopt;
    const auto unit = std::ranges::find(units, symbol.substr(1), &Unit::symbol);
    const auto prefix = std::ranges::find(prefixes, symbol.front(), &std::pair<char, int>::first);
    if (unit == units.end() || !unit->takes_prefix || prefix == prefixes.end()) return std::nullopt;
    Unit scaled = *unit;
    scaled.decimal += prefix->second;
    return scaled;
}

/// A simple unit, or a torque without its sign: Nm, kNm, Nmm.
std::optional<Unit> find_unit(std::string_view symbol) {
    if (const auto simple = find_simple_unit(symbol)) return simple;
    const auto newton = symbol.find('N');
    if (newton == std::string_view::npos) return std::nullopt;
    const auto force = find_simple_unit(symbol.substr(0, newton + 1));
    const auto arm = find_simple_unit(symbol.substr(newton + 1));
    if (!force || !arm || !(arm->dimension == Dimension{2, 0, 0, 0})) return std::nullopt;
    return Unit{symbol, {4, 2, -4, 0}, force->decimal + arm->decimal, 1, 1, false};
}

/// Multiplies `product` by unit^(halves/2).
void multiply(Product& product, const Unit& unit, int halves) {
    for (int Dimension::*part : {&Dimension::length, &Dimension::mass, &Dimension::time, &Dimension::angle, &Dimension::temperature})
        product.dimension.*part += unit.dimension.*part * halves / 2;
    product.decimal_halves += unit.decimal * halves;
    const double power = 0.5 * std::abs(halves);
    const double up = power == 1.0 ? unit.numerator : model::portable_pow(unit.numerator, power);
    const double down = power == 1.0 ? unit.denominator : model::portable_pow(unit.denominator, power);
    product.numerator *= halves > 0 ? up : down;
    product.denominator *= halves > 0 ? down : up;
}

/// Reads the exponent after ^ in halves. Empty if it is no multiple of a half within ±8.
std::optional<int> exponent_halves(std::string_view text) {
    const double exponent = engine::number_of(text).value_or(0.0);
    if (!(std::abs(exponent) <= 8.0) || exponent == 0.0 || 2.0 * exponent != std::floor(2.0 * exponent)) return std::nullopt;
    return static_cast<int>(2.0 * exponent);
}

std::string_view unspaced(std::string_view text) {
    const auto first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Reads one factor, "m" or "m^2", into `product`. Returns what is wrong, or nothing.
std::string read_factor(std::string_view factor, int sign, Product& product) {
    const auto caret = factor.find('^');
    const std::string_view symbol = unspaced(factor.substr(0, caret));
    if (symbol.empty()) return "has an incomplete unit";
    const auto unit = find_unit(symbol);
    if (!unit) return fmt::format("has the unknown unit \"{}\"{}", symbol, engine::did_you_mean(likely_symbols(symbol)));
    int halves = 2;
    if (caret != std::string_view::npos) {
        const auto exponent = exponent_halves(unspaced(factor.substr(caret + 1)));
        if (!exponent) return fmt::format("has the unusable power \"{}\"", factor.substr(caret));
        halves = *exponent;
    }
    multiply(product, *unit, sign * halves);
    return {};
}

std::variant<Product, std::string> read_product(std::string_view unit) {
    Product product;
    int sign = 1;
    while (true) {
        const auto end = unit.find_first_of("*/");
        if (std::string wrong = read_factor(unit.substr(0, end), sign, product); !wrong.empty()) return wrong;
        if (end == std::string_view::npos) return product;
        sign = unit[end] == '*' ? 1 : -1;
        unit.remove_prefix(end + 1);
    }
}

/// Replaces the signs that are not ASCII by their ASCII spelling.
std::string in_ascii(std::string_view text) {
    using Spelling = std::pair<std::string_view, std::string_view>;
    static constexpr Spelling micro{"\u00b5", "u"}, mu{"\u03bc", "u"}, dot{"\u00b7", "*"}, operator_dot{"\u22c5", "*"},
        degree{"\u00b0", "deg"};
    static constexpr Spelling inverse{"\u207b\u00b9", "^-1"}, inverse_square{"\u207b\u00b2", "^-2"}, square{"\u00b2", "^2"},
        cube{"\u00b3", "^3"};
    std::string ascii(text);
    for (const auto& [sign, spelling] : {micro, mu, dot, operator_dot, degree, inverse, inverse_square, square, cube})
        for (auto at = ascii.find(sign); at != std::string::npos; at = ascii.find(sign)) ascii.replace(at, sign.size(), spelling);
    return ascii;
}

/// The number in `digits` times 10^shift, correctly rounded: the shift is made in the text.
double shifted(std::string_view digits, int shift) {
    const auto e = digits.find_first_of("eE");
    int exponent = 0;
    if (e != std::string_view::npos) {
        const std::size_t first = e + 1 + (digits[e + 1] == '+' ? 1 : 0);
        std::from_chars(digits.data() + first, digits.data() + digits.size(), exponent);
    }
    return engine::number_of(fmt::format("{}e{}", digits.substr(0, e), exponent + shift)).value_or(std::nan(""));
}

}  // namespace

std::variant<Quantity, std::string> parse_quantity(std::string_view text) {
    const std::string ascii = in_ascii(text);
    std::string_view rest = unspaced(ascii);
    if (rest.starts_with('+')) rest.remove_prefix(1);
    Quantity quantity;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), quantity.number);
    if (error == std::errc::invalid_argument) return std::string("does not begin with a number");
    if (error != std::errc{} || !std::isfinite(quantity.number)) return std::string("is not a finite number");
    const std::string_view digits = rest.substr(0, static_cast<std::size_t>(end - rest.data()));
    const std::string_view unit = unspaced(rest.substr(digits.size()));
    quantity.value = quantity.number;
    if (unit.empty()) return quantity;
    if (unit.front() == ',')
        return fmt::format("has a decimal comma{}", engine::did_you_mean(fmt::format("{}.{}", digits, unit.substr(1))));
    if (unit == celsius) return Quantity{(100 * quantity.number + celsius_zero) / 100, quantity.number, dimension_of("K"), true};
    auto product = read_product(unit);
    if (auto* wrong = std::get_if<std::string>(&product)) return std::move(*wrong);
    const auto& factor = std::get<Product>(product);
    quantity.has_unit = true;
    quantity.dimension = factor.dimension;
    const int whole = factor.decimal_halves / 2;
    quantity.value = shifted(digits, whole) * factor.numerator / factor.denominator;
    if (const int odd = factor.decimal_halves - 2 * whole; odd != 0) quantity.value *= model::portable_pow(10.0, 0.5 * odd);
    if (!std::isfinite(quantity.value)) return std::string("is not a finite number");
    return quantity;
}

std::vector<std::string> unit_symbols() {
    std::vector<std::string> symbols{std::string(celsius)};
    for (const Unit& unit : units) {
        if (unit.symbol == "1" || unit.symbol == "-") continue;
        symbols.emplace_back(unit.symbol);
        for (const auto& prefix : prefixes)
            if (unit.takes_prefix) symbols.push_back(prefix.first + std::string(unit.symbol));
    }
    return symbols;
}

Dimension dimension_of(std::string_view unit) {
    if (unit == celsius) unit = "K";
    const auto product = read_product(unit);
    if (const auto* wrong = std::get_if<std::string>(&product)) throw std::invalid_argument(fmt::format("unit {} {}", unit, *wrong));
    return std::get<Product>(product).dimension;
}

std::string_view dimension_name(const Dimension& dimension) {
    for (const auto& named : named_dimensions)
        if (const auto product = read_product(named.unit); std::get<Product>(product).dimension == dimension) return named.name;
    return {};
}

std::vector<std::string_view> usual_units(std::string_view unit) {
    for (const auto& row : usual_table) {
        if (row.si != unit) continue;
        std::vector<std::string_view> usual(row.usual.begin(), row.usual.end());
        std::erase_if(usual, [](std::string_view symbol) { return symbol.empty(); });
        return usual;
    }
    return {};
}

std::span<const DisplayRow> display_rows() noexcept { return display_table; }

DisplayUnit display_unit(std::string_view name, std::string_view unit) {
    std::string plain(name);
    std::replace_if(
        plain.begin(), plain.end(), [](char c) { return c == '/' || c == '.'; }, '_');
    const std::string_view si = unit.empty() ? "1" : unit;
    for (const DisplayRow& row : display_table) {
        if (row.si == si && plain.find(row.part) != std::string::npos) return {row.shown, row.factor};
    }
    return {unit, 1.0};
}

std::string number_text(double number) {  // by fmt: std::to_chars would bring 100 kB of tables into the core library
    if (number == 0.0) return "0";
    const std::string shortest = fmt::format("{}", number);  // 1234.5, 0.0012, 1.2e-07, inf
    if (!std::isfinite(number)) return shortest;
    const double size = std::abs(number);
    const std::size_t e = std::min(shortest.find('e'), shortest.size()), whole = std::min(shortest.find('.'), e);
    std::string digits = shortest.substr(0, whole) + (whole < e ? shortest.substr(whole + 1, e - whole - 1) : "");
    const std::size_t first = digits.find_first_not_of("-0");
    const int exponent =
        static_cast<int>(whole) - static_cast<int>(first) - 1 + (e < shortest.size() ? std::stoi(shortest.substr(e + 1)) : 0);
    digits = digits.substr(first, digits.find_last_not_of('0') + 1 - first);
    if (digits.size() > 1) digits.insert(1, ".");
    const std::string scientific = fmt::format("{}{}e{}", number < 0.0 ? "-" : "", digits, exponent);
    const std::string fixed = size < 1e16 ? shortest : fmt::format("{:.0f}", number);
    const bool plain = (size >= 0.1 && size < 1e4) || (size >= 1e4 && fixed.size() <= scientific.size());
    return plain ? fixed : scientific;
}

namespace {

/// Units, and words and abbreviations that no rule below corrects.
constexpr std::pair<std::string_view, std::string_view> unit_words[] = {
    {"degC", "C celsius Celsius"}, {"rpm", "U r rev tr min-1"}, {"1/s", "s-1"}, {"s", "sec second seconds"}, {"ms", "msec"}, {"us", "usec"},
    {"deg", "degree degrees"},
};

/// Letters in lower case, without signs and spaces: "kN*m" -> knm.
std::string plain(std::string_view symbol) {
    std::string text;
    for (const char letter : symbol)
        if (letter != '*' && letter != ' ') text += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    return text;
}

/// Units that scenes use, most usual first.
std::vector<std::string> usual_symbols() {
    std::vector<std::string> symbols;
    for (const std::string_view si : {"m", "kg", "s", "rad", "rad/s", "N", "Pa", "N*m"}) {
        symbols.emplace_back(si);
        for (const std::string_view usual : usual_units(si)) symbols.emplace_back(usual);
    }
    return symbols;
}

/// The unit that differs in the case of letters only: "kn" -> kN, "MPA" -> MPa.
std::string other_case(std::string_view symbol) {
    for (const auto& known : {usual_symbols(), unit_symbols()})
        for (const std::string& candidate : known)
            if (candidate != symbol && plain(candidate) == plain(symbol)) return candidate;
    return {};
}

/// A product without its signs that begins with a force or a mass: "Nms" -> N*m*s, "kg m" -> kg*m. Else empty.
std::string split(std::string_view symbol, const std::vector<std::string>& known) {
    constexpr std::array<std::string_view, 6> further{"mm", "cm", "m", "s", "rad", "deg"};
    const auto first = symbol.find_first_of("Ng");
    if (first == std::string_view::npos || std::find(known.begin(), known.end(), symbol.substr(0, first + 1)) == known.end()) return {};
    std::string product(symbol.substr(0, first + 1));
    for (std::string_view rest = symbol.substr(first + 1); !rest.empty();) {
        if (rest.front() == ' ') {
            rest.remove_prefix(1);
            continue;
        }
        const auto next = std::find_if(further.begin(), further.end(), [&](std::string_view unit) { return rest.starts_with(unit); });
        if (next == further.end()) return {};
        product.append("*").append(*next);
        rest.remove_prefix(next->size());
    }
    return product;
}

/// A power without its sign: "mm2" -> mm^2.
std::string with_power(std::string_view symbol, const std::vector<std::string>& known) {
    const std::string_view head = symbol.substr(0, symbol.size() - 1);
    if (symbol.back() != '2' && symbol.back() != '3') return {};
    const bool unit = std::find(known.begin(), known.end(), head) != known.end();
    return unit ? fmt::format("{}^{}", head, symbol.back()) : std::string{};
}

/// Number with at most six digits.
std::string short_text(double value) { return number_text(engine::number_of(fmt::format("{:.6g}", value)).value_or(value)); }

}  // namespace

std::vector<std::string> likely_symbols(std::string_view symbol) {
    if (symbol.empty() || symbol.size() > 20) return {};
    for (const auto& [unit, words] : unit_words)
        if (std::ranges::count(words_of(words), symbol) > 0) return {std::string(unit)};
    const std::vector<std::string> known = unit_symbols();
    for (const std::string& near : {split(symbol, known), with_power(symbol, known), other_case(symbol)})
        if (!near.empty()) return {near};
    // One slip of the fingers, in a word that is long enough to show it: inches are not minutes.
    const std::string near = symbol.size() > 2 ? engine::closest(symbol, known) : std::string{};
    return near.empty() || engine::edit_distance(symbol, near) > 1 ? std::vector<std::string>{} : std::vector{near};
}

std::vector<std::string> likely_quantities(std::string_view text, std::string_view unit) {
    const auto parsed = parse_quantity(text);
    const auto* quantity = std::get_if<Quantity>(&parsed);
    if (quantity == nullptr) return {};
    const std::string number = number_text(quantity->number);
    const std::string written(text.substr(std::min(text.size(), text.find_first_not_of("+-.0123456789eE \t"))));
    if (unit == "rad/s" && quantity->dimension == dimension_of("Hz")) {
        const std::string turns = fmt::format("{} rpm", short_text(60.0 * quantity->value));
        const bool seconds = written.find("s") != std::string::npos;  // 1/s is read as radians and as turns
        return seconds ? std::vector{number + " rad/s", turns} : std::vector{turns};
    }
    const std::string other = other_case(written);
    if (other.empty() || !(dimension_of(other) == dimension_of(unit))) return {};
    return {fmt::format("{} {}", number, other)};
}

std::string quantity_text(double value, std::string_view unit) {
    std::string shortest = fmt::format("{} {}", number_text(value), unit);
    const bool exponent = number_text(value).find('e') != std::string::npos;
    if (!exponent && number_text(value).size() <= 4) return shortest;
    bool in_si = true;
    for (const std::string_view usual : usual_units(unit)) {
        const double factor = std::get<Quantity>(parse_quantity(fmt::format("1 {}", usual))).value;
        const std::string number = short_text(value / factor);
        const std::string text = fmt::format("{} {}", number, usual);
        const bool same = std::get<Quantity>(parse_quantity(text)).value == value && number.find('e') == std::string::npos;
        if (!same || text.size() > shortest.size() - (in_si ? 0 : 1)) continue;
        shortest = text;
        in_si = false;
    }
    return shortest;
}

std::optional<double> read_accuracy(std::string_view text) {
    constexpr double most = 0.5;
    const auto parsed = parse_quantity(text);
    const auto* quantity = std::get_if<Quantity>(&parsed);
    if (quantity == nullptr || !(quantity->dimension == dimension_of("1")) || !(quantity->value > 0.0) || quantity->value > most)
        return std::nullopt;
    return quantity->value;
}

}  // namespace cvtflow::tasks
