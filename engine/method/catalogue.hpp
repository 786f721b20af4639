#pragma once
/// The methods this program knows. A method is one file with one function and one row in catalogue.cpp.

#include <optional>
#include <span>
#include <string_view>

#include "engine/method/stage_plan.hpp"

namespace cvtflow::engine {

/// All methods, each under a name of its own.
[[nodiscard]] std::span<const StagePlan> methods();

/// Methods whose names carry parameters.
struct MethodFamily {
    std::string_view name;         ///< "rkc"
    std::string_view form;         ///< "rkc-s<stages>[-e<damping>]"
    std::string_view limits;       ///< "2 to 400 stages, damping 0 to 100 (usual 0.1538)"
    std::string_view description;  ///< one line for users
    std::optional<StagePlan> (*make)(std::string_view name);
};

/// All of them; methods() holds some examples of each.
[[nodiscard]] std::span<const MethodFamily> method_families();

/// The method of that name, or nullptr. The pointer stays valid for the program's life. Besides methods(): rkc-s2 … rkc-s400.
[[nodiscard]] const StagePlan* find_method(std::string_view name);

/// As find_method(), by value, and any name of a family, e.g. rkc-s37-e10, rock2-s24, fitted-l200-w2.
[[nodiscard]] std::optional<StagePlan> make_method(std::string_view name);

/// The family that a name belongs to by its first part, whether or not its parameters make sense; nullptr if to none.
[[nodiscard]] const MethodFamily* family_of(std::string_view name);

}  // namespace cvtflow::engine
