/// The first page, from its installation to a program of one's own, in an empty folder with nothing but the installation on the path.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include "tests/docs/page_fixture.hpp"

namespace cvtflow::docs {
namespace {

namespace fs = std::filesystem;

class NightlyReadme : public testing::Test {
protected:
    NightlyReadme() : folder_(fs::temp_directory_path() / ("cvtflow_readme_" + std::to_string(getpid()))) {
        fs::create_directories(folder_ / "empty");
    }
    ~NightlyReadme() override { fs::remove_all(folder_); }

    /// Runs lines as a script in the empty folder; what they print is output().
    [[nodiscard]] int run(const std::string& text) const {
        std::ofstream(folder_ / "script") << "set -eo pipefail\nunset CVTFLOW_SCENES LD_LIBRARY_PATH\nexport PATH='" << prefix()
                                          << "/bin':/usr/bin:/bin PKG_CONFIG_PATH=\"$(dirname \"$(find '" << prefix()
                                          << "' -name cvtflow.pc)\")\"\n"
                                          << text;
        return std::system(
            ("cd '" + (folder_ / "empty").string() + "' && bash ../script >'" + (folder_ / "output").string() + "' 2>&1").c_str());
    }
    [[nodiscard]] std::string output() const {
        std::ifstream file(folder_ / "output");
        return {std::istreambuf_iterator<char>(file), {}};
    }
    [[nodiscard]] std::string prefix() const { return (folder_ / "prefix").string(); }

    fs::path folder_;
};

TEST_F(NightlyReadme, IsFollowedFromAnInstallation) {
    const std::string install = "cmake --install '" CVTFLOW_BINARY_DIR "' --prefix '" + prefix() + "' >/dev/null";
    ASSERT_EQ(std::system(install.c_str()), 0);
    int blocks = 0;
    for (const Block& block : page("README.md").blocks()) {
        if (!block.file.empty()) std::ofstream(folder_ / "empty" / block.file) << block.text;
        const bool own_program = block.text.find("hold.cpp") != std::string::npos;
        if (!block.file.empty() || (!block.runs() && !own_program)) continue;
        EXPECT_EQ(run(block.text), 0) << "README.md:" << block.line << "\n" << block.text << output();
        ++blocks;
    }
    EXPECT_GE(blocks, 4) << "simulation, variant, sweep, program";
    if (fs::exists(CVTFLOW_BINARY_DIR "/cvtflow_fmu.so")) {
        EXPECT_EQ(run("cvtflow export-fmu tiny --set start.settling_time='20 us' --set start.ramp_time='10 us'"), 0) << output();
    }
}

/// The first results of a newcomer must be plausible for a transmission: settled, an efficiency of 90 to 99 %, tensions that follow the
/// torque.
TEST_F(NightlyReadme, ShowsNumbersThatAnEngineerBelieves) {
    const std::string install = "cmake --install '" CVTFLOW_BINARY_DIR "' --prefix '" + prefix() + "' >/dev/null";
    ASSERT_EQ(std::system(install.c_str()), 0);
    for (const Block& block : page("README.md").blocks())
        if (!block.file.empty()) std::ofstream(folder_ / "empty" / block.file) << block.text;
    ASSERT_EQ(run("cvtflow run baseline -o none && cvtflow batch first_sweep.toml -q -o first && cvtflow table first --column efficiency "
                  "--column notes --column slip_mean | tail -n +3 | head -2"),
              0)
        << output();
    const std::string text = output();
    EXPECT_EQ(text.find("note "), std::string::npos) << text;
    EXPECT_NE(text.find("efficiency 98."), std::string::npos) << text;
    std::istringstream rows(text.substr(text.find("state hash")));
    int cases = 0;
    for (std::string line; std::getline(rows, line);) {
        std::istringstream cells(line);
        double efficiency = 0.0, slip = 0.0;           // in per cent
        if (!(cells >> efficiency >> slip)) continue;  // notes are empty: the second number is the slip
        EXPECT_TRUE(efficiency > 90.0 && efficiency < 99.5) << line;
        EXPECT_TRUE(slip > 0.05 && slip < 1.0) << line;
        ++cases;
    }
    EXPECT_EQ(cases, 2) << text;
}

}  // namespace
}  // namespace cvtflow::docs
