/// The shared library as hosts of plugins load it: by dlopen, many times, in two versions at once; and what it shows.

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cvtflow/cvtflow.h>
#include <array>
#include <cstdio>
#include <cvtflow/error.hpp>
#include <cvtflow/simulation.hpp>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "command_fixture.hpp"

namespace cvtflow::host {
namespace {

// Codes and inputs have the same numbers in both interfaces.
#define CVTFLOW_SAME(c, cpp) static_assert(static_cast<int>(c) == static_cast<int>(cpp))
CVTFLOW_SAME(CVTFLOW_ARGUMENT, ErrorCode::argument);
CVTFLOW_SAME(CVTFLOW_SCENE, ErrorCode::scene);
CVTFLOW_SAME(CVTFLOW_START_STATE, ErrorCode::start_state);
CVTFLOW_SAME(CVTFLOW_STATE, ErrorCode::state);
CVTFLOW_SAME(CVTFLOW_BUSY, ErrorCode::busy);
CVTFLOW_SAME(CVTFLOW_FORKED, ErrorCode::forked);
CVTFLOW_SAME(CVTFLOW_CANCELLED, ErrorCode::cancelled);
CVTFLOW_SAME(CVTFLOW_MEMORY, ErrorCode::memory);
CVTFLOW_SAME(CVTFLOW_INTERNAL, ErrorCode::internal);
CVTFLOW_SAME(CVTFLOW_CALLBACK, ErrorCode::callback);
CVTFLOW_SAME(CVTFLOW_RECORD, ErrorCode::record);
CVTFLOW_SAME(CVTFLOW_NON_FINITE, ErrorCode::non_finite);
CVTFLOW_SAME(CVTFLOW_PENETRATION, ErrorCode::penetration);
CVTFLOW_SAME(CVTFLOW_LEFT_SHEAVE, ErrorCode::left_sheave);
CVTFLOW_SAME(CVTFLOW_MAX_STEPS, ErrorCode::max_steps);
CVTFLOW_SAME(CVTFLOW_MAX_WALL, ErrorCode::max_wall);
CVTFLOW_SAME(CVTFLOW_BLOW_UP, ErrorCode::blow_up);
CVTFLOW_SAME(CVTFLOW_OTHER_FAULT, ErrorCode::other_fault);
CVTFLOW_SAME(CVTFLOW_CLAMPING_DRIVING, Input::clamping_driving);
CVTFLOW_SAME(CVTFLOW_CLAMPING_DRIVEN, Input::clamping_driven);
CVTFLOW_SAME(CVTFLOW_LOAD_TORQUE, Input::load_torque);
CVTFLOW_SAME(CVTFLOW_DRIVE_TORQUE, Input::drive_torque);
CVTFLOW_SAME(CVTFLOW_DRIVE_SPEED, Input::drive_speed);
CVTFLOW_SAME(CVTFLOW_RATIO, Input::ratio);
CVTFLOW_SAME(CVTFLOW_LOAD_SPEED, Input::load_speed);
CVTFLOW_SAME(CVTFLOW_LOAD_ANGLE, Input::load_angle);
CVTFLOW_SAME(CVTFLOW_DRIVE_ANGLE, Input::drive_angle);
CVTFLOW_SAME(CVTFLOW_PRESSURE_DRIVING, Input::pressure_driving);
CVTFLOW_SAME(CVTFLOW_PRESSURE_DRIVEN, Input::pressure_driven);
#undef CVTFLOW_SAME

const std::string scene_file = std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml";

/// The C interface of one loaded library.
class Library {
public:
    explicit Library(const std::string& path) : handle_(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) {
        if (handle_ == nullptr) std::fprintf(stderr, "%s\n", dlerror());
    }
    ~Library() {
        if (handle_ != nullptr) dlclose(handle_);
    }
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;

