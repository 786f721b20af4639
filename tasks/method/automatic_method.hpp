#pragma once
/// run.method = "auto": the method that suits the machine, by detail and friction law.

#include <span>
#include <string_view>

#include "model/parameters/parameters.hpp"

namespace cvtflow::tasks {

/// The value of run.method that leaves the choice to the table below.
inline constexpr std::string_view automatic_method = "auto";

/// A row: a method of the catalogue, and the machines that it is taken for.
struct AutomaticChoice {
    std::string_view method;
    std::string_view machines;  ///< in words
    bool (*suits)(const model::Parameters& parameters);
};

/// The first row that suits is taken; the last suits every machine.
[[nodiscard]] std::span<const AutomaticChoice> automatic_choices() noexcept;

/// `method` itself, or the method that automatic_method represents with these parameters.
[[nodiscard]] std::string_view resolved_method(std::string_view method, const model::Parameters& parameters);

}  // namespace cvtflow::tasks
