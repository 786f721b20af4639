#pragma once
/// All methods of the laboratory, beside those of the product: named in scenes of cvtflow-lab and of the tests like any other.

#include "bench/method/product_names.hpp"
#include "tasks/method/method.hpp"

namespace cvtflow::bench {

/// Adds them to the product's catalogue, once per process, before anything else asks it.
void add_laboratory_methods();

/// The reach that follows from a table, which the catalogue declares.
[[nodiscard]] engine::StageReach derived_reach(const engine::StagePlan& plan);

}  // namespace cvtflow::bench
