#pragma once
/// Times at which an input may jump or bend.

#include "model/force/pulley.hpp"

namespace cvtflow::tasks {

/// First point after t of the tables of inputs that are in use; infinite: none. Between two points inputs are smooth in time. t [s]
[[nodiscard]] double next_input_point(const model::Parameters& parameters, const model::HeldInputs& held, double t) noexcept;

}  // namespace cvtflow::tasks
