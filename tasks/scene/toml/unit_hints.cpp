#include "tasks/scene/toml/unit_hints.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "tasks/scene/toml/units.hpp"

namespace cvtflow::tasks {
namespace {

/// Words and abbreviations that no rule below corrects.
constexpr std::array<std::pair<std::string_view, std::string_view>, 16> words{{{"C", "degC"},
                                                                               {"celsius", "degC"},
                                                                               {"Celsius", "degC"},
                                                                               {"U", "rpm"},
                                                                               {"r", "rpm"},
                                                                               {"rev", "rpm"},
                                                                               {"tr", "rpm"},
                                                                               {"min-1", "rpm"},
                                                                               {"s-1", "1/s"},
                                                                               {"sec", "s"},
                                                                               {"second", "s"},
                                                                               {"seconds", "s"},
                                                                               {"msec", "ms"},
                                                                               {"usec", "us"},
                                                                               {"degree", "deg"},
                                                                               {"degrees", "deg"}}};

/// Small letters, without signs and spaces: "kN*m" -> knm.
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

/// With six digits at most.
std::string short_text(double value) { return number_text(engine::number_of(fmt::format("{:.6g}", value)).value_or(value)); }

}  // namespace

std::vector<std::string> likely_symbols(std::string_view symbol) {
    if (symbol.empty() || symbol.size() > 20) return {};
    const auto word = std::find_if(words.begin(), words.end(), [&](const auto& each) { return each.first == symbol; });
    if (word != words.end()) return {std::string(word->second)};
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

}  // namespace cvtflow::tasks
