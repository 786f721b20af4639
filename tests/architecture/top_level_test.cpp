/// The repository as a whole: names on its top level, the format of its sources, one version everywhere.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include "source_tree_fixture.hpp"

namespace cvtflow::architecture {
namespace {

// The top level is the first thing that a newcomer sees: nothing lands there by accident.

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
    "examples",        // the first thing that an author of a host program opens; a separate project as well
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

// Sources are formatted by .clang-format, so that a change shows only what changed.

TEST(DeepFormat, OfEverySourceIsThatOfTheFile) {
    const std::string formatter = output_of("command -v clang-format-14 2>/dev/null");  // other versions break lines elsewhere
    if (formatter.empty() || tracked_top_level().empty()) GTEST_SKIP() << "needs clang-format-14 and git";
    const std::string changed = output_of("cd '" CVTFLOW_SOURCE_DIR "' && " + git +
                                          "ls-files -z '*.cpp' '*.hpp' 2>/dev/null | xargs -0 -r clang-format-14 --dry-run 2>&1 | "
                                          "grep -o '^[^:]*:[0-9]*:[0-9]*: warning' | sort -u | head -40; true");
    EXPECT_EQ(changed, "") << "clang-format-14 -i FILE corrects it";
}

// One version everywhere: tools/release compares, and writes.

/// Files that tools/release reads and writes, copied to a folder that is removed with the test.
class Release : public testing::Test {
protected:
    void SetUp() override {
        for (const char* part : {"CMakeLists.txt", "CITATION.cff", "debian", "api/include", "api/install/cvtflow-config.cmake.in",
                                 "docs/embedding.md", "examples/CMakeLists.txt", "tests/api/consumer", "tools/release"}) {
            std::filesystem::create_directories((folder_ / part).parent_path());
            std::filesystem::copy(std::filesystem::path(CVTFLOW_SOURCE_DIR) / part, folder_ / part,
                                  std::filesystem::copy_options::recursive);
        }
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    [[nodiscard]] int release(const std::string& arguments) const {
        const std::string line =
            "'" + (folder_ / "tools/release").string() + "' " + arguments + " > '" + (folder_ / "said").string() + "' 2>&1";
        return WEXITSTATUS(std::system(line.c_str()));
    }
    [[nodiscard]] std::string read(const std::string& name) const {
        std::ifstream file(folder_ / name);
        return {std::istreambuf_iterator<char>(file), {}};
    }

    std::filesystem::path folder_ = std::filesystem::temp_directory_path() / ("cvtflow_release_test_" + std::to_string(::getpid()));
};

TEST_F(Release, EveryPlaceStatesTheVersionOfTheProject) { EXPECT_EQ(release(""), 0) << read("said"); }

TEST_F(Release, APlaceThatStatesAnotherVersionIsNamed) {
    std::ofstream(folder_ / "CITATION.cff") << "version: 0.0.9\n";
    EXPECT_EQ(release(""), 1);
    EXPECT_THAT(read("said"), testing::StartsWith("CITATION.cff: 0.0.9, not "));
    std::ofstream(folder_ / "CITATION.cff") << "no version\n";
    EXPECT_EQ(release(""), 1);
    EXPECT_THAT(read("said"), testing::StartsWith("CITATION.cff: nothing, not "));
}

TEST_F(Release, ANewVersionIsWrittenIntoAllOfThem) {
    EXPECT_EQ(release("12.34.56"), 0) << read("said");
    EXPECT_EQ(read("said"), "12.34.56\n");
    EXPECT_EQ(release(""), 0);
    EXPECT_THAT(read("CMakeLists.txt"), testing::HasSubstr("project(cvtflow VERSION 12.34.56 "));
    EXPECT_THAT(read("api/include/cvtflow/version.hpp"), testing::HasSubstr("VERSION_MINOR 34\n"));
    EXPECT_THAT(read("debian/changelog"), testing::StartsWith("cvtflow (12.34.56) unstable"));
    EXPECT_EQ(release("12.34"), 2) << "three numbers";
}

}  // namespace
}  // namespace cvtflow::architecture
