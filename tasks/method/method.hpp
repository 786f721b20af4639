#pragma once
/// The list of all methods: tables of stages (engine/method) and programs with further cycles; a method, found once; and the choice for
/// run.method = "auto", by detail and friction law.

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "engine/method/catalogue.hpp"
#include "model/machine/held_links.hpp"
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

/// Limits of a method's stability and accuracy, by its test equation. Infinite where linear stability sets no limit, or where the method
/// chooses among polynomials to meet it.
struct MethodReach {
    static constexpr double unlimited = std::numeric_limits<double>::infinity();

    double oscillation = unlimited;  ///< largest h ω of an elastic oscillation, whatever the friction beside it [1]
    double decay = unlimited;        ///< largest h |λ| of friction and damping [1]
    double accurate = unlimited;     ///< largest h ω that it does not damp much more than the chain does itself [1]
    double damping = unlimited;      ///< of methods that solve for friction: largest h δ of damping without friction [1]
    double filter = 0.0;             ///< β > 0: waves of rigid pins are filtered, and stable up to h ω = 1/√β [1]

    bool operator==(const MethodReach&) const = default;
};

/// A method that is a program: its row in `list methods`, its slots, and its factory.
struct MethodProgram {
    std::string name, description, source;
    int order = 0;        ///< order on smooth scenes
    int evaluations = 0;  ///< evaluations of the right-hand side per step; 0: varies
    int state_slots = 1;  ///< slot 0 included
    int slope_slots = 1;  ///< slot 0 included
    /// @throws std::invalid_argument if the method cannot be used with the workspace's scene
    std::function<std::unique_ptr<StepMethod>(Workspace& workspace)> make = {};
    std::string solves = "none";               ///< systems solved in a step
    MethodReach reach = {};                    ///< on its own test equation (decision 64)
    double longest_step = usual_longest_step;  ///< longest automatic step with pin halves [s]
    bool holds_links = false;                  ///< links are held (model::HeldLinks), so that steps can be longer
    bool estimates_error = false;              ///< StepMethod::error_estimate() has a power
    int revision = 1;  ///< raised whenever a step computes otherwise, so that no checkpoint of the former method is continued
    /// Setting that it requires and parameters do not have; empty: none.
    std::string_view (*missing)(const model::Parameters& parameters) = [](const model::Parameters&) { return std::string_view(); };

    /// Reason why it cannot be used with these parameters: "method 'sw2' requires detail.pins = "halves""; empty: it can.
    [[nodiscard]] std::string objection(const model::Parameters& parameters) const;
};

/// Methods that a program adds to those of the product (bench/method).
struct FurtherMethods {
    engine::FurtherTables tables;
    std::vector<MethodProgram> (*programs)();                        ///< called when first needed
    engine::StageReach (*reach_of_table)(const engine::StagePlan&);  ///< reach of a table that declares none
};
/// Adds them, once per process, before anything else asks for methods.
void add_methods(const FurtherMethods& further);

/// All programs; names are unique.
[[nodiscard]] const std::vector<MethodProgram>& method_programs();
/// Programs that take friction apart from all other forces (tasks/method/friction).
[[nodiscard]] std::vector<MethodProgram> friction_methods();
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
/// Reason why `method` is no method: limits of its family, or the name that was probably meant.
[[nodiscard]] std::string no_method(std::string_view method);

/// A table of stages, or a program with further cycles. A name converts to its method.
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
    /// Makes the step method on a workspace made with plan(). @throws MethodRefused with MethodProgram::objection(), or as
    /// MethodProgram::make
    [[nodiscard]] std::unique_ptr<StepMethod> make(Workspace& workspace) const;

private:
    Method(const MethodProgram* program, engine::StagePlan plan);

    const MethodProgram* program_;
    engine::StagePlan plan_;
};

/// Held links of a method's steps with a chain; nullptr: none are held.
[[nodiscard]] std::shared_ptr<const model::HeldLinks> held_links(const Method& method, const model::ChainModel& chain);

/// Reach of any method of the catalogue; of a table that declares none it is derived. @throws std::logic_error without a function that does
[[nodiscard]] MethodReach reach_of(const Method& method);

/// The value of run.method that leaves the choice to the table below.
inline constexpr std::string_view automatic_method = "auto";

/// A row: a method of the catalogue, and the machines that it is taken for.
struct AutomaticChoice {
    std::string_view method;
    std::string_view machines;
    bool (*suits)(const model::Parameters& parameters);
};

/// The first row that suits is taken; the last suits every machine.
[[nodiscard]] std::span<const AutomaticChoice> automatic_choices() noexcept;

/// `method` itself, or the method that automatic_method represents with these parameters.
[[nodiscard]] std::string_view resolved_method(std::string_view method, const model::Parameters& parameters);

}  // namespace cvtflow::tasks
