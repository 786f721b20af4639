#include "engine/method/catalogue.hpp"

#include <algorithm>

#include "engine/method/dumka3_coefficients.hpp"
#include "engine/method/rkc.hpp"

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

std::span<const StagePlan> methods() {
    static const std::vector<StagePlan> all = [] {
        std::vector<StagePlan> list{rk4(), rk38(), heun(), euler(), dopri54(), dopri65(), dopri87()};
        for (const int order : {2, 3, 4}) list.push_back(extrapolated_euler(order));
        for (const int order : {4, 6, 8}) list.push_back(gragg_bulirsch_stoer(order));
        for (const int stages : {10, 20, 30, 50}) list.push_back(rkc(stages));
        for (int polynomial = 0; polynomial < dumka3_polynomials; ++polynomial) list.push_back(dumka3(polynomial));
        return list;
    }();
    return all;
}

const StagePlan* find_method(std::string_view name) {
    const std::span<const StagePlan> all = methods();
    const auto found = std::find_if(all.begin(), all.end(), [&](const StagePlan& plan) { return plan.name == name; });
    return found == all.end() ? kept_rkc(name) : &*found;
}

std::optional<StagePlan> make_method(std::string_view name) {
    if (const StagePlan* known = find_method(name)) return *known;
    return rkc_by_name(name);
}

}  // namespace cvtflow::engine
