#pragma once
/// The parts of a chain's evaluation one by one, compiled once per instruction set like the kernels that they are taken from.

#include <array>
#include <cstddef>
#include <string_view>

#include "model/chain/chain_model.hpp"

namespace cvtflow::bench {

/// read: states into lanes, directions of links; solve: inverse inertia and writing slopes. The others write their forces.
inline constexpr std::array<std::string_view, 6> link_part_names{"read", "inner", "plates", "joints", "tips", "solve"};

struct LinkParts {
    /// Number of doubles that the states of `links` links take as lanes.
    std::size_t (*lane_memory)(int links);
    /// @param part index into link_part_names   @param lanes [lane_memory], on a cache line; written by part 0, read by the others
    /// @param out [links][2 link_size()]   @param loads [links], written by tips
    void (*run)(int part, const model::ChainModel& model, const model::ChainRange& range, double* lanes, double* out,
                model::LinkLoad* loads);
};

/// Parts of order 3. Defined in link_parts.cpp.
template <model::Isa isa>
LinkParts link_parts();
inline constexpr auto one_lane = static_cast<model::Isa>(-1);  // bench/one_lane
template <>
LinkParts link_parts<one_lane>();
template <>
LinkParts link_parts<model::Isa::baseline>();
template <>
LinkParts link_parts<model::Isa::avx2>();
template <>
LinkParts link_parts<model::Isa::avx512>();

}  // namespace cvtflow::bench
