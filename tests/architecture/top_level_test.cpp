/// The top level is the first thing that a newcomer sees: nothing lands there by accident.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "source_tree_fixture.hpp"

namespace cvtflow::architecture {
namespace {

const std::set<std::string> allowed{
    ".ci",
    ".clang-format",
    ".clang-tidy",
    ".gitignore",
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "CMakeLists.txt",
    "CMakePresets.json",
    "LICENSE",
    "README.md",
    "CITATION.cff",     // read there by the sites that offer to cite a repository
    "CONTRIBUTING.md",  // where contributors expect it
    "SECURITY.md",      // likewise
    "debian",           // dpkg-buildpackage searches nowhere else
    "docs",             // pages for users, decisions, gallery
    "api",              // what host programs include and link: must be found without knowing the inside
    "bench",
    "engine",
    "examples",        // the first thing that an author of a host program opens; a project of its own as well
    "pyproject.toml",  // pip searches nowhere else
    "model",
    "scenes",
    "tasks",
    "tests",
    "tools",
};

TEST(TopLevel, HoldsOnlyWhatIsAllowed) {
    const std::set<std::string> tracked = tracked_top_level();
    if (tracked.empty()) GTEST_SKIP() << "no git to ask";
    for (const std::string& name : tracked) EXPECT_TRUE(allowed.contains(name)) << name;
}

TEST(TopLevel, HoldsWhatEveryBuildNeeds) {
    const std::set<std::string> tracked = tracked_top_level();
    if (tracked.empty()) GTEST_SKIP() << "no git to ask";
    EXPECT_THAT(tracked, testing::IsSupersetOf({"CMakeLists.txt", "LICENSE", "engine", "model", "tests"}));
}

}  // namespace
}  // namespace cvtflow::architecture
