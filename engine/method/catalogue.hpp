#pragma once
/// The tables of stages this program knows. The product's are those that scenes need; a program that compares methods adds others, as the
/// laboratory does (bench/method).

#include <optional>
#include <span>
#include <string_view>

#include "engine/method/stage_plan.hpp"

namespace cvtflow::engine {

/// All tables that have been made; names are unique.
[[nodiscard]] std::span<const StagePlan> methods();

/// The table of that name, or nullptr. The pointer stays valid for the program's life.
[[nodiscard]] const StagePlan* find_method(std::string_view name);

/// Methods whose names carry parameters.
struct MethodFamily {
    std::string_view name;         ///< "rkc"
    std::string_view form;         ///< "rkc-s<stages>[-e<damping>]"
    std::string_view limits;       ///< "2 to 400 stages, damping 0 to 100 (usual 0.1538)"
    std::string_view description;  ///< one line for users
    std::optional<StagePlan> (*make)(std::string_view name);
};

/// All families; methods() holds some examples of each. The product has none.
[[nodiscard]] std::span<const MethodFamily> method_families();
/// The family that a name belongs to by its first part, whether or not its parameters make sense; nullptr if to none.
[[nodiscard]] const MethodFamily* family_of(std::string_view name);

/// Copy of find_method(), or a member of a family, e.g. rkc-s37-e10.
[[nodiscard]] std::optional<StagePlan> make_method(std::string_view name);

/// Methods that a program adds to those of the product. Both functions are called at the first call of methods(), because families compute
/// their examples.
struct FurtherTables {
    std::vector<StagePlan> (*tables)();    ///< tables of numbers, cheap to make
    std::vector<StagePlan> (*examples)();  ///< examples of the families
    std::span<const MethodFamily> families;
};
/// Adds them, once per process, before anything else asks the catalogue.
void add_tables(const FurtherTables& further);

}  // namespace cvtflow::engine
