#include "tasks/method/method.hpp"

#include <algorithm>
#include <utility>

#include "engine/method/catalogue.hpp"
#include "engine/method/compiled_plan.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

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

}  // namespace cvtflow::tasks
