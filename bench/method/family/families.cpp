#include "bench/method/family/families.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

#include "bench/method/analysis/order.hpp"
#include "bench/method/family/fitted.hpp"
#include "bench/method/family/near_optimal.hpp"

namespace cvtflow::bench {

std::optional<std::map<char, double>> name_values(std::string_view name, std::string_view family, std::string_view letters) {
    if (!name.starts_with(family)) return {};
    std::map<char, double> values;
    for (std::string_view rest = name.substr(family.size()); !rest.empty();) {
        if (rest.size() < 3 || rest[0] != '-' || letters.find(rest[1]) == std::string_view::npos) return {};
        const char key = rest[1];
        double value = 0.0;
        const auto [after, fault] = std::from_chars(rest.data() + 2, rest.data() + rest.size(), value, std::chars_format::fixed);
        if (fault != std::errc() || !std::isfinite(value) || !values.emplace(key, value).second) return {};
        rest.remove_prefix(static_cast<std::size_t>(after - rest.data()));
    }
    if (values.empty()) return {};
    return values;
}

StagePlan dopri65();
StagePlan dopri87();
StagePlan extrapolated_euler(int order);
StagePlan gragg_bulirsch_stoer(int order);
StagePlan rk38();
StagePlan serk2(int stages);

namespace {

[[nodiscard]] StagePlan with_order(StagePlan plan) {
    plan.order = order_of(plan);
    plan.embedded_order = embedded_order_of(plan);
    return plan;
}

template <std::optional<StagePlan> (*make)(std::string_view name)>
[[nodiscard]] std::optional<StagePlan> ordered(std::string_view name) {
    std::optional<StagePlan> plan = make(name);
    return plan ? with_order(std::move(*plan)) : plan;
}

/// The stages in <family>-s<stages>, within limits and a multiple of `divisor`; 0 otherwise.
int stages_in(std::string_view name, std::string_view family, int fewest, int most, int divisor) {
    const auto values = name_values(name, family, "s");
    if (!values) return 0;
    const double stages = values->at('s');
    return stages >= fewest && stages <= most && std::fmod(stages, divisor) == 0.0 ? static_cast<int>(stages) : 0;
}

std::optional<StagePlan> serk2_by_name(std::string_view name) {
    const int stages = stages_in(name, "serk2", 10, 250, 10);
    if (stages == 0) return {};
    return serk2(stages);
}

constexpr std::array rows{
    MethodFamily{.name = "rkc",
                 .form = "rkc-s<stages>[-e<damping>]",
                 .limits = "2 to 400 stages, damping 0 to 100 (2/13 if absent)",
                 .description = "Runge-Kutta-Chebyshev of order 2",
                 .make = ordered<rkc_by_name>},
    MethodFamily{.name = "serk2",
                 .form = "serk2-s<stages>",
                 .limits = "10, 20, ... 250 stages",
                 .description = "SERK2 of order 2, near-optimal real interval",
                 .make = ordered<serk2_by_name>},
    MethodFamily{
        .name = "fitted",
        .form = "fitted-l<real>-w<imaginary>[-s<stages>][-p<order>][-r<ripple>]",
        .limits =
            "real 5 to 8000, imaginary up to 50, 4 to 150 stages (the fewest if absent), order 2 or 3, ripple up to 1 (0.2 if absent)",
        .description = "fitted to h times a spectrum, on a Chebyshev recurrence",
        .make = ordered<fitted_by_name>},
};

}  // namespace

std::span<const MethodFamily> families() noexcept { return rows; }

std::vector<StagePlan> further_tables() {
    std::vector<StagePlan> list{rk38(), dopri65(), dopri87()};
    for (const int order : {2, 3, 4}) list.push_back(extrapolated_euler(order));
    for (const int order : {4, 6, 8}) list.push_back(gragg_bulirsch_stoer(order));
    for (StagePlan& plan : list) plan = with_order(std::move(plan));
    return list;
}

std::vector<StagePlan> family_examples() {
    std::vector<StagePlan> list;
    for (const int stages : {10, 20, 30, 50}) list.push_back(rkc(stages));
    for (const int stages : {10, 20, 40}) list.push_back(serk2(stages));
    for (const char* name : {"fitted-l100-w1", "fitted-l200-w2", "fitted-l300-w3", "fitted-l400-w4"}) list.push_back(*fitted_by_name(name));
    for (StagePlan& plan : list) plan = with_order(std::move(plan));
    return list;
}

}  // namespace cvtflow::bench
