#pragma once
/// Methods of both kinds under one list of names: tables of stages (engine/method), and programs with cycles of their own.

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "engine/method/stage_plan.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

class LinearChain;
class StepMap;
struct ProgramStability;

/// The method cannot be used with these parameters, or does not exist.
class MethodRefused final : public std::invalid_argument {
public:
    using std::invalid_argument::invalid_argument;
};

/// A method that is a program: what `list methods` says of it, the slots it needs, and how it is made.
struct MethodProgram {
    std::string name, description, source;
    int order = 0;        ///< on smooth scenes
    int evaluations = 0;  ///< of the right-hand side per step; 0: varies
    int state_slots = 1;  ///< slot 0 included
    int slope_slots = 1;  ///< slot 0 included
    /// @throws std::invalid_argument if the method cannot be used with the workspace's scene
    std::function<std::unique_ptr<StepMethod>(Workspace& workspace)> make = {};
    std::string solves = "none";  ///< systems solved in a step, in words
    /// On the test equation that it is made for (tasks/method/program_stability.hpp); empty: it chooses among tables of stages.
    std::function<ProgramStability()> stability = {};
    /// What its step makes of small disturbances (tasks/method/stability/step_map.hpp).
    std::function<std::unique_ptr<StepMap>(const LinearChain& chain)> linear = {};
    bool estimates_error = false;  ///< of a step: StepMethod::error_power() is not 0
    /// Whether it takes whole pins, whose accelerations depend on three neighbours each side: exact Jacobians and friction solved for in
    /// slips are made for halves, whose depend on one.
    bool whole_pins = true;
};

/// All programs, each under a name of its own.
[[nodiscard]] const std::vector<MethodProgram>& method_programs();
/// nullptr: there is none of that name.
[[nodiscard]] const MethodProgram* find_program(std::string_view name);

/// Table whose slots a workspace for this method needs: the method's own, or one that holds a program's slots. nullopt: no method of that
/// name.
[[nodiscard]] std::optional<engine::StagePlan> plan_for(std::string_view method);
/// The same for a name that has to be one. @throws MethodRefused with no_method()
[[nodiscard]] engine::StagePlan required_plan(std::string_view method);
/// Whether there is a method or a family of that name. Whether a family has the member is known when it is made, which may take a tenth of
/// a second.
[[nodiscard]] bool may_be_method(std::string_view name);
/// Names of all methods of both kinds, tables first.
[[nodiscard]] std::vector<std::string> method_names();
/// Why `method` is no method: what its family allows, or the name that was probably meant.
[[nodiscard]] std::string no_method(std::string_view method);
/// Evaluations of the right-hand side in one step without transitions, the first step excepted; 0: no such method, or it varies.
[[nodiscard]] int evaluations_per_step(std::string_view method);
/// Whether steps of the method come with an estimate of their error, so that it can be reported or decide (run.step_control). A member of a
/// family is made to look. @return true also if there is no such method
[[nodiscard]] bool may_estimate_error(std::string_view method);
/// Whether the method can be used with such pins, and what to say where not. @return true also if there is no such method
[[nodiscard]] bool takes_pins(std::string_view method, model::PinDetail pins);
[[nodiscard]] std::string needs_halves(std::string_view method);
/// The method at work on a workspace made with plan_for(method). @throws std::invalid_argument for unknown names, and as
/// MethodProgram::make
[[nodiscard]] std::unique_ptr<StepMethod> make_step_method(std::string_view method, Workspace& workspace);

}  // namespace cvtflow::tasks
