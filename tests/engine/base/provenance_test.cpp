#include "engine/base/provenance.hpp"

#include <gmock/gmock.h>

namespace cvtflow::engine {
namespace {

TEST(Provenance, NamesProgramBuildAndMachine) {
    const Provenance here = current_provenance();
    EXPECT_THAT(here.version, testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
    EXPECT_FALSE(here.commit.empty());
    EXPECT_THAT(here.compiler, testing::MatchesRegex("[A-Za-z]+ [0-9.]+"));
    EXPECT_FALSE(here.build_type.empty());
    EXPECT_FALSE(here.instruction_set.empty());
    EXPECT_FALSE(here.cpu.empty());
    EXPECT_GE(here.cores, 1);
    EXPECT_FALSE(here.os.empty());
}

TEST(Provenance, DatesInUtc) {
    EXPECT_THAT(current_provenance().date, testing::MatchesRegex("20[0-9][0-9]-[01][0-9]-[0-3][0-9]T[0-2][0-9]:[0-5][0-9]:[0-6][0-9]Z"));
}

}  // namespace
}  // namespace cvtflow::engine
