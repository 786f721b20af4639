/// A folder shows a reader at most a dozen things: header and source of one name are one, a subfolder is one.

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "source_tree_fixture.hpp"

namespace cvtflow::architecture {
namespace {

constexpr std::size_t max_things = 12;

using Things = std::map<std::string, std::set<std::string>>;

/// What every folder of `parts` shows, of files that git knows.
Things things(const std::set<std::string>& parts) {
    std::istringstream listing(output_of("git -C '" CVTFLOW_SOURCE_DIR "' ls-files 2>/dev/null"));
    Things shown;
    for (std::string line; std::getline(listing, line);) {
        const std::filesystem::path file = line;
        if (!parts.contains(file.begin()->string())) continue;
        const bool source = file.extension() == ".cpp" || file.extension() == ".hpp";
        std::filesystem::path thing = source ? std::filesystem::path(file).replace_extension() : file;
        for (; thing.has_parent_path(); thing = thing.parent_path()) {
            shown[thing.parent_path().generic_string()].insert(thing.filename().string());
        }
    }
    return shown;
}

TEST(FolderSize, FoldersShowAtMostADozenThings) {
    Things shown = things({"model", "engine", "tasks", "api", "tools", "bench"});
    if (shown.empty()) GTEST_SKIP() << "no git to ask";
    for (const char* programs : {"bench", "bench/results"}) shown.erase(programs);  // each of them stands for itself
    for (const auto& [folder, names] : shown) EXPECT_LE(names.size(), max_things) << folder;
}

TEST(FolderSize, HeaderAndSourceAreOneThing) {
    const Things shown = things({"model"});
    if (shown.empty()) GTEST_SKIP() << "no git to ask";
    EXPECT_TRUE(shown.at("model").contains("EQUATIONS.md"));
    EXPECT_TRUE(shown.at("model/variator").contains("variator"));
    EXPECT_EQ(shown.at("model/variator").size(), 3u) << "chain_model and variator, a header and a source each, and rigid/";
}

}  // namespace
}  // namespace cvtflow::architecture
