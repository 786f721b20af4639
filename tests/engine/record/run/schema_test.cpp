#include "engine/record/run/schema.hpp"

#include <gmock/gmock.h>

#include <algorithm>

namespace cvtflow::engine {
namespace {

TEST(Schema, MakesAttributesOfProvenance) {
    const Provenance here = current_provenance();
    const auto attributes = attributes_of(here);
    EXPECT_THAT(attributes, testing::Contains(Attribute{"commit", here.commit}));
    EXPECT_THAT(attributes, testing::Contains(Attribute{"cores", std::int64_t{here.cores}}));
    const auto is_version = [](const Attribute& each) { return each.name == "hdf5_version"; };
    const auto version = std::find_if(attributes.begin(), attributes.end(), is_version);
    ASSERT_NE(version, attributes.end());
    EXPECT_THAT(std::get<std::string>(version->value), testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
}

}  // namespace
}  // namespace cvtflow::engine
