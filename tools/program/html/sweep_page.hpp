#pragma once
/// The page of a sweep.

#include <string>

#include "tools/program/view/sweep_view.hpp"

namespace cvtflow::tools {

/// One document: how its cases ended, a picture of any columns over any others, all cases as a table that can be sorted.
/// @throws std::runtime_error see text_of(Page)
[[nodiscard]] std::string sweep_page(const SweepView& sweep);

}  // namespace cvtflow::tools
