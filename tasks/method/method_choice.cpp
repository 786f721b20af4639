#include "tasks/method/method_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include "engine/base/text.hpp"
#include "tasks/method/friction/friction_methods.hpp"
#include "tasks/method/spectral_method.hpp"

namespace cvtflow::tasks {

namespace {

FurtherMethods& further_methods() {
    static FurtherMethods none{{nullptr, nullptr, {}}, nullptr, nullptr};
    return none;
}

/// Chooses among the polynomials of DUMKA3 by the spectrum.
[[nodiscard]] MethodProgram dumka3_program() {
    return {.name = "dumka3",
            .description = "DUMKA3, polynomial and step by the spectrum",
            .source = "Medovikov, BIT 38 (1998) 372-390",
            .order = 3,
            .state_slots = 3,
            .slope_slots = 5,
            .make = dumka3_by_spectrum,
            .estimates_error = true};
}

}  // namespace

void add_methods(const FurtherMethods& more) {
    further_methods() = more;
    engine::add_tables(more.tables);
}

const std::vector<MethodProgram>& method_programs() {
    static const std::vector<MethodProgram> all = [] {
        std::vector<MethodProgram> programs{dumka3_program()};
        const auto append = [&](const std::vector<MethodProgram>& more) { programs.insert(programs.end(), more.begin(), more.end()); };
        append(friction_methods());
        if (further_methods().programs != nullptr) append(further_methods().programs());
        return programs;
    }();
    return all;
}

engine::StageReach reach_of_table(const engine::StagePlan& plan) {
    if (plan.reach) return *plan.reach;
    if (further_methods().reach_of_table == nullptr) throw std::logic_error("the reach of " + plan.name + " is not declared");
    return further_methods().reach_of_table(plan);
}

const MethodProgram* find_program(std::string_view name) {
    for (const MethodProgram& program : method_programs()) {
        if (program.name == name) return &program;
    }
    return nullptr;
}

bool may_be_method(std::string_view name) {
    return find_program(name) != nullptr || engine::family_of(name) != nullptr || engine::find_method(name) != nullptr;
}

std::vector<std::string> method_names() {
    std::vector<std::string> names;
    for (const engine::StagePlan& plan : engine::methods()) names.push_back(plan.name);
    for (const MethodProgram& program : method_programs()) names.push_back(program.name);
    return names;
}

namespace {

/// How names of the laboratory's methods begin (bench/method; a test there compares).
constexpr std::string_view laboratory_names[] = {"rk38",
                                                 "dopri65",
                                                 "dopri87",
                                                 "euler-x",
                                                 "gbs",
                                                 "rkc",
                                                 "rock2",
                                                 "rock4",
                                                 "serk2",
                                                 "fitted",
                                                 "leapfrog-rkc",
                                                 "leapfrog-chebyshev-double",
                                                 "leapfrog-sweep-double",
                                                 "trapezoidal-",
                                                 "sw2",
                                                 "ros34pw2",
                                                 "w-x"};

}  // namespace

bool belongs_to_laboratory(std::string_view method) noexcept {
    return std::ranges::any_of(laboratory_names, [&](std::string_view beginning) { return method.starts_with(beginning); });
}

std::string no_method(std::string_view method) {
    if (const engine::MethodFamily* family = engine::family_of(method))
        return fmt::format("no method '{}': {} takes {}", method, family->form, family->limits);
    if (belongs_to_laboratory(method) && further_methods().programs == nullptr)
        return fmt::format("{} belongs to the laboratory: cvtflow-lab run SCENE --method {}", method, method);
    const std::string near = engine::closest(method, method_names());
    return fmt::format("no method '{}' ({})", method, near.empty() ? "cvtflow list methods" : fmt::format("did you mean '{}'?", near));
}

std::string MethodProgram::objection(const model::Parameters& parameters) const {
    const std::string_view setting = missing(parameters);
    return setting.empty() ? "" : fmt::format("method '{}' requires {}", name, setting);
}

std::string objection_to(std::string_view name, const model::Parameters& parameters) {
    const MethodProgram* program = find_program(name);
    return program == nullptr ? "" : program->objection(parameters);
}

}  // namespace cvtflow::tasks
