#pragma once
/// False files, made from true ones: a seed decides what is changed, so that every mutant can be made again.
///
/// Two layers. Through HDF5 itself, so that the library finds nothing wrong: rank, extent, type, width, links, attributes, filters, chunks.
/// In the bytes: bits, zeros, pieces, lengths; also in metadata whose checksum is then renewed, as an attacker does.

#include <hdf5.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
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
    /// Small extents, powers of two and their neighbours, which cause errors in shapes.
    hsize_t extent() {
        const hsize_t power = hsize_t{1} << below(62);
        const hsize_t choices[] = {0, 1, 2, 3, 7, below(100), power, power - 1, power + 1};
        return choices[below(std::size(choices))];
    }

private:
    std::mt19937_64 draw_;
};

enum class Mutation { rank, extent, type, storage, link, attribute, group, bits, bytes, size, forged };
inline constexpr std::array<std::string_view, 11> mutation_names{"rank",  "extent", "type",  "storage", "link",  "attribute",
                                                                 "group", "bits",   "bytes", "size",    "forged"};

struct MutantOptions {
    bool seal_anew = false;  ///< renews the seal, like an expert; otherwise it stays as it was, or is lost
    bool forge = true;       ///< corrects checksums of headers, too
};

/// Changes a file in place. @return kind of the change
Mutation mutate(const std::string& path, std::uint64_t seed, const MutantOptions& options);

}  // namespace cvtflow::engine
