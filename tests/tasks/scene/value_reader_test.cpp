#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

#include "model/parameters/parameters.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml_tree.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::tasks {
namespace {

/// Reads `toml` as the value of `key`; returns the first problem's message, or nothing.
std::string read(const std::string& key, const std::string& toml, Scene& scene) {
    std::vector<Problem> problems;
    const auto document = std::get<Node>(parse_toml("value = " + toml));
    read_value(*find_parameter(key), std::get<Node::Table>(document.value).at(0).node, scene, problems);
    return problems.empty() ? std::string{} : problems.front().message;
}

TEST(ValueReader, ReadsNumbersTextsWithUnitsListsAndTables) {
    Scene scene;
    const model::Parameters& p = scene.parameters;
    EXPECT_EQ(read("half.length", "40e-3", scene), "");
    EXPECT_EQ(p.half.length, 40e-3);
    EXPECT_EQ(read("half.length", "1", scene), "");
    EXPECT_EQ(p.half.length, 1.0);
    EXPECT_EQ(read("half.mass", "\"4.42 g\"", scene), "");
    EXPECT_EQ(p.half.mass, 4.42e-3) << "the same double";
    EXPECT_EQ(read("chain.damping_ratio", "\"5 %\"", scene), "");
    EXPECT_EQ(p.chain.damping_ratio, 0.05);
    EXPECT_EQ(read("chain.pitch", "\"8 mm\"", scene), "");
    EXPECT_EQ(p.chain.pitch, std::vector{8e-3});
    EXPECT_EQ(read("chain.pitch", "[8.12e-3, \"7.5 mm\"]", scene), "");
    EXPECT_EQ(p.chain.pitch, (std::vector{8.12e-3, 7.5e-3}));
    EXPECT_EQ(read("load.torque", "\"120 N*m\"", scene), "");
    EXPECT_EQ(p.load.torque, model::TimeTable(120.0));
    EXPECT_EQ(read("load.torque", "[[0.0, 0.0], [\"10 ms\", \"150 N*m\"]]", scene), "");
    EXPECT_EQ(p.load.torque, model::TimeTable({0.0, 0.01}, {0.0, 150.0}));
}

TEST(ValueReader, AWrongValueLeavesTheMemberAsItWas) {
    Scene scene;
    for (const auto& [key, value] :
         {std::pair{"half.length", "\"36 kg\""}, {"chain.pitch", "[8e-3, 8.0]"}, {"load.torque", "[[0, 1], [0, 2]]"}})
        EXPECT_NE(read(key, value, scene), "") << key;
    EXPECT_EQ(scene.parameters, model::Parameters{});
}

TEST(ValueReader, TimeTableHoldsTenThousandPointsAndNoMore) {
    const auto points = [](int count) {
        std::string text = "[";
        for (int i = 0; i < count; ++i) text += fmt::format("[{}, 1],", i);
        return text + "]";
    };
    Scene scene;
    EXPECT_EQ(read("load.torque", points(10000), scene), "");
    EXPECT_EQ(scene.parameters.load.torque.time.size(), 10000U);
    EXPECT_EQ(read("load.torque", points(10001), scene), "load.torque: 10001 points are more than 10000");
}

TEST(ValueReader, GuessedUnitIsTheOneNearestToTheDefault) {
    Scene scene;
    EXPECT_EQ(read("run.step", "200", scene), "run.step: 200 s is outside [1e-12, 1e-2] s (did you mean \"200 ns\"?)");
    EXPECT_EQ(read("run.state_interval", "1e300", scene), "run.state_interval: 1e300 s is outside [1e-12, 1e4] s");
}

TEST(ValueReader, LimitsThemselvesAreAllowed) {
    Scene scene;
    for (const Parameter& parameter : parameter_table()) {
        if (parameter.unit.empty()) continue;
        const bool integer = parameter.kind() == Kind::integer;
        for (const double limit : {parameter.min, parameter.max}) {
            const auto text = integer ? std::to_string(static_cast<std::int64_t>(limit)) : number_text(limit);
            EXPECT_EQ(read(std::string(parameter.key), text, scene), "") << parameter.key;
        }
    }
}

TEST(ValueReader, EveryNumberRefusesAWrongDimensionAndBadNumbers) {
    Scene scene;
    for (const Parameter& parameter : parameter_table()) {
        if (parameter.unit.empty()) continue;
        const std::string key(parameter.key);
        for (const char* bad : {"\"1 m*s*kg\"", "nan", "inf", "-inf", "1e300", "-1e300", "true", "\"\"", "{}", "[]", "07:32:00"})
            EXPECT_EQ(read(key, bad, scene).substr(0, key.size() + 2), key + ": ") << bad;
    }
    EXPECT_EQ(scene.parameters, model::Parameters{});
    EXPECT_EQ(scene.run, RunSettings{});
}

double si(std::string_view text) { return std::get<Quantity>(parse_quantity(text)).value; }

std::string quantity_complaint(std::string_view text) { return std::get<std::string>(parse_quantity(text)); }

/// Text, and its value in SI units to the last bit.
TEST(Units, MultiplyExactly) {
    for (const auto& [text, value] : {std::pair{"8.12 mm", 8.12e-3},
                                      {"27.1 kN", 27.1e3},
                                      {"20 us", 20e-6},
                                      {"4.42 g", 4.42e-3},
                                      {"0.65 g", 0.65e-3},
                                      {"15.65 mm^2", 15.65e-6},
                                      {"210 GPa", 2.1e11},
                                      {"1.5e2 mm", 0.15},
                                      {"5 cm", 0.05},
                                      {"2 %", 0.02},
                                      {"3 bar", 3e5},
                                      {"5.7e7 N/m", 5.7e7},
                                      {"150 N*m", 150.0},
                                      {"57 kN/mm", 5.7e7},
                                      {"2e5 N*s/m", 2e5},
                                      {"8e-3 kg*m^2", 8e-3},
                                      {"80 kg*cm^2", 8e-3},
                                      {"3 m*s^-1", 3.0},
                                      {"200 1/s", 200.0},
                                      {"20 µs", 20e-6},
                                      {"150 N·m", 150.0},
                                      {"15.65 mm²", 15.65e-6},
                                      {"11°", model::Tip{}.angle},
                                      {"11 deg", model::Tip{}.angle},
                                      {"8.12mm", 8.12e-3},
                                      {"  -8.12   mm ", -8.12e-3},
                                      {"+8.12 mm", 8.12e-3},
                                      {"150 N * m", 150.0},
                                      {"12 Nm", 12.0},
                                      {"8 kNm", 8e3},
                                      {"8 Nmm", 8e-3},
                                      {"5 Ncm", 0.05},
                                      {"200 Nm/rad", 200.0},
                                      {"2000 rpm", model::Drive{}.speed.at(0.0)}})
        EXPECT_EQ(si(text), value) << text;
}

TEST(Units, MultiplyWithinOneRounding) {
    for (const auto& [text, value] : {std::pair{"11 deg", 11.0 * std::numbers::pi / 180.0},
                                      {"2000 rpm", 2000.0 * 2.0 * std::numbers::pi / 60.0},
                                      {"2 min", 120.0},
                                      {"180 N*m/deg", 180.0 * 180.0 / std::numbers::pi},
                                      {"2.5e10 N/m^1.5", 2.5e10},
                                      {"1 N/mm^1.5", std::pow(1e3, 1.5)}})
        EXPECT_DOUBLE_EQ(si(text), value) << text;
    EXPECT_EQ(dimension_of("kNm"), dimension_of("N*m"));
}

TEST(Units, DegreesCelsiusStandAlone) {
    EXPECT_EQ(si("80 degC"), 353.15);
    EXPECT_EQ(si("-40 °C"), 233.15);
    EXPECT_EQ(std::get<Quantity>(parse_quantity("80 degC")).dimension, dimension_of("K"));
    EXPECT_THAT(quantity_complaint("1 J/degC"), testing::HasSubstr("unknown unit \"degC\""));
    EXPECT_THAT(quantity_complaint("80 C"), testing::HasSubstr("did you mean \"degC\""));
}

TEST(Units, SlashDividesByTheNextSymbolOnly) { EXPECT_EQ(std::get<Quantity>(parse_quantity("1 N/m*s")).dimension, dimension_of("N*s/m")); }

TEST(Units, NumberAloneHasNoUnit) {
    const auto quantity = std::get<Quantity>(parse_quantity("0.09"));
    EXPECT_FALSE(quantity.has_unit);
    EXPECT_EQ(quantity.value, 0.09);
    EXPECT_EQ(quantity.dimension, Dimension{});
}

TEST(Units, WrongTextsAreNamed) {
    for (const auto& [text, complaint] : {std::pair{"mm", "does not begin with a number"},
                                          {"", "does not begin with a number"},
                                          {"nan m", "is not a finite number"},
                                          {"1e999 m", "is not a finite number"},
                                          {"1e308 Gm", "is not a finite number"},
                                          {"8 mmm", "has the unknown unit \"mmm\" (did you mean \"mm\"?)"},
                                          {"8 N*", "has an incomplete unit"},
                                          {"8 m^0", "has the unusable power \"^0\""},
                                          {"8 m^0.3", "has the unusable power \"^0.3\""},
                                          {"8 mdeg", "has the unknown unit"}})
        EXPECT_THAT(quantity_complaint(text), testing::StartsWith(complaint)) << text;
}

TEST(Units, AMisspeltUnitIsCorrected) {
    const auto corrected = [](const std::string& written, const std::string& meant) {
        EXPECT_EQ(quantity_complaint("8 " + written), "has the unknown unit \"" + written + "\" (did you mean \"" + meant + "\"?)");
    };
    for (const auto& [written, meant] :
         {std::pair{"RPM", "rpm"}, {"Rpm", "rpm"}, {"U", "rpm"},     {"min-1", "rpm"}, {"kn", "kN"},    {"KN", "kN"},   {"Bar", "bar"},
          {"mpa", "MPa"},          {"MPA", "MPa"}, {"KG", "kg"},     {"Kg", "kg"},     {"MM", "mm"},    {"HZ", "Hz"},   {"NM", "N*m"},
          {"knm", "kN*m"},         {"Ns", "N*s"},  {"Nms", "N*m*s"}, {"N m", "N*m"},   {"mm2", "mm^2"}, {"msec", "ms"}, {"degrees", "deg"}})
        corrected(written, meant);
    EXPECT_EQ(quantity_complaint("2 in"), "has the unknown unit \"in\"") << "inches are not minutes";
    EXPECT_EQ(quantity_complaint("2 psi"), "has the unknown unit \"psi\"");
    EXPECT_EQ(quantity_complaint("12,5 N*m"), "has a decimal comma (did you mean \"12.5 N*m\"?)");
}

TEST(Units, AQuantityOfAnotherKindIsCorrected) {
    using Texts = std::vector<std::string>;
    for (const char* revolutions : {"2000 1/min", "2000 min^-1", "2000 min\u207b\u00b9"})
        EXPECT_EQ(likely_quantities(revolutions, "rad/s"), Texts{"2000 rpm"}) << revolutions;
    EXPECT_EQ(likely_quantities("30 Hz", "rad/s"), Texts{"1800 rpm"});
    EXPECT_EQ(likely_quantities("30 1/s", "rad/s"), (Texts{"30 rad/s", "1800 rpm"}));
    EXPECT_EQ(likely_quantities("12 nm", "N*m"), Texts{"12 N*m"});
    EXPECT_EQ(likely_quantities("12 mm", "N*m"), Texts{});
}

TEST(Units, DimensionsHaveNames) {
    for (const auto& [unit, name] :
         {std::pair{"kN/mm", "a stiffness"}, {"rpm", "a rotational speed"}, {"1", "a plain number"}, {"m*s", ""}})
        EXPECT_EQ(dimension_name(dimension_of(unit)), name);
    EXPECT_THROW((void)dimension_of("furlong"), std::invalid_argument);
    EXPECT_NE(dimension_of("rad/s"), dimension_of("Hz")) << "an angle distinguishes rotation from frequency";
    EXPECT_NE(dimension_of("N*m/rad"), dimension_of("N*m"));
}

TEST(Units, UsualUnitsHaveTheDimensionOfTheirSiUnit) {
    for (const char* unit : {"m", "m^2", "kg", "s", "rad", "m/s", "rad/s", "N", "Pa", "N/m", "N*m", "K"}) {
        EXPECT_FALSE(usual_units(unit).empty()) << unit;
        for (const auto usual : usual_units(unit)) EXPECT_EQ(dimension_of(usual), dimension_of(unit)) << usual;
    }
    EXPECT_TRUE(usual_units("N/s").empty());
}

/// Factors as the reader of quantities has them; l/min = 1e-3/60 m^3/s, which it does not read.
TEST(Units, OfDisplayAreThoseOfEngineersWithTheirFactors) {
    struct Shown {
        const char *name, *si;
        std::string_view unit;
    };
    for (const auto& [name, si, shown] : {Shown{"shaft_1/pressure", "Pa", "bar"},
                                          {"pump_line_pressure_max", "Pa", "bar"},
                                          {"wear/tip_pressure", "Pa", "MPa"},
                                          {"shaft_1/speed", "rad/s", "rpm"},
                                          {"drive.speed", "rad/s", "rpm"},
                                          {"tight_tension", "N", "kN"},
                                          {"clamping.driven", "N", "kN"},
                                          {"tips/axial_force", "N", "kN"},
                                          {"pin force", "N", "kN"},
                                          {"followed_pin/plate_tension", "N", "N"},
                                          {"shaft_1/torque", "N*m", "N*m"},
                                          {"shaft_1/radius", "m", "mm"},
                                          {"tip.angle", "rad", "deg"},
                                          {"slip_mean", "1", "%"},
                                          {"error_of_tight_tension_mean", "1", "%"},
                                          {"efficiency_with_pump", "1", "%"}}) {
        const DisplayUnit unit = display_unit(name, si);
        EXPECT_EQ(unit.unit, shown) << name;
        const auto one = parse_quantity(fmt::format("1 {}", shown));
        ASSERT_TRUE(std::holds_alternative<Quantity>(one)) << name;
        EXPECT_NEAR(unit.factor * std::get<Quantity>(one).value, 1.0, 1e-14) << name;
        EXPECT_EQ(std::get<Quantity>(one).dimension, dimension_of(si)) << name;
    }
    EXPECT_EQ(display_unit("slip_mean", "").unit, "%") << "of a CSV";
    EXPECT_EQ(display_unit("shaft_1/oil_flow", "m^3/s").unit, "l/min");
    EXPECT_DOUBLE_EQ(display_unit("shaft_1/oil_flow", "m^3/s").factor, 60.0 / 1e-3);
    EXPECT_EQ(display_unit("ratio", "1").factor, 1.0);
}

TEST(NumberText, IsShortAndReadsBackEqual) {
    for (const auto& [number, text] :
         {std::pair{84.0, "84"}, {8.12e-3, "8.12e-3"}, {0.2, "0.2"}, {2e5, "2e5"}, {27100.0, "27100"}, {-2000.0, "-2000"}, {0.0, "0"}})
        EXPECT_EQ(number_text(number), text);
    for (const double number : {1.0 / 3.0, 209.43951023931953, 1e-300, 5e-324, 1.7976931348623157e308, -0.19198621771937624})
        EXPECT_EQ(std::strtod(number_text(number).c_str(), nullptr), number);
}

TEST(NumberText, HasTheDigitsOfTheStandardLibrary) {
    const auto expected = [](double number) {
        const auto written = [number](std::chars_format format) {
            char text[400];
            return std::string(text, std::to_chars(text, text + sizeof text, number, format).ptr);
        };
        std::string scientific = written(std::chars_format::scientific);
        const std::size_t e = scientific.find('e');
        scientific = scientific.substr(0, e + 1) + std::to_string(std::stoi(scientific.substr(e + 1)));
        const double size = std::abs(number);
        const std::string fixed = written(std::chars_format::fixed);
        return (size >= 0.1 && size < 1e4) || (size >= 1e4 && fixed.size() <= scientific.size()) ? fixed : scientific;
    };
    std::mt19937_64 random(1);
    for (int k = 0; k < 20000; ++k) {
        const double number = (k % 2 == 0 ? 1.0 : -1.0) * std::pow(10.0, std::uniform_real_distribution(-8.0, 24.0)(random));
        EXPECT_EQ(number_text(number), expected(number));
        EXPECT_EQ(number_text(std::round(number)), std::round(number) == 0.0 ? "0" : expected(std::round(number)));
    }
    EXPECT_EQ(number_text(-std::numeric_limits<double>::infinity()), "-inf");
}

}  // namespace
}  // namespace cvtflow::tasks
