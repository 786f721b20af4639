#pragma once
/// The methods this program knows. A method is one file with one function and one row in catalogue.cpp.

#include <optional>
#include <span>
#include <string_view>

#include "engine/method/stage_plan.hpp"

namespace cvtflow::engine {

/// All methods, each under a name of its own.
[[nodiscard]] std::span<const StagePlan> methods();

/// The method of that name, or nullptr. The pointer stays valid for the program's life. Besides methods(): rkc-s2 … rkc-s400.
[[nodiscard]] const StagePlan* find_method(std::string_view name);

/// As find_method(), by value, and with free parameters: rkc-s<stages>-e<damping>, e.g. rkc-s37-e10.
[[nodiscard]] std::optional<StagePlan> make_method(std::string_view name);

}  // namespace cvtflow::engine
