#pragma once
/// Files that lie, made from true ones: a seed decides what is changed, so that every mutant can be made again.
///
/// Two layers. Through HDF5 itself, so that the library finds nothing wrong: rank, extent, type, width, links, attributes, filters, chunks.
/// In the bytes: bits, zeros, pieces, lengths; also in metadata whose checksum is then renewed, which only an enemy does.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace cvtflow::engine {

enum class Mutation { rank, extent, type, storage, link, attribute, group, bits, bytes, size, forged };
inline constexpr std::array<std::string_view, 11> mutation_names{"rank",  "extent", "type",  "storage", "link",  "attribute",
                                                                 "group", "bits",   "bytes", "size",    "forged"};

struct MutantOptions {
    bool seal_anew = false;  ///< as someone does who knows how; otherwise the seal stays as it was, or is lost
    bool forge = true;       ///< headers with checksums made right, too
};

/// Changes a file in place. @return what was done
Mutation mutate(const std::string& path, std::uint64_t seed, const MutantOptions& options);

}  // namespace cvtflow::engine
