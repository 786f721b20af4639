/// The core library, of which FMUs are made: what it needs, how it is installed, and that its results are those of the library. Which
/// libraries its programs link, static and shared: package_test.cpp.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cinttypes>
#include <cstdio>
#include <cvtflow/cvtflow.hpp>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>

#include "command_fixture.hpp"

namespace cvtflow::host {
namespace {

namespace fs = std::filesystem;

class CoreLibrary : public testing::Test {
protected:
    CoreLibrary() { fs::create_directory(folder_); }
    ~CoreLibrary() override { fs::remove_all(folder_); }

    /// Exit status and output of core_program for a scene of that text.
    [[nodiscard]] std::pair<int, std::string> run(const std::string& text) const {
        std::ofstream(folder_ / "scene.toml") << text;
        return output_of("'" CVTFLOW_CORE_PROGRAM "' " + (folder_ / "scene.toml").string() + " 2e-5");
    }

    fs::path folder_ = fs::path(testing::TempDir()) / ("core_library_" + std::to_string(::getpid()));
};

TEST_F(CoreLibrary, GivesTheBitsOfTheLibrary) {
    const std::vector<std::string> settings{"start.state=\"\"", "start.settling_time=0.2 ms", "start.ramp_time=0.1 ms"};
    const cvtflow::Scene scene = Scene::ready("tiny").with(settings);
    Simulation expected(scene);
    expected.advance_to(2e-5);  // settles first
    expected.advance_to(2e-5);
    char hash[32];
    std::snprintf(hash, sizeof hash, "%016" PRIx64 "\n", expected.hash());
    EXPECT_EQ(run(scene.text()), std::pair(0, std::string(hash)));
}

TEST_F(CoreLibrary, BeginsWithASettledState) {
    const cvtflow::Scene scene = Scene::ready("control");
    Simulation expected(scene);
    expected.advance_to(2e-5);
    char hash[32];
    std::snprintf(hash, sizeof hash, "%016" PRIx64 "\n", expected.hash());
    EXPECT_EQ(run(scene.text()), std::pair(0, std::string(hash)));
}

TEST_F(CoreLibrary, ReadsNoTextFileAndStatesWhatToDoInstead) {
    const std::string text = "this library reads no files: pass a scene as text";
    EXPECT_THAT(run("[load]\ntorque = {csv = \"load.csv\"}\n").second,
                testing::HasSubstr("load.torque: \"load.csv\" cannot be read: " + text));
    EXPECT_THAT(output_of("'" CVTFLOW_CORE_PROGRAM "' ./tiny 2e-5").second, testing::HasSubstr("./tiny: cannot be read: " + text));
}

/// The program and the commands of docs/embedding.md, with a ready scene.
TEST_F(CoreLibrary, IsInstalledAndUsedAsItsPageDescribes) {
    std::ifstream file(CVTFLOW_SOURCE_DIR "/docs/embedding.md");
    const std::string page{std::istreambuf_iterator<char>(file), {}};
    const auto block = [&page](const std::string& head) {
        const std::size_t begin = page.find(head) + head.size();
        return page.substr(begin, page.find("```", begin) - begin);
    };
    std::ofstream(folder_ / "hold.cpp") << block("<!-- file: hold.cpp -->\n```cpp\n");
    std::ofstream(folder_ / "commands") << block("tests/api/core_test.cpp runs it -->\n```sh\n");
    fs::create_directory_symlink(CVTFLOW_BINARY_DIR, folder_ / "build");
    const auto [status, text] = output_of("cd " + folder_.string() + " && HOME=$PWD bash -e commands");
    EXPECT_EQ(status, 0) << text;
    EXPECT_THAT(text, testing::HasSubstr("reliable: 1\n"));
}

TEST_F(CoreLibrary, ThatIsNotInstalledIsNamedWithItsCommands) {
    std::ofstream(folder_ / "find.cmake") << "find_package(cvtflow REQUIRED COMPONENTS core PATHS \"" CVTFLOW_BINARY_DIR
                                             "/api\" NO_DEFAULT_PATH)";
    EXPECT_THAT(output_of("cmake -P " + (folder_ / "find.cmake").string() + " 2>&1 | tr -s ' \n' ' '").second,
                testing::HasSubstr("component 'core' is not installed: cmake --build build --target cvtflow_core_shared && cmake --install "
                                   "build --component core"));
}

/// The check covers all names that any object mentions, not only those that the linker needed.
TEST_F(CoreLibrary, MentionsNoThreadLibraryAndNoFileOfPosix) {
    const auto [status, text] = output_of("nm -u '" CVTFLOW_CORE_LIBRARY "'");
    ASSERT_EQ(status, 0);
    const std::regex forbidden(
        "(H5.*|GOMP_.*|omp_.*|_ZN3tbb.*|TBB_.*|(open|fstat|stat|lstat|read|write|mmap|fsync)(64)?|poll|fork|pthread_create|sched_.*)");
    std::istringstream lines(text);
    int names = 0;
    for (std::string letter, name, line; std::getline(lines, line);) {
        if (!(std::istringstream(line) >> letter >> name) || letter != "U") continue;
        ++names;
        EXPECT_FALSE(std::regex_match(name, forbidden)) << name;
    }
    EXPECT_GT(names, 100);
}

}  // namespace
}  // namespace cvtflow::host
