#pragma once
/// The list of all methods: tables of stages (engine/method), and programs with cycles of their own. method.hpp finds one.

#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "engine/method/catalogue.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

/// The method cannot be used with these parameters, or does not exist.
class MethodRefused final : public std::invalid_argument {
public:
    using std::invalid_argument::invalid_argument;
};

/// The longest automatic step with pin halves [s]. The error of friction is of first order in the step (2 us: slip off by 1 to 3 % on one
/// machine in twenty of `cvtflow-lab lottery`).
inline constexpr double usual_longest_step = 1.5e-6;

/// How far a method is stable and accurate, by its own test equation. Infinite where linear stability sets no limit, or where the method
/// sees to it by itself (methods that choose among polynomials).
struct MethodReach {
    static constexpr double unlimited = std::numeric_limits<double>::infinity();

    double oscillation = unlimited;  ///< largest h ω of an elastic oscillation, whatever the friction beside it [1]
    double decay = unlimited;        ///< largest h |λ| of friction and damping [1]
    double accurate = unlimited;     ///< largest h ω that it does not damp much more than the chain does itself [1]
    /// Methods that split friction, without friction: limit of h ω for an undamped oscillation, and of h δ for pure damping. [1]
    double frictionless = unlimited, damping = unlimited;

    /// Whether friction is taken apart from all other forces, so that oscillation and damping have limits of their own.
    [[nodiscard]] bool splits_friction() const noexcept { return frictionless < unlimited; }
    bool operator==(const MethodReach&) const = default;
};

/// A method that is a program: its row in `list methods`, its slots, and its factory.
struct MethodProgram {
    std::string name, description, source;
    int order = 0;        ///< on smooth scenes
    int evaluations = 0;  ///< of the right-hand side per step; 0: varies
    int state_slots = 1;  ///< slot 0 included
    int slope_slots = 1;  ///< slot 0 included
    /// @throws std::invalid_argument if the method cannot be used with the workspace's scene
    std::function<std::unique_ptr<StepMethod>(Workspace& workspace)> make = {};
    std::string solves = "none";               ///< systems solved in a step, in words
    MethodReach reach = {};                    ///< as bench/method/stability derives it, and a test compares
    double longest_step = usual_longest_step;  ///< that is chosen where steps are automatic, with pin halves [s]
    bool estimates_error = false;              ///< of a step: StepMethod::error_power() is not 0
    int revision = 1;  ///< raised whenever a step computes otherwise, so that no checkpoint of the former method is continued
    /// Setting that it requires and parameters do not have; empty: none.
    std::string_view (*missing)(const model::Parameters& parameters) = [](const model::Parameters&) { return std::string_view(); };

    /// Why it cannot be used with these parameters: "method 'sw2' requires detail.pins = "halves""; empty: it can.
    [[nodiscard]] std::string objection(const model::Parameters& parameters) const;
};

/// Methods that a program adds to those of the product (bench/method).
struct FurtherMethods {
    engine::FurtherTables tables;
    std::vector<MethodProgram> (*programs)();                        ///< asked when first needed
    engine::StageReach (*reach_of_table)(const engine::StagePlan&);  ///< of tables that declare none
};
/// Adds them, once per process, before anything else asks for methods.
void add_methods(const FurtherMethods& further);

/// All programs, each under a name of its own.
[[nodiscard]] const std::vector<MethodProgram>& method_programs();
/// The reach that a table declares, or else derived. @throws std::logic_error without a function that derives it
[[nodiscard]] engine::StageReach reach_of_table(const engine::StagePlan& plan);
/// nullptr if the name is unknown.
[[nodiscard]] const MethodProgram* find_program(std::string_view name);

/// Whether there is a method or a family of that name. Whether a family has the member is known when it is made.
[[nodiscard]] bool may_be_method(std::string_view name);
/// MethodProgram::objection() of the method of that name; empty for tables of stages and unknown names. Makes no member of a family.
[[nodiscard]] std::string objection_to(std::string_view name, const model::Parameters& parameters);
/// Names of all methods of both kinds, tables first.
[[nodiscard]] std::vector<std::string> method_names();
/// Whether a name is like those of methods that only the laboratory's program has.
[[nodiscard]] bool belongs_to_laboratory(std::string_view method) noexcept;
/// Why `method` is no method: what its family allows, or the name that was probably meant.
[[nodiscard]] std::string no_method(std::string_view method);

}  // namespace cvtflow::tasks
