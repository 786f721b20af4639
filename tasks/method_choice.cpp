#include "tasks/method_choice.hpp"

#include <stdexcept>

#include "engine/method/catalogue.hpp"
#include "tasks/stage_method.hpp"

namespace cvtflow::tasks {

const std::vector<MethodProgram>& method_programs() {
    static const std::vector<MethodProgram> all;
    return all;
}

const MethodProgram* find_program(std::string_view name) {
    for (const MethodProgram& program : method_programs()) {
        if (program.name == name) return &program;
    }
    return nullptr;
}

std::optional<engine::StagePlan> plan_for(std::string_view method) {
    const MethodProgram* program = find_program(method);
    if (program == nullptr) return engine::make_method(method);
    engine::StagePlan plan = *engine::find_method("euler");
    plan.name = program->name;
    plan.description = program->description;
    plan.source = program->source;
    plan.state_slots = program->state_slots;
    plan.slope_slots = program->slope_slots;
    return plan;
}

std::vector<std::string> method_names() {
    std::vector<std::string> names;
    for (const engine::StagePlan& plan : engine::methods()) names.push_back(plan.name);
    for (const MethodProgram& program : method_programs()) names.push_back(program.name);
    return names;
}

int evaluations_per_step(std::string_view method) {
    if (const MethodProgram* program = find_program(method)) return program->evaluations;
    const auto plan = engine::make_method(method);
    return plan ? static_cast<int>(plan->stages.size()) : 0;
}

std::unique_ptr<StepMethod> make_step_method(std::string_view method, Workspace& workspace) {
    if (const MethodProgram* program = find_program(method)) return program->make(workspace);
    if (!engine::make_method(method)) throw std::invalid_argument("there is no method '" + std::string(method) + "'");
    return std::make_unique<StageMethod>(workspace);
}

}  // namespace cvtflow::tasks
