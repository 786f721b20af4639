/// The core library, of which FMUs are made: what it needs, and that its results are those of the library.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cinttypes>
#include <cstdio>
#include <cvtflow/cvtflow.hpp>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

namespace {

namespace fs = std::filesystem;

/// Exit status and what a command printed on both streams.
std::pair<int, std::string> output_of(const std::string& command) {
    std::string text;
    FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    for (int letter = std::fgetc(pipe); letter != EOF; letter = std::fgetc(pipe)) text += static_cast<char>(letter);
    return {pclose(pipe), text};
}

class CoreLibrary : public testing::Test {
protected:
    CoreLibrary() { fs::create_directory(folder_); }
    ~CoreLibrary() override { fs::remove_all(folder_); }

    /// Path of a new file with that text.
    [[nodiscard]] std::string scene_file(const std::string& text) const {
        const fs::path path = folder_ / "scene.toml";
        std::ofstream(path) << text;
        return path.string();
    }

    fs::path folder_ = fs::path(testing::TempDir()) / ("core_library_" + std::to_string(::getpid()));
};

TEST_F(CoreLibrary, GivesTheBitsOfTheLibrary) {
    const std::vector<std::string> settings{"start.state=\"\"", "start.settling_time=0.2 ms", "start.ramp_time=0.1 ms"};
    const cvtflow::Scene scene = cvtflow::Scene::ready("tiny").with(settings);
    cvtflow::Simulation expected(scene);
    expected.advance_to(2e-5);  // settles first
    expected.advance_to(2e-5);
    char hash[32];
    std::snprintf(hash, sizeof hash, "%016" PRIx64 "\n", expected.hash());
    EXPECT_EQ(output_of(CVTFLOW_CORE_PROGRAM " " + scene_file(scene.text()) + " 2e-5"), std::pair(0, std::string(hash)));
}

TEST_F(CoreLibrary, ReadsNoStateFileAndReportsIt) {
    const cvtflow::Scene scene = cvtflow::Scene::ready("control");
    ASSERT_NE(scene.value("start.state"), "\"\"");
    const auto [status, text] = output_of(CVTFLOW_CORE_PROGRAM " " + scene_file(scene.text()) + " 2e-5");
    EXPECT_NE(status, 0);
    EXPECT_THAT(text, testing::HasSubstr("this library cannot read state files"));
}

TEST_F(CoreLibrary, LinksNoLibraryButThoseOfCxx) {
    const auto [status, text] = output_of("readelf -d " CVTFLOW_CORE_PROGRAM);
    ASSERT_EQ(status, 0);
    const std::regex needed(R"(\(NEEDED\).*\[([a-z_A-Z+0-9-]+)\.so)");
    std::set<std::string> names;
    for (std::sregex_iterator row(text.begin(), text.end(), needed), end; row != end; ++row) names.insert((*row)[1]);
    if (*CVTFLOW_SANITIZER != '\0') std::erase_if(names, [](const std::string& name) { return name.ends_with("san"); });
    EXPECT_THAT(names, testing::IsSubsetOf({"libstdc++", "libm", "libgcc_s", "libc", "ld-linux-x86-64"}));
    EXPECT_THAT(names, testing::Contains("libstdc++"));
}

/// By construction: not what the linker happened to need, but all that any of its objects mentions.
TEST_F(CoreLibrary, MentionsNoThreadLibraryAndNoFileOfPosix) {
    const auto [status, text] = output_of("nm -u " CVTFLOW_CORE_LIBRARY);
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
