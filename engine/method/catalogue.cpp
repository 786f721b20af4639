#include "engine/method/catalogue.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/method/family/fitted.hpp"
#include "engine/method/family/near_optimal.hpp"
#include "engine/method/family/rkc.hpp"
#include "engine/method/family/rock4.hpp"
#include "engine/method/method_name.hpp"
#include "engine/method/table/dumka3_coefficients.hpp"

namespace cvtflow::engine {

StagePlan dopri54();
StagePlan dopri65();
StagePlan dopri87();
StagePlan dumka3(int polynomial);
StagePlan euler();
StagePlan extrapolated_euler(int order);
StagePlan gragg_bulirsch_stoer(int order);
StagePlan heun();
StagePlan rk38();
StagePlan rk4();
StagePlan rock2(int stages);
StagePlan serk2(int stages);

namespace {

/// The stages in <family>-s<stages>, within limits and a multiple of `divisor`; 0 otherwise.
int stages_in(std::string_view name, std::string_view family, int fewest, int most, int divisor) {
    const auto values = name_values(name, family, "s");
    if (!values) return 0;
    const double stages = values->at('s');
    return stages >= fewest && stages <= most && std::fmod(stages, divisor) == 0.0 ? static_cast<int>(stages) : 0;
}

std::optional<StagePlan> rock2_by_name(std::string_view name) {
    const int stages = stages_in(name, "rock2", min_near_optimal, max_near_optimal, 1);
    if (stages == 0) return {};
    return rock2(stages);
}

std::optional<StagePlan> rock4_by_name(std::string_view name) {
    const int stages = stages_in(name, "rock4", min_rock4_stages, max_rock4_stages, 1);
    if (stages == 0) return {};
    return rock4(stages);
}

std::optional<StagePlan> serk2_by_name(std::string_view name) {
    const int stages = stages_in(name, "serk2", 10, 250, 10);
    if (stages == 0) return {};
    return serk2(stages);
}

constexpr std::array families{
    MethodFamily{.name = "rkc",
                 .form = "rkc-s<stages>[-e<damping>]",
                 .limits = "2 to 400 stages, damping 0 to 100 (2/13 if absent)",
                 .description = "Runge-Kutta-Chebyshev of order 2",
                 .make = rkc_by_name},
    MethodFamily{.name = "rock2",
                 .form = "rock2-s<stages>",
                 .limits = "5 to 400 stages",
                 .description = "ROCK2 of order 2, near-optimal real interval",
                 .make = rock2_by_name},
    MethodFamily{.name = "rock4",
                 .form = "rock4-s<stages>",
                 .limits = "5 to 100 stages",
                 .description = "ROCK4 of order 4, near-optimal real interval",
                 .make = rock4_by_name},
    MethodFamily{.name = "serk2",
                 .form = "serk2-s<stages>",
                 .limits = "10, 20, ... 250 stages",
                 .description = "SERK2 of order 2, near-optimal real interval",
                 .make = serk2_by_name},
    MethodFamily{
        .name = "fitted",
        .form = "fitted-l<real>-w<imaginary>[-s<stages>][-p<order>][-r<ripple>]",
        .limits =
            "real 5 to 8000, imaginary up to 50, 4 to 150 stages (the fewest if absent), order 2 or 3, ripple up to 1 (0.2 if absent)",
        .description = "fitted to h times a spectrum, on a Chebyshev recurrence",
        .make = fitted_by_name},
};

}  // namespace

std::span<const MethodFamily> method_families() { return families; }

const MethodFamily* family_of(std::string_view name) {
    const std::string_view first = name.substr(0, name.find('-'));
    const auto found = std::find_if(families.begin(), families.end(), [&](const MethodFamily& family) { return family.name == first; });
    return found == families.end() ? nullptr : &*found;
}

namespace {

/// The methods that are tables of numbers: cheap to make, unlike the families, whose polynomials are computed.
const std::vector<StagePlan>& tables() {
    static const std::vector<StagePlan> all = [] {
        std::vector<StagePlan> list{rk4(), rk38(), heun(), euler(), dopri54(), dopri65(), dopri87()};
        for (const int order : {2, 3, 4}) list.push_back(extrapolated_euler(order));
        for (const int order : {4, 6, 8}) list.push_back(gragg_bulirsch_stoer(order));
        for (int polynomial = 0; polynomial < dumka3_polynomials; ++polynomial) list.push_back(dumka3(polynomial));
        return list;
    }();
    return all;
}

const StagePlan* named(std::span<const StagePlan> plans, std::string_view name) {
    const auto found = std::find_if(plans.begin(), plans.end(), [&](const StagePlan& plan) { return plan.name == name; });
    return found == plans.end() ? nullptr : &*found;
}

}  // namespace

std::span<const StagePlan> methods() {
    static const std::vector<StagePlan> all = [] {
        std::vector<StagePlan> list = tables();
        for (const int stages : {10, 20, 30, 50}) list.push_back(rkc(stages));
        for (const int stages : {10, 20, 40}) list.push_back(rock2(stages));
        for (const int stages : {10, 20, 40}) list.push_back(rock4(stages));
        for (const int stages : {10, 20, 40}) list.push_back(serk2(stages));
        for (const char* name : {"fitted-l100-w1", "fitted-l200-w2", "fitted-l300-w3", "fitted-l400-w4"})
            list.push_back(*fitted_by_name(name));
        return list;
    }();
    return all;
}

const StagePlan* find_method(std::string_view name) {
    if (family_of(name) == nullptr) return named(tables(), name);
    const StagePlan* example = named(methods(), name);
    return example != nullptr ? example : kept_rkc(name);
}

std::optional<StagePlan> make_method(std::string_view name) {
    if (const StagePlan* known = find_method(name)) return *known;
    const MethodFamily* family = family_of(name);
    if (family == nullptr) return {};
    return family->make(name);
}

}  // namespace cvtflow::engine
