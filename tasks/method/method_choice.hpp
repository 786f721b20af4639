#pragma once
/// The list of all methods: tables of stages (engine/method), and programs with cycles of their own. method.hpp looks one up.

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

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

/// The longest automatic step with pin halves [s]. What friction leaves of a step is of first order (2 us: slip off by 1 to 3 % on one
/// machine in twenty of `cvtflow-lab lottery`).
inline constexpr double usual_longest_step = 1.5e-6;

/// A method that is a program: its row in `list methods`, its slots, and its factory.
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
    double longest_step = usual_longest_step;  ///< that is chosen where steps are automatic, with pin halves [s]
    bool estimates_error = false;              ///< of a step: StepMethod::error_power() is not 0
    int revision = 1;  ///< raised whenever a step computes otherwise, so that no checkpoint of the former method is continued
    /// What it needs that parameters do not have, as a setting; empty: it takes them.
    std::string_view (*missing)(const model::Parameters& parameters) = [](const model::Parameters&) { return std::string_view(); };

    /// Why it cannot be used with these parameters: "method 'sw2' requires detail.pins = "halves""; empty: it can.
    [[nodiscard]] std::string objection(const model::Parameters& parameters) const;
};

/// Of methods that do not take rigid pins, whose accelerations depend on three neighbours each side: exact Jacobians and friction solved
/// for in slips are made for halves, whose depend on one. Nor do they know that an eccentric flank moves as its shaft turns.
[[nodiscard]] std::string_view missing_halves(const model::Parameters& parameters) noexcept;

/// All programs, each under a name of its own.
[[nodiscard]] const std::vector<MethodProgram>& method_programs();
/// nullptr if the name is unknown.
[[nodiscard]] const MethodProgram* find_program(std::string_view name);

/// Whether there is a method or a family of that name. Whether a family has the member is known when it is made, which may take a tenth of
/// a second.
[[nodiscard]] bool may_be_method(std::string_view name);
/// MethodProgram::objection() of the method of that name; empty for tables of stages and unknown names. Makes no member of a family.
[[nodiscard]] std::string objection_to(std::string_view name, const model::Parameters& parameters);
/// Names of all methods of both kinds, tables first.
[[nodiscard]] std::vector<std::string> method_names();
/// Why `method` is no method: what its family allows, or the name that was probably meant.
[[nodiscard]] std::string no_method(std::string_view method);

}  // namespace cvtflow::tasks
