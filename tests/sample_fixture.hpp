#pragma once
/// How much a test tries, in one place. Depth: `./tools/test` tries every promise once (quick), `.ci/run` every combination (deep); a suite
/// whose name begins with Deep runs in the latter only, one that begins with Nightly in neither. Samples of catalogues: a change is tested
/// with the same ones as the change before, the nightly tests draw others and try all.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/hash.hpp"

namespace cvtflow::test {

/// Environment variable CVTFLOW_TEST_DEPTH: deep, or else quick.
inline bool is_deep() {
    const char* given = std::getenv("CVTFLOW_TEST_DEPTH");
    return given != nullptr && std::string_view(given) == "deep";
}

/// Returns the value for the depth of this run: a count, a list of rows.
template <class Value>
Value depth(const Value& quick, const Value& deep) {
    return is_deep() ? deep : quick;
}

/// CVTFLOW_TEST_SEED, or else one that stays; CVTFLOW_TEST_SEED=all: no sampling.
inline std::string sample_seed() {
    const char* given = std::getenv("CVTFLOW_TEST_SEED");
    return given != nullptr ? given : "same";
}

/// Draws `count` of the items, in their order, by the seed and the name of the test.
template <class Item>
std::vector<Item> sample(const std::vector<Item>& items, std::size_t count, const std::string& test) {
    if (sample_seed() == "all") return items;
    std::mt19937_64 draw(engine::Hash().add(sample_seed()).add(test).value());
    std::vector<Item> drawn;
    std::sample(items.begin(), items.end(), std::back_inserter(drawn), count, draw);
    return drawn;
}

}  // namespace cvtflow::test