    [[nodiscard]] bool loaded() const { return handle_ != nullptr; }
    /// The function of the header with this name. It is not named itself: unoptimised code would want it linked.
    template <class Function>
    [[nodiscard]] Function* function(const char* name) const {
        return reinterpret_cast<Function*>(dlsym(handle_, name));
    }

private:
    void* handle_;
};

#define FROM(library, name) (library).function<decltype(name)>(#name)

/// A short run through the C interface on two private threads of the library. @return hash, 0 if something fails
std::uint64_t run_in(const Library& library) {
    cvtflow_message message = CVTFLOW_INIT(cvtflow_message);
    cvtflow_scene* scene = nullptr;
    cvtflow_scene* brief = nullptr;
    cvtflow_simulation* simulation = nullptr;
    const std::array settings{"start.settling_time=0.2 ms", "start.ramp_time=0.2 ms", "run.step=100 ns"};
    cvtflow_options options = CVTFLOW_INIT(cvtflow_options);
    options.way = CVTFLOW_PRIVATE_ARENA;
    options.threads = 2;
    std::uint64_t hash = 0;
    if (FROM(library, cvtflow_scene_read)(scene_file.c_str(), &scene, &message) == CVTFLOW_OK &&
        FROM(library, cvtflow_scene_with)(scene, settings.data(), settings.size(), &brief, &message) == CVTFLOW_OK &&
        FROM(library, cvtflow_create)(brief, &options, &simulation, &message) == CVTFLOW_OK &&
        FROM(library, cvtflow_advance_to)(simulation, -1.9e-4, &message) == CVTFLOW_OK) {
        hash = FROM(library, cvtflow_hash)(simulation);
    } else {
        std::fprintf(stderr, "%s\n", message.text);
    }
    FROM(library, cvtflow_destroy)(simulation);
    FROM(library, cvtflow_scene_release)(brief);
    FROM(library, cvtflow_scene_release)(scene);
    return hash;
}

bool mapped(const std::string& name) {
    std::ifstream maps("/proc/self/maps");
    for (std::string line; std::getline(maps, line);) {
        if (line.find(name) != std::string::npos) return true;
    }
    return false;
}

TEST(SharedLibrary, IsLoadedAndUnloadedManyTimes) {
    EXPECT_EQ(in_child([] {
                  std::uint64_t expected = 0;
                  for (int round = 0; round < 20; ++round) {
                      {
                          const Library library(CVTFLOW_LIBRARY);
                          if (!library.loaded()) return 1;
                          const std::uint64_t hash = run_in(library);
                          if (round == 0) expected = hash;
                          if (hash == 0 || hash != expected) return 2;
                          if (FROM(library, cvtflow_shutdown)() != CVTFLOW_OK) return 3;
                      }
                      if (mapped("libcvtflow")) return 4;
                  }
                  return 0;
              }),
              0);
}

TEST(SharedLibrary, LivesBesideAnotherVersion) {
    EXPECT_EQ(in_child([] {
                  const Library one(CVTFLOW_LIBRARY), other(CVTFLOW_NEXT_LIBRARY);
                  if (!one.loaded() || !other.loaded()) return 1;
                  if (std::string(FROM(one, cvtflow_version)()) == FROM(other, cvtflow_version)()) return 2;
                  const std::uint64_t expected = run_in(one);
                  for (int round = 0; round < 3; ++round) {
                      if (run_in(one) != expected || run_in(other) != expected) return 3;
                  }
                  // Before they are unloaded, as embedding.md asks: oneTBB's threads may still be on their way out of their code.
                  if (FROM(one, cvtflow_shutdown)() != CVTFLOW_OK || FROM(other, cvtflow_shutdown)() != CVTFLOW_OK) return 5;
                  return expected != 0 ? 0 : 4;
              }),
              0);
}

/// Names with versions that the library shows and that match `pattern` of grep -E.
std::set<std::string> shown(const std::string& pattern) {
    std::istringstream lines(
        output_of("nm -D --defined-only --with-symbol-versions '" CVTFLOW_LIBRARY "' | awk '{print $3}' | grep -E '" + pattern + "'")
            .second);
    std::set<std::string> names;
    for (std::string name; std::getline(lines, name);) names.insert(name);
    return names;
}

TEST(SharedLibrary, ShowsTheFunctionsOfTheSymbolFileAndNoOther) {
    std::ifstream file(CVTFLOW_SOURCE_DIR "/tests/api/symbols.txt");
    std::set<std::string> promised;
    for (std::string line; std::getline(file, line);) {
        if (!line.empty() && line[0] != '#') promised.insert(line);
    }
    EXPECT_GT(promised.size(), 25u);
    EXPECT_EQ(shown("^cvtflow_"), promised)
        << "a function that was added belongs into tests/api/symbols.txt; one that is gone breaks programs";
}

TEST(SharedLibrary, HidesItsInsideAndWhatItIsMadeOf) {
    for (const std::string& name : shown(".")) {
        const bool interface = name.starts_with("cvtflow_") || name.starts_with("CVTFLOW_");
        EXPECT_TRUE(interface) << name;
    }
}

TEST(SharedLibrary, HeaderDeclaresWhatTheSymbolFilePromises) {
    std::ifstream header(CVTFLOW_SOURCE_DIR "/api/include/cvtflow/cvtflow.h");
    const std::string text{std::istreambuf_iterator<char>(header), {}};
    for (const std::string& name : shown("^cvtflow_"))
        EXPECT_NE(text.find(" " + name.substr(0, name.find('@')) + "("), std::string::npos) << name;
}

/// Sizes and places of members are part of the binary interface: x86-64 and other 64-bit systems.
TEST(SharedLibrary, StructsKeepTheirLayout) {
    EXPECT_EQ(sizeof(cvtflow_message), 1024u);
    EXPECT_EQ(offsetof(cvtflow_message, text), 8u);
    EXPECT_EQ(sizeof(cvtflow_options), 16u);
    EXPECT_EQ(sizeof(cvtflow_energy), 32u);
    EXPECT_EQ(offsetof(cvtflow_energy, error_ratio), 24u);
    EXPECT_EQ(sizeof(cvtflow_counters), 48u);
    EXPECT_EQ(offsetof(cvtflow_counters, suppressed), 40u);
    EXPECT_EQ(sizeof(cvtflow_channel_info), 40u);
    EXPECT_EQ(offsetof(cvtflow_channel_info, width), 32u);
    EXPECT_EQ(sizeof(cvtflow_transition), 32u);
    EXPECT_EQ(offsetof(cvtflow_transition, time), 24u);
}

}  // namespace
}  // namespace cvtflow::host
