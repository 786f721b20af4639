#pragma once
/// Samples of catalogues: each commit tests another part of them, the nightly tests all of it.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "engine/base/hash.hpp"
#include "engine/base/provenance.hpp"

namespace cvtflow::test {

/// Seed of this commit's samples: CVTFLOW_TEST_SEED, or else the hash of the commit that was configured. CVTFLOW_TEST_SEED=all: no
/// sampling.
inline std::string sample_seed() {
    const char* given = std::getenv("CVTFLOW_TEST_SEED");
    return given != nullptr ? given : engine::current_provenance().commit;
}

/// `count` of the items, in their order, drawn by the seed and the name of the test that draws.
template <class Item>
std::vector<Item> sample(const std::vector<Item>& items, std::size_t count, const std::string& test) {
    if (sample_seed() == "all") return items;
    std::mt19937_64 draw(engine::Hash().add(sample_seed()).add(test).value());
    std::vector<Item> drawn;
    std::sample(items.begin(), items.end(), std::back_inserter(drawn), count, draw);
    return drawn;
}

}  // namespace cvtflow::test
