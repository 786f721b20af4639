#include "engine/base/spelling.hpp"

#include <gtest/gtest.h>

namespace cvtflow::engine {
namespace {

TEST(Spelling, DistanceCountsInsertionsDeletionsReplacementsAndSwaps) {
    EXPECT_EQ(edit_distance("pitch", "pitch"), 0U);
    EXPECT_EQ(edit_distance("pich", "pitch"), 1U);
    EXPECT_EQ(edit_distance("pittch", "pitch"), 1U);
    EXPECT_EQ(edit_distance("patch", "pitch"), 1U);
    EXPECT_EQ(edit_distance("ptich", "pitch"), 1U);
    EXPECT_EQ(edit_distance("", "pitch"), 5U);
    EXPECT_EQ(edit_distance("pitch", ""), 5U);
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
}

TEST(Spelling, DistanceIsSymmetric) { EXPECT_EQ(edit_distance("driven", "driving"), edit_distance("driving", "driven")); }

TEST(Spelling, ClosestIsTheNearestCandidate) {
    EXPECT_EQ(closest("chian", {"chain", "half", "plate"}), "chain");
    EXPECT_EQ(closest("drivem", {"driving", "driven"}), "driven");
}

TEST(Spelling, NothingIsSuggestedForAFarWord) {
    EXPECT_EQ(closest("gearbox", {"chain", "half", "plate"}), "");
    EXPECT_EQ(closest("x", {"y", "z"}), "");
    EXPECT_EQ(closest("pitch", {}), "");
}

TEST(Spelling, SuggestionIsAQuestion) {
    EXPECT_EQ(did_you_mean("chain"), " (did you mean \"chain\"?)");
    EXPECT_EQ(did_you_mean(""), "");
    EXPECT_EQ(did_you_mean(std::vector<std::string>{"pins", "rods"}), " (did you mean \"pins\" or \"rods\"?)");
}

}  // namespace
}  // namespace cvtflow::engine
