#include "tasks/method/method_choice.hpp"

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "engine/method/catalogue.hpp"
#include "tasks/method/friction/friction_methods.hpp"
#include "tasks/method/implicit/catalogue.hpp"
#include "tasks/method/spectral_method.hpp"
#include "tasks/method/stability/step_map.hpp"

namespace cvtflow::tasks {

namespace {

/// Those that choose among tables of stages by the spectrum.
[[nodiscard]] std::vector<MethodProgram> spectral_programs() {
    return {
        {.name = "dumka3",
         .description = "DUMKA3, polynomial and step by the spectrum",
         .source = "Medovikov, BIT 38 (1998) 372-390",
         .order = 3,
         .state_slots = 3,
         .slope_slots = 5,
         .make = dumka3_by_spectrum,
         .linear = dumka3_step,
         .estimates_error = true},
        {.name = "rkc",
         .description = "Runge-Kutta-Chebyshev, stages by the spectrum",
         .source = "Sommeijer, Shampine, Verwer, J. Comput. Appl. Math. 88 (1998) 315-326",
         .order = 2,
         .state_slots = 4,
         .slope_slots = 3,
         .make = rkc_by_spectrum,
         .linear = rkc_step,
         .estimates_error = true},
        {.name = "rock2",
         .description = "ROCK2, stages by the spectrum",
         .source = "Abdulle, Medovikov, Numer. Math. 90 (2001) 1-18",
         .order = 2,
         .state_slots = 5,
         .slope_slots = 4,
         .make = rock2_by_spectrum,
         .linear = rock2_step,
         .estimates_error = true},
        {.name = "fitted",
         .description = "polynomial fitted to the spectrum, repeated when it changes",
         .source = "weights by Lawson's iteration",
         .order = 3,
         .state_slots = FittedMethod::max_stages + 1,
         .slope_slots = 3,
         .make = fitted_by_spectrum,
         .linear = fitted_step,
         .estimates_error = true},
    };
}

}  // namespace

const std::vector<MethodProgram>& method_programs() {
    static const std::vector<MethodProgram> all = [] {
        std::vector<MethodProgram> programs = spectral_programs();
        for (const auto& family : {friction_methods(), implicit_programs()}) programs.insert(programs.end(), family.begin(), family.end());
        return programs;
    }();
    return all;
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

std::string no_method(std::string_view method) {
    if (const engine::MethodFamily* family = engine::family_of(method))
        return fmt::format("no method '{}': {} takes {}", method, family->form, family->limits);
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

std::string_view missing_halves(const model::Parameters& parameters) noexcept {
    if (parameters.detail.pins != model::PinDetail::halves) return "detail.pins = \"halves\"";
    return parameters.imperfection.runout == 0.0 ? "" : "imperfection.runout = 0";
}

}  // namespace cvtflow::tasks
