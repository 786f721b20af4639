/// The first page, from its installation to a program of the reader, in an empty folder with nothing but the installation on the path.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/docs/page_fixture.hpp"

namespace cvtflow::docs {
namespace {

namespace fs = std::filesystem;

class DeepReadme : public testing::Test {
protected:
    DeepReadme() : folder_(fs::temp_directory_path() / ("cvtflow_readme_" + std::to_string(getpid()))) {
        fs::create_directories(folder_ / "empty");
    }
    ~DeepReadme() override { fs::remove_all(folder_); }

    /// Runs lines as a script in the empty folder; output() is what they print.
    [[nodiscard]] int run(const std::string& text) const {
        std::ofstream(folder_ / "script") << "set -eo pipefail\nunset CVTFLOW_SCENES LD_LIBRARY_PATH\nexport PATH='" << prefix()
                                          << "/bin':/usr/bin:/bin PKG_CONFIG_PATH=\"$(dirname \"$(find '" << prefix()
                                          << "' -name cvtflow.pc)\")\"\n"
                                          << text;
        return std::system(
            ("cd '" + (folder_ / "empty").string() + "' && bash ../script >'" + (folder_ / "output").string() + "' 2>&1").c_str());
    }
    [[nodiscard]] std::string output() const { return text_of(folder_ / "output"); }
    [[nodiscard]] std::string prefix() const { return (folder_ / "prefix").string(); }

    fs::path folder_;
};

/// The first results of a newcomer must be plausible for a transmission: settled, an efficiency of 90 to 99 %, tensions that follow the
/// torque.
TEST_F(DeepReadme, IsFollowedFromAnInstallationAndShowsNumbersThatAnEngineerBelieves) {
    const std::string install = "cmake --install '" CVTFLOW_BINARY_DIR "' --prefix '" + prefix() + "' >/dev/null";
    ASSERT_EQ(std::system(install.c_str()), 0);
    std::string shown;  // by the first block, a simulation
    int blocks = 0;
    for (const Block& block : page("README.md").blocks()) {
        if (!block.file.empty()) std::ofstream(folder_ / "empty" / block.file) << block.text;
        const bool own_program = block.text.find("hold.cpp") != std::string::npos;
        if (!block.file.empty() || (!block.runs() && !own_program)) continue;
        EXPECT_EQ(run(block.text), 0) << "README.md:" << block.line << "\n" << block.text << output();
        if (++blocks == 1) shown = output();
    }
    EXPECT_GE(blocks, 4) << "simulation, variant, sweep, program";
    const std::size_t note = shown.find("note ");  // seven pin periods know slip to some per cent only, and the summary states so
    EXPECT_TRUE(note == std::string::npos || shown.find("means are not known to 1 %") == shown.find_first_not_of(' ', note + 5)) << shown;
    EXPECT_EQ(shown.rfind("note "), note) << shown;
    EXPECT_NE(shown.find("efficiency 98."), std::string::npos) << shown;
    EXPECT_EQ(run("cvtflow table first --column efficiency --column notes --column slip_mean | tail -n +3 | head -2"), 0) << output();
    std::istringstream rows(output());
    int cases = 0;
    double efficiency = 0.0, slip = 0.0;           // in per cent
    for (; rows >> efficiency >> slip; ++cases) {  // notes are empty: the second number is the slip
        EXPECT_TRUE(efficiency > 90.0 && efficiency < 99.5) << output();
        EXPECT_TRUE(slip > 0.05 && slip < 1.0) << output();
    }
    EXPECT_EQ(cases, 2) << output();
    if (!fs::exists(CVTFLOW_BINARY_DIR "/cvtflow_fmu.so")) return;
    EXPECT_EQ(run("cvtflow export-fmu tiny --set start.settling_time='20 us' --set start.ramp_time='10 us'"), 0) << output();
}

}  // namespace
}  // namespace cvtflow::docs
