#pragma once
/// Random choices for a mutant of an HDF5 file.

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <random>
#include <vector>

namespace cvtflow::engine {

using Bytes = std::vector<std::byte>;

/// Numbers drawn from a seed; the same everywhere.
class Dice {
public:
    explicit Dice(std::uint64_t seed) : draw_(seed) {}
    std::uint64_t below(std::uint64_t end) { return end == 0 ? 0 : draw_() % end; }
    bool heads() { return below(2) == 0; }
    template <class Items>
    const auto& one_of(const Items& items) {
        return *std::next(std::begin(items), static_cast<std::ptrdiff_t>(below(std::size(items))));
    }
    /// Small ones, powers of two and their neighbours: what shapes go wrong with.
    hsize_t extent() {
        const hsize_t power = hsize_t{1} << below(62);
        const hsize_t choices[] = {0, 1, 2, 3, 7, below(100), power, power - 1, power + 1};
        return choices[below(std::size(choices))];
    }

private:
    std::mt19937_64 draw_;
};

}  // namespace cvtflow::engine
