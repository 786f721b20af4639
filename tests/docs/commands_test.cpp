/// Every block of commands and of Python on every page runs: page by page, in order, in an empty folder with the program on the path.
/// Blocks that need the laboratory run at depth deep.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/docs/page_fixture.hpp"
#include "tests/sample_fixture.hpp"

namespace cvtflow::docs {
namespace {

namespace fs = std::filesystem;

/// An empty folder in which the source tree's folders and the build can be named as on the page.
class Workplace {
public:
    Workplace() : folder_(fs::temp_directory_path() / ("cvtflow_docs_" + std::to_string(getpid()))) {
        fs::create_directories(folder_);
        for (const char* part : {"api", "bench", "docs", "scenes", "tools", "tests"})
            fs::create_symlink(fs::path(CVTFLOW_SOURCE_DIR) / part, folder_ / part);
        fs::create_symlink(CVTFLOW_BINARY_DIR, folder_ / "build");
    }
    ~Workplace() { fs::remove_all(folder_); }
    Workplace(const Workplace&) = delete;
    Workplace& operator=(const Workplace&) = delete;

    void write(const Block& block) const { std::ofstream(folder_ / block.file) << block.text; }
    /// Runs a block as a script that ends at the first command that fails, Python by the interpreter of the build. @return exit status
    [[nodiscard]] int run(const Block& block) const {
        const bool python = block.language == "python";
        std::ofstream(folder_ / ".block") << (python ? block.text : "set -eo pipefail\n" + with_expected_failures(block.text));
        const std::string line = "cd '" + folder_.string() + "' && PATH='" + CVTFLOW_BINARY_DIR +
                                 "':/usr/bin:\"$PATH\" PYTHONPATH=build/python MPLBACKEND=Agg " +
                                 (python ? "$(sed -n 's/^Python3_EXECUTABLE:FILEPATH=//p' build/CMakeCache.txt)" : "bash") +
                                 " .block >.output 2>&1";
        return std::system(line.c_str());
    }
    [[nodiscard]] std::string output() const { return text_of(folder_ / ".output"); }

private:
    /// "command; test $? = 3" states a failure that is right.
    static std::string with_expected_failures(const std::string& text) {
        return std::regex_replace(text, std::regex("(.*; test [$][?] .*)"), "(set +e; $1\n)");
    }

    fs::path folder_;
};

/// Whether this build provides everything that the block needs, at this depth.
bool runs(const Block& block, bool nightly) {
    const bool module = fs::exists(CVTFLOW_BINARY_DIR "/python");
    const bool now = nightly || (block.nightly.empty() && (test::is_deep() || !block.is_deep()));
    return block.runs() && now && (module || block.language != "python");
}

class PageCommands : public testing::TestWithParam<std::string> {
protected:
    /// Runs the quick blocks of the page, or all. Blocks of Python that no command separates are one program, whose lines have the page's
    /// numbers.
    static void run_page(const std::string& path, bool nightly) {
        const Workplace workplace;
        const auto run = [&](const Block& block) {
            EXPECT_EQ(workplace.run(block), 0) << path << ":" << block.line << "\n"
                                               << block.text.substr(block.text.find_first_not_of('\n')) << workplace.output();
        };
        Block program;
        program.language = "python";
        const auto end_program = [&] {
            if (!program.text.empty()) run(program);
            program.text.clear();
        };
        for (const Block& block : page(path).blocks()) {
            if (!block.file.empty()) workplace.write(block);
            if (!runs(block, nightly)) continue;
            if (block.language == "python") {
                const auto before = std::count(program.text.begin(), program.text.end(), '\n');
                program.text += std::string(static_cast<std::size_t>(block.line - before), '\n') + block.text;
            } else {
                end_program();
                run(block);
            }
        }
        end_program();
    }
};

using NightlyPageCommands = PageCommands;

TEST_P(PageCommands, Run) { run_page(GetParam(), false); }

TEST_P(NightlyPageCommands, Run) { run_page(GetParam(), true); }

/// Pages with a block that runs, and with one that runs at night.
std::vector<std::string> pages_with_commands(bool nightly) {
    std::vector<std::string> paths;
    const auto has = [&](const Block& block) { return runs(block, nightly) && block.nightly.empty() != nightly; };
    for (const Page& each : pages())
        if (std::ranges::any_of(each.blocks(), has)) paths.push_back(each.path);
    return paths;
}

/// A name of letters, digits and _.
std::string test_name(const testing::TestParamInfo<std::string>& info) {
    std::string name = info.param;
    std::ranges::replace_if(
        name, [](unsigned char letter) { return std::isalnum(letter) == 0; }, '_');
    return name;
}

INSTANTIATE_TEST_SUITE_P(Pages, PageCommands, testing::ValuesIn(pages_with_commands(false)), test_name);
INSTANTIATE_TEST_SUITE_P(Pages, NightlyPageCommands, testing::ValuesIn(pages_with_commands(true)), test_name);

TEST(Blocks, AreFencedAndRunWrittenOrSayWhyNot) {
    const std::set<std::string> shown{"text", "json", "math"};  // output and formulas, never run
    for (const Page& each : pages()) {
        for (const Block& block : each.blocks()) {
            const bool explained = block.runs() || !block.not_run.empty() || !block.file.empty() || shown.contains(block.language);
            EXPECT_TRUE(explained) << each.path << ":" << block.line << ": a block of " << block.language;
        }
        bool blank = each.path != "ARCHITECTURE.md";  // shows sources, with which ArchitecturePage compares them
        for (const Line& line : each.text_lines()) {
            EXPECT_FALSE(blank && line.text.starts_with("    ")) << each.path << ":" << line.number << ": an indented block";
            blank = line.text.empty() && each.path != "ARCHITECTURE.md";
        }
    }
}

TEST(Blocks, AreFoundWithWhatTheirCommentsSay) {
    const Page sample{"sample.md",
                      "text\n<!-- file: a.toml -->\n```toml\nx = 1\n```\n\n```sh\nls\n```\n<!-- nightly: hours -->\n```sh\nwait\n```\n"};
    const std::vector<Block> blocks = sample.blocks();
    ASSERT_EQ(blocks.size(), 3u);
    EXPECT_TRUE(blocks[0].file == "a.toml" && blocks[0].text == "x = 1\n" && !blocks[0].runs());
    EXPECT_TRUE(blocks[1].runs() && blocks[1].nightly.empty() && blocks[1].file.empty());
    EXPECT_TRUE(blocks[2].nightly == "hours" && blocks[2].line == 11);
}

}  // namespace
}  // namespace cvtflow::docs
