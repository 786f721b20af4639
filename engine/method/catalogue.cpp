#include "engine/method/catalogue.hpp"

#include <algorithm>
#include <vector>

#include "engine/method/dumka3.hpp"

namespace cvtflow::engine {

StagePlan dopri54();
StagePlan euler();
StagePlan heun();
StagePlan rk4();

namespace {

FurtherTables& further() {
    static FurtherTables none{nullptr, nullptr, {}};
    return none;
}

void append(std::vector<StagePlan>& list, std::vector<StagePlan> (*plans)()) {
    if (plans == nullptr) return;
    for (StagePlan& plan : plans()) list.push_back(std::move(plan));
}

/// The methods that are tables of numbers: cheap to make, unlike the families, whose polynomials are computed.
const std::vector<StagePlan>& tables() {
    static const std::vector<StagePlan> all = [] {
        std::vector<StagePlan> list{rk4(), heun(), euler(), dopri54()};
        for (int polynomial = 0; polynomial < dumka3_polynomials; ++polynomial) list.push_back(dumka3(polynomial));
        append(list, further().tables);
        return list;
    }();
    return all;
}

const StagePlan* named(std::span<const StagePlan> plans, std::string_view name) {
    const auto found = std::find_if(plans.begin(), plans.end(), [&](const StagePlan& plan) { return plan.name == name; });
    return found == plans.end() ? nullptr : &*found;
}

}  // namespace

void add_tables(const FurtherTables& more) { further() = more; }

std::span<const MethodFamily> method_families() { return further().families; }

const MethodFamily* family_of(std::string_view name) {
    const std::string_view first = name.substr(0, name.find('-'));
    const auto families = method_families();
    const auto found = std::find_if(families.begin(), families.end(), [&](const MethodFamily& family) { return family.name == first; });
    return found == families.end() ? nullptr : &*found;
}

std::span<const StagePlan> methods() {
    if (further().examples == nullptr) return tables();
    static const std::vector<StagePlan> all = [] {
        std::vector<StagePlan> list = tables();
        append(list, further().examples);
        return list;
    }();
    return all;
}

const StagePlan* find_method(std::string_view name) { return family_of(name) == nullptr ? named(tables(), name) : named(methods(), name); }

std::optional<StagePlan> make_method(std::string_view name) {
    if (const MethodFamily* family = family_of(name)) return family->make(name);
    if (const StagePlan* known = find_method(name)) return *known;
    return {};
}

}  // namespace cvtflow::engine
