/// Every block of commands on every page runs: page by page, in order, in an empty folder with the program on the path.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "tests/docs/page_fixture.hpp"

namespace cvtflow::docs {
namespace {

namespace fs = std::filesystem;

/// An empty folder in which the source tree's folders and the build can be named as on the page.
class Workplace {
public:
    explicit Workplace(const std::string& name)
        : folder_(fs::temp_directory_path() / ("cvtflow_docs_" + std::to_string(getpid()) + "_" + name)) {
        fs::create_directories(folder_);
        for (const char* part : {"api", "bench", "docs", "scenes", "tools", "tests"})
            fs::create_symlink(fs::path(CVTFLOW_SOURCE_DIR) / part, folder_ / part);
        fs::create_symlink(CVTFLOW_BINARY_DIR, folder_ / "build");
    }
    ~Workplace() { fs::remove_all(folder_); }
    Workplace(const Workplace&) = delete;
    Workplace& operator=(const Workplace&) = delete;

    void write(const Block& block) const { std::ofstream(folder_ / block.file) << block.text; }
    /// Runs a block as a script that ends at the first command that fails. @return exit status
    [[nodiscard]] int run(const Block& block) const {
        std::ofstream(folder_ / ".block") << "set -eo pipefail\n" << with_expected_failures(block.text);
        const std::string line =
            "cd '" + folder_.string() + "' && PATH='" + CVTFLOW_BINARY_DIR + "':/usr/bin:\"$PATH\" bash .block >.output 2>&1";
        return std::system(line.c_str());
    }
    [[nodiscard]] std::string output() const {
        std::ifstream file(folder_ / ".output");
        return {std::istreambuf_iterator<char>(file), {}};
    }

private:
    /// "command; test $? = 3" states a failure that is right.
    static std::string with_expected_failures(const std::string& text) {
        return text.find("test $?") == std::string::npos ? text : "set +e\nfail() { echo \"$1\"; exit 1; }\n" + checked(text);
    }
    /// Every line that ends in a test must pass it.
    static std::string checked(const std::string& text) {
        std::string result;
        for (std::size_t begin = 0; begin < text.size();) {
            const std::size_t end = text.find('\n', begin);
            const std::string line = text.substr(begin, end - begin);
            result += line + "\n[ $? = 0 ] || fail 'this line failed'\n";
            begin = end + 1;
        }
        return result;
    }

    fs::path folder_;
};

class PageCommands : public testing::TestWithParam<std::string> {
protected:
    /// Runs the quick blocks of the page, or all.
    static void run_page(const std::string& path, bool nightly) {
        const Workplace workplace(testing::UnitTest::GetInstance()->current_test_info()->name() + std::to_string(nightly));
        for (const Block& block : page(path).blocks()) {
            if (!block.file.empty()) workplace.write(block);
            if (!block.runs() || (!nightly && !block.nightly.empty())) continue;
            EXPECT_EQ(workplace.run(block), 0) << path << ":" << block.line << "\n" << block.text << workplace.output();
        }
    }
};

using NightlyPageCommands = PageCommands;

TEST_P(PageCommands, Run) { run_page(GetParam(), false); }

TEST_P(NightlyPageCommands, Run) { run_page(GetParam(), true); }

/// Pages with a block that runs, and with one that runs at night.
std::vector<std::string> pages_with_commands(bool nightly) {
    std::vector<std::string> paths;
    for (const Page& each : pages()) {
        bool has = false;
        for (const Block& block : each.blocks()) has = has || (block.runs() && block.nightly.empty() != nightly);
        if (has) paths.push_back(each.path);
    }
    return paths;
}

/// A name of letters, digits and _.
std::string test_name(const testing::TestParamInfo<std::string>& info) {
    std::string name = info.param;
    for (char& letter : name)
        if (std::isalnum(static_cast<unsigned char>(letter)) == 0) letter = '_';
    return name;
}

INSTANTIATE_TEST_SUITE_P(Pages, PageCommands, testing::ValuesIn(pages_with_commands(false)), test_name);
INSTANTIATE_TEST_SUITE_P(Pages, NightlyPageCommands, testing::ValuesIn(pages_with_commands(true)), test_name);

TEST(Blocks, AreRunWrittenOrSayWhyNot) {
    const std::set<std::string> shown{"text", "json", "math"};  // output and formulas, never run
    for (const Page& each : pages()) {
        for (const Block& block : each.blocks()) {
            const bool explained = block.runs() || !block.not_run.empty() || !block.file.empty() || shown.contains(block.language);
            EXPECT_TRUE(explained) << each.path << ":" << block.line << ": a block of " << block.language;
        }
    }
}

TEST(Blocks, AreFoundWithWhatTheirCommentsSay) {
    const Page sample{"sample.md",
                      "text\n<!-- file: a.toml -->\n```toml\nx = 1\n```\n\n```sh\nls\n```\n<!-- nightly: hours -->\n```sh\nwait\n```\n"};
    const std::vector<Block> blocks = sample.blocks();
    ASSERT_EQ(blocks.size(), 3u);
    EXPECT_EQ(blocks[0].file, "a.toml");
    EXPECT_EQ(blocks[0].text, "x = 1\n");
    EXPECT_FALSE(blocks[0].runs());
    EXPECT_TRUE(blocks[1].runs() && blocks[1].nightly.empty() && blocks[1].file.empty());
    EXPECT_EQ(blocks[2].nightly, "hours");
    EXPECT_EQ(blocks[2].line, 11);
}

}  // namespace
}  // namespace cvtflow::docs
