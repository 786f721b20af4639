#include "tasks/batch/sweep/axis.hpp"

#include <fmt/format.h>

#include <cmath>
#include <random>
#include <type_traits>

#include "model/basis/portable_math.hpp"
#include "tasks/scene/units.hpp"
#include "tasks/scene/value_reader.hpp"

namespace cvtflow::tasks {

namespace {

template <class T>
constexpr bool is_number = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// The number that a member holds, if it is a single one.
template <class T>
[[nodiscard]] bool single(const T& member, double& number) {
    if constexpr (is_number<T>) {
        number = static_cast<double>(member);
        return true;
    } else if constexpr (std::is_same_v<T, std::vector<double>>) {
        if (member.size() != 1) return false;
        number = member.front();
        return true;
    } else if constexpr (std::is_same_v<T, model::TimeTable>) {
        if (member.time.size() != 1) return false;
        number = member.value.front();
        return true;
    }
    return false;
}

template <class T>
void set_number(T& member, double number) {
    if constexpr (std::is_same_v<T, bool>) {
        member = number != 0.0;
    } else if constexpr (std::is_integral_v<T>) {
        member = static_cast<T>(std::llround(number));
    } else if constexpr (is_number<T>) {
        member = static_cast<T>(number);
    } else if constexpr (std::is_same_v<T, std::vector<double>>) {
        member.assign(1, number);
    } else if constexpr (std::is_same_v<T, model::TimeTable>) {
        member.time.assign(1, 0.0);
        member.value.assign(1, number);
    }
}

/// Uniform in [0, 1): 53 bits of the generator, whose sequence the standard fixes (that of its distributions it does not).
[[nodiscard]] double uniform(std::mt19937_64& generator) { return static_cast<double>(generator() >> 11U) * 0x1p-53; }

}  // namespace

std::vector<AxisValue> axis_value(const Parameter& parameter, const Node& node, std::vector<Problem>& problems) {
    Scene scratch;
    const std::size_t before = problems.size();
    read_value(parameter, node, scratch, problems);
    if (problems.size() != before) return {};
    double number = 0.0;
    const bool one = std::visit([&](const auto* member) { return single(*member, number); }, parameter.member(scratch));
    if (one) return {number};
    return {value_text(parameter, scratch)};
}

void apply(const Parameter& parameter, const AxisValue& value, Scene& scene) {
    if (const auto* number = std::get_if<double>(&value)) {
        std::visit([&](auto* member) { set_number(*member, *number); }, parameter.member(scene));
        return;
    }
    const auto parsed = parse_toml("value = " + std::get<std::string>(value));
    std::vector<Problem> none;  // it was read before
    read_value(parameter, std::get<Node::Table>(std::get<Node>(parsed).value).front().node, scene, none);
}

std::string axis_text(const Parameter& parameter, const AxisValue& value) {
    Scene scratch;
    apply(parameter, value, scratch);
    return value_text(parameter, scratch);
}

bool continuous(const Parameter& parameter) {
    const Kind kind = parameter.kind();
    return kind == Kind::number || kind == Kind::auto_number || kind == Kind::integer || kind == Kind::number_list ||
           kind == Kind::time_table;
}

std::vector<double> spaced(double from, double to, std::size_t count, bool logarithmic) {
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) {
        const double share = count == 1 ? 0.0 : static_cast<double>(i) / static_cast<double>(count - 1);
        const double between = logarithmic ? from * model::portable_pow(to / from, share) : from + share * (to - from);
        values.push_back(i == 0 ? from : i + 1 == count ? to : between);  // ends exactly
    }
    return values;
}

std::vector<double> random_samples(std::size_t count, std::size_t dimensions, std::uint64_t seed) {
    std::mt19937_64 generator(seed);
    std::vector<double> samples(count * dimensions);
    for (double& sample : samples) sample = uniform(generator);
    return samples;
}

std::vector<double> latin_hypercube(std::size_t count, std::size_t dimensions, std::uint64_t seed) {
    std::mt19937_64 generator(seed);
    std::vector<double> samples(count * dimensions);
    std::vector<std::size_t> order(count);
    for (std::size_t d = 0; d < dimensions; ++d) {
        for (std::size_t i = 0; i < count; ++i) order[i] = i;
        for (std::size_t i = count; i > 1; --i)
            std::swap(order[i - 1], order[static_cast<std::size_t>(uniform(generator) * static_cast<double>(i))]);
        for (std::size_t i = 0; i < count; ++i) {
            samples[i * dimensions + d] = (static_cast<double>(order[i]) + uniform(generator)) / static_cast<double>(count);
        }
    }
    return samples;
}

}  // namespace cvtflow::tasks
