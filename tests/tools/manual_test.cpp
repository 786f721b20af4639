/// The manual page and the completions, made by tools/documents/manual of the program's own help.

#include <gmock/gmock.h>

#include <array>
#include <cstdio>
#include <string>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A text as in a manual page.
std::string hyphenated(std::string text) {
    for (std::size_t at = text.find('-'); at != std::string::npos; at = text.find('-', at + 2)) text.insert(at, "\\");
    return text;
}

class Manual : public Program {
protected:
    /// Output of a shell command in the test's folder, which must succeed.
    std::string output_of(const std::string& command) const {
        std::FILE* pipe = popen(("cd '" + folder_.string() + "' && " + command).c_str(), "r");
        std::string output;
        std::array<char, 4096> buffer;
        while (const std::size_t size = std::fread(buffer.data(), 1, buffer.size(), pipe)) output.append(buffer.data(), size);
        EXPECT_EQ(pclose(pipe), 0) << command;
        return output;
    }
    std::string made(const std::string& kind, const std::string& program = CVTFLOW_PROGRAM) const {
        return output_of("'" CVTFLOW_SOURCE_DIR "/tools/documents/manual' " + kind + " '" + program + "'");
    }
};

TEST_F(Manual, EveryKindKnowsEveryCommand) {
    for (const std::string program : {CVTFLOW_PROGRAM, CVTFLOW_LAB}) {
        const std::vector<std::string> all = commands_of(program);
        ASSERT_GE(all.size(), 10u);
        const std::string page = made("man", program), bash = made("bash", program), zsh = made("zsh", program),
                          fish = made("fish", program);
        for (const std::string& name : all) {
            EXPECT_THAT(page, HasSubstr(hyphenated("Usage: " + program.substr(program.rfind('/') + 1) + " " + name))) << name;
            EXPECT_THAT(bash, HasSubstr("        " + name + ") words='")) << name;
            EXPECT_THAT(zsh, HasSubstr("\n    " + name + ") _arguments")) << name;
            EXPECT_THAT(fish, HasSubstr("-a '" + name + "' -d ")) << name;
        }
    }
}

TEST_F(Manual, CompletionsKnowOptionsOfTheirCommand) {
    EXPECT_THAT(made("bash"), testing::ContainsRegex("        run\\) words='[^']*--checkpoint-every [^']*--until "));
    EXPECT_THAT(made("fish"), AllOf(HasSubstr("__fish_seen_subcommand_from run' -l 'until' "),
                                    HasSubstr("__fish_seen_subcommand_from batch' -l 'dry-run' ")));
}

TEST_F(Manual, BashCompletesCommandsOptionsAndNamesOfTheCatalogues) {
    write("completions", made("bash"));
    const std::string path = std::string(CVTFLOW_PROGRAM).substr(0, std::string(CVTFLOW_PROGRAM).rfind('/'));
    const auto complete = [&](const std::string& words, int at) {
        return output_of("PATH='" + path + "':$PATH bash -c '. ./completions; COMP_WORDS=(" + words +
                         "); COMP_CWORD=" + std::to_string(at) + "; _cvtflow; echo \"${COMPREPLY[@]}\"'");
    };
    EXPECT_EQ(complete("cvtflow che", 1), "check\n");
    EXPECT_EQ(complete("cvtflow run --unt", 2), "--until\n");
    EXPECT_THAT(complete("cvtflow run bas", 2), HasSubstr("baseline"));
    EXPECT_THAT(complete("cvtflow run tiny --method leapfrog-ch", 4), HasSubstr("leapfrog-chebyshev"));
    EXPECT_EQ(complete("cvtflow explain tip.rad", 2), "tip.radius\n");
}

TEST_F(Manual, BashCompletesCommandsOfTheLaboratory) {
    write("completions", made("bash", CVTFLOW_LAB));
    EXPECT_EQ(output_of("bash -c '. ./completions; COMP_WORDS=(cvtflow-lab granu); COMP_CWORD=1; _cvtflow_lab; echo \"${COMPREPLY[@]}\"'"),
              "granularity\n");
}

TEST_F(Manual, AnUnknownKindIsAnErrorOfUsage) {
    EXPECT_EQ(output_of("{ '" CVTFLOW_SOURCE_DIR "/tools/documents/manual' html x 2>/dev/null; echo $?; }"), "2\n");
}

}  // namespace
}  // namespace cvtflow::tools
