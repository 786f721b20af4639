#include "tasks/method/method.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "engine/base/text.hpp"
#include "engine/method/compiled_plan.hpp"
#include "engine/method/dumka3.hpp"
#include "tasks/method/friction/sweep_leapfrog.hpp"
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
            .reach = {.decay = engine::dumka3_reach(engine::dumka3_polynomials - 1)},
            .longest_step = 0.5e-6,  // decision 75
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

bool belongs_to_laboratory(std::string_view method) noexcept {
    // How names of its methods begin (bench/method; a test there compares).
    for (const std::string_view beginning :
         {"rk38", "dopri65", "dopri87", "euler-x", "gbs", "rkc", "serk2", "fitted", "trapezoidal-", "sw2", "ros34pw2", "w-x"})
        if (method.starts_with(beginning)) return true;
    return false;
}

std::string no_method(std::string_view method) {
    if (const engine::MethodFamily* family = engine::family_of(method))
        return fmt::format("no method '{}': {} takes {}", method, family->form, family->limits);
    if (belongs_to_laboratory(method) && further_methods().programs == nullptr)
        return fmt::format("{} belongs to the laboratory: cvtflow-lab run SCENE --method {}", method, method);
    if (method == "leapfrog-chebyshev")
        return fmt::format("no method '{}' any more: leave run.method out, or take dumka3 for stick and slip", method);
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

namespace {

/// The estimate y - ŷ falls like the step to the lower order of both, plus one.
int error_power_of(const engine::StagePlan& plan) { return plan.error ? std::min(plan.order, plan.embedded_order) + 1 : 0; }

/// A table with the slots of a program.
engine::StagePlan plan_of(const MethodProgram& program) {
    engine::StagePlan plan = *engine::find_method("euler");
    plan.name = program.name;
    plan.description = program.description;
    plan.source = program.source;
    plan.state_slots = program.state_slots;
    plan.slope_slots = program.slope_slots;
    return plan;
}

Method required(std::string_view name) {
    std::optional<Method> method = Method::find(name);
    if (!method) throw MethodRefused(no_method(name));
    return std::move(*method);
}

}  // namespace

Method::Method(const MethodProgram* program, engine::StagePlan plan) : program_(program), plan_(std::move(plan)) {}
Method::Method(std::string_view name) : Method(required(name)) {}

std::optional<Method> Method::find(std::string_view name) {
    if (const MethodProgram* program = find_program(name)) return Method(program, plan_of(*program));
    std::optional<engine::StagePlan> plan = engine::make_method(name);
    if (!plan) return {};
    return Method(nullptr, std::move(*plan));
}

int Method::evaluations_per_step() const {
    if (program_ != nullptr) return program_->evaluations;
    return static_cast<int>(plan_.stages.size()) - (engine::CompiledPlan(plan_).last_is_result() ? 1 : 0);
}

std::unique_ptr<StepMethod> Method::make(Workspace& workspace) const {
    if (program_ == nullptr) return std::make_unique<StageMethod>(workspace, error_power_of(plan_));
    if (const std::string why = program_->objection(workspace.parameters); !why.empty()) throw MethodRefused(why);
    return program_->make(workspace);
}

std::shared_ptr<const model::HeldLinks> held_links(const Method& method, const model::ChainModel& chain) {
    if (method.program() == nullptr || !method.program()->holds_links || chain.layout().rigid) return nullptr;
    return std::make_shared<const model::HeldLinks>(chain.coefficients(), chain.inertia());
}

MethodReach reach_of(const Method& method) {
    if (const MethodProgram* program = method.program()) return program->reach;
    const engine::StagePlan& plan = method.plan();
    if (!plan.reach && further_methods().reach_of_table == nullptr)
        throw std::logic_error("the reach of " + plan.name + " is not declared");
    const engine::StageReach reach = plan.reach ? *plan.reach : further_methods().reach_of_table(plan);
    return {reach.oscillation, reach.decay, reach.accurate};
}

std::span<const AutomaticChoice> automatic_choices() noexcept {
    static constexpr std::array choices{
        AutomaticChoice{"leapfrog-rigid", "rigid pins",
                        [](const model::Parameters& parameters) { return parameters.detail.pins == model::PinDetail::rigid; }},
        AutomaticChoice{"rk4", "pin halves in chains of fewer than 12 pins", has_few_pins},
        AutomaticChoice{"leapfrog-sweep", "pin halves without phases stick and slip", sweeps_suit},
        AutomaticChoice{"dumka3", "stick and slip, saturation speeds below a hundredth of the usual ones",
                        [](const model::Parameters&) { return true; }},
    };
    return choices;
}

std::string_view resolved_method(std::string_view method, const model::Parameters& parameters) {
    if (method != automatic_method) return method;
    const auto choices = automatic_choices();
    return std::ranges::find_if(choices, [&](const AutomaticChoice& choice) { return choice.suits(parameters); })->method;
}

}  // namespace cvtflow::tasks
