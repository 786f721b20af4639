#pragma once
/// A method of the catalogue, found once.

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "engine/method/stage_plan.hpp"
#include "tasks/method/method_choice.hpp"

namespace cvtflow::tasks {

/// A table of stages, or a program with cycles of its own. A name converts to its method.
class Method {
public:
    /// A member of a family is made, which may take a tenth of a second. @throws MethodRefused with no_method()
    Method(std::string_view name);
    Method(const std::string& name) : Method(std::string_view(name)) {}
    Method(const char* name) : Method(std::string_view(name)) {}
    /// nullopt: no method of that name.
    [[nodiscard]] static std::optional<Method> find(std::string_view name);

    [[nodiscard]] const std::string& name() const noexcept { return plan_.name; }
    /// nullptr: a table of stages.
    [[nodiscard]] const MethodProgram* program() const noexcept { return program_; }
    /// The table of stages; of a program, one that has its slots and one stage: what a workspace needs.
    [[nodiscard]] const engine::StagePlan& plan() const noexcept { return plan_; }

    /// Evaluations of the right-hand side in a step without transitions, except the first step; 0: it varies.
    [[nodiscard]] int evaluations_per_step() const;
    /// Whether the method estimates the local error of a step (run.step_control = "report" or "error").
    [[nodiscard]] bool estimates_error() const noexcept {
        return program_ != nullptr ? program_->estimates_error : plan_.error.has_value();
    }
    /// At work on a workspace made with plan(). @throws MethodRefused with MethodProgram::objection(), or as MethodProgram::make
    [[nodiscard]] std::unique_ptr<StepMethod> make(Workspace& workspace) const;

private:
    Method(const MethodProgram* program, engine::StagePlan plan);

    const MethodProgram* program_;
    engine::StagePlan plan_;
};

}  // namespace cvtflow::tasks
