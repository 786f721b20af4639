/// Links between pages lead to files and headings that exist; decisions and their numbers agree.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include "tests/docs/page_fixture.hpp"

namespace cvtflow::docs {
namespace {

namespace fs = std::filesystem;

/// Path from the top level to which a link of a page leads.
std::string target_of(const std::string& path, const std::string& link) {
    return (fs::path(path).parent_path() / link).lexically_normal().generic_string();
}

TEST(Links, LeadToFilesAndHeadings) {
    std::size_t followed = 0;
    for (const Page& each : pages()) {
        for (const std::string& link : each.links()) {
            if (link.find("://") != std::string::npos || link.starts_with("mailto:")) continue;
            const std::size_t hash = std::min(link.find('#'), link.size());
            const std::string target = hash == 0 ? each.path : target_of(each.path, link.substr(0, hash));
            EXPECT_TRUE(fs::exists(fs::path(CVTFLOW_SOURCE_DIR) / target)) << each.path << ": " << link;
            if (hash < link.size()) {
                EXPECT_THAT(page(target).anchors(), testing::Contains(link.substr(hash + 1))) << each.path << ": " << link;
            }
            ++followed;
        }
    }
    EXPECT_GT(followed, 50u);
}

TEST(Links, HeadingsAreReachedAsOnTheWeb) {
    const Page sample{"sample.md", "# Was it `auto`? Yes, 5 %\n```sh\n# no heading\n```\n## 59. What detail decides\n"};
    EXPECT_THAT(sample.anchors(), testing::ElementsAre("was-it-auto-yes-5-", "59-what-detail-decides"));
}

TEST(Pages, TheReadmeHasAHundredLinesAtMost) {
    const std::string text = page("README.md").text;
    EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 100);
}

TEST(Pages, EveryPageIsReachedFromTheIndex) {
    std::vector<std::string> reached{"docs/index.md"};
    for (const std::string path : {"docs/index.md", "docs/decisions/README.md"})
        for (const std::string& link : page(path).links()) reached.push_back(target_of(path, link));
    for (const Page& each : pages())
        EXPECT_TRUE(!each.path.starts_with("docs/") || std::ranges::find(reached, each.path) != reached.end()) << each.path;
}

TEST(Pages, HaveOneOrderInTheIndexAndTheSite) {
    std::vector<std::string> index, site;
    for (const std::string& link : page("docs/index.md").links()) {
        const std::string path = target_of("docs/index.md", link);
        if (path.starts_with("docs/") && !path.starts_with("docs/decisions/")) index.push_back("/" + path.substr(0, path.rfind('.')));
    }
    std::ifstream contents(fs::path(CVTFLOW_SOURCE_DIR) / "docs/site/contents.rst");
    for (std::string line; std::getline(contents, line);) {
        const std::string entry = line.substr(std::min(line.size(), line.find_first_not_of(' ')));
        if (entry.starts_with("/docs/") && entry != "/docs/index" && !entry.starts_with("/docs/decisions/")) site.push_back(entry);
    }
    EXPECT_GE(index.size(), 20u);
    EXPECT_EQ(index, site);
}

/// Number of every decision and its file.
std::map<int, std::string> decisions() {
    static const std::regex heading("## ([0-9]+)\\. .*");
    std::map<int, std::string> found;
    for (const Page& each : pages()) {
        if (!each.path.starts_with("docs/decisions/")) continue;
        const std::vector<Line> lines = each.text_lines();
        for (std::size_t k = 0; k + 2 < lines.size(); ++k) {
            std::smatch match;
            if (!std::regex_match(lines[k].text, match, heading)) continue;
            EXPECT_TRUE(found.emplace(std::stoi(match[1]), fs::path(each.path).filename().string()).second) << match[1] << " stands twice";
            EXPECT_TRUE(lines[k + 2].text.starts_with("Status: ")) << each.path << ": " << match[1];
        }
    }
    return found;
}

TEST(Decisions, StandOnceAndInTheIndex) {
    const auto all = decisions();
    const std::string index = page("docs/decisions/README.md").text;
    int next = 1;
    for (const auto& [number, file] : all) {
        EXPECT_EQ(number, next++) << "a number is missing";
        EXPECT_TRUE(std::regex_search(index, std::regex("\\| " + std::to_string(number) + " \\| [^\n]*\\]\\(" + file + "\\)"))) << number;
    }
    EXPECT_GE(all.size(), 77u);
}

TEST(Decisions, ThatCodeAndPagesNameExist) {
    static const std::regex reference("DECISIONS ([0-9]+)");
    const auto all = decisions();
    std::size_t found = 0;
    for (const char* folder : {"api", "bench", "docs", "engine", "model", "tasks", "tools"}) {
        for (const auto& entry : fs::recursive_directory_iterator(fs::path(CVTFLOW_SOURCE_DIR) / folder)) {
            const std::string kind = entry.path().extension();
            if (kind != ".hpp" && kind != ".cpp" && kind != ".md") continue;
            const std::string text = text_of(entry.path());
            for (std::sregex_iterator each(text.begin(), text.end(), reference), end; each != end; ++each, ++found)
                EXPECT_TRUE(all.contains(std::stoi((*each)[1]))) << entry.path() << ": " << each->str();
        }
    }
    EXPECT_GT(found, 3u);
}

}  // namespace
}  // namespace cvtflow::docs
