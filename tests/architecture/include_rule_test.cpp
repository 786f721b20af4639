/// Rules of includes, and of the places that may name threads and third parties.
///
///     model  → std                                              bench, tests → everything; tools → all but bench and tests
///     engine → std, POSIX, fmt (.cpp), HDF5 in engine/record (.cpp), oneTBB and OpenMP in engine/executor and engine/thread
///     (.cpp) tasks  → model, engine, std, any third party (.cpp) api    → model, engine, tasks, std; its public headers (api/include) →
///     std and one another only threads, locks and atomics: engine/executor and engine/thread only
///
/// A header that includes a third party, itself or through another one, is private: only files of the same room (engine/record with all its
/// folders, say) and tests include it. Rooms of a part stand on floors: includes point downwards, and never in a circle.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "source_tree_fixture.hpp"

namespace cvtflow::architecture {
namespace {

using Names = std::set<std::string>;

/// Parts of this project that a part may include.
const std::map<std::string, Names> friends{
    {"model", {"model"}},
    {"engine", {"engine"}},
    {"tasks", {"model", "engine", "tasks"}},
    {"api", {"model", "engine", "tasks", "api"}},
};

const Names thread_headers{"atomic",    "barrier",      "condition_variable", "future", "latch",    "mutex",
                           "semaphore", "shared_mutex", "stop_token",         "thread", "pthread.h"};
const Names system_headers{"dlfcn.h", "fcntl.h", "poll.h", "pthread.h", "sched.h", "unistd.h", "windows.h"};

/// Third party behind a header in angle brackets; empty for the standard library and POSIX.
std::string third_party(const std::string& name) {
    if (system_headers.contains(name) || name.starts_with("sys/") || name == "immintrin.h") return "";  // ships with the compiler
    if (name.starts_with("cvtflow/")) return "";                                                        // our public headers
    if (name == "omp.h") return "OpenMP";
    if (name.starts_with("hdf5") || name.starts_with("H5")) return "HDF5";
    if (name.starts_with("tbb/") || name.starts_with("oneapi/")) return "oneTBB";
    if (name.find_first_of("./") == std::string::npos) return name == "Eigen" ? "Eigen" : "";
    return name.substr(0, name.find('/'));
}

/// Third parties that a folder's .cpp files may include; "*" for any.
Names permitted(const SourceFile& file) {
    if (file.part() == "tasks") return {"*"};
    if (file.path.starts_with("api/python/")) return {"pybind11"};
    if (file.part() == "model" || file.part() == "api") return {};
    if (file.path.starts_with("engine/record/")) return {"fmt", "HDF5"};
    if (file.path.starts_with("engine/executor/") || file.path.starts_with("engine/thread/")) return {"fmt", "oneTBB"};
    return {"fmt"};
}

std::string where(const SourceFile& file, const Include& include) {
    return file.path + ":" + std::to_string(include.line) + ": " + include.name;
}

/// engine/record of engine/record/hdf5/handle.hpp; engine/. of a file in engine itself.
std::string room_of(const std::string& path) {
    const std::size_t first = path.find('/'), second = path.find('/', first + 1);
    return second == std::string::npos ? path.substr(0, first) + "/." : path.substr(0, second);
}

/// Files of model, engine and tasks.
std::vector<SourceFile> library() {
    std::vector<SourceFile> files = source_files();
    std::erase_if(files, [](const SourceFile& file) { return !friends.contains(file.part()); });
    return files;
}

/// Headers of the library that include a third party, directly or through another such header.
Names private_headers() {
    Names hidden;
    const auto reveals = [&](const Include& i) { return i.quoted ? hidden.contains(i.name) : !third_party(i.name).empty(); };
    for (bool grown = true; std::exchange(grown, false);) {
        for (const SourceFile& file : library()) {
            const std::vector<Include> includes = includes_of(file.text);
            if (!file.header() || !std::any_of(includes.begin(), includes.end(), reveals)) continue;
            grown |= hidden.insert(file.path).second;
        }
    }
    return hidden;
}

TEST(IncludeRule, PartsIncludeOnlyTheirFriends) {
    for (const SourceFile& file : library()) {
        for (const Include& include : includes_of(file.text)) {
            if (!include.quoted) continue;
            const std::string part = include.name.substr(0, include.name.find('/'));
            EXPECT_TRUE(friends.at(file.part()).contains(part)) << where(file, include);
        }
    }
}

/// The product is built, and changed, without the code that measures it.
TEST(IncludeRule, OnlyTestsAndItselfIncludeTheLaboratory) {
    for (const SourceFile& file : source_files()) {
        if (file.part() == "bench" || file.part() == "tests") continue;
        for (const Include& include : includes_of(file.text)) EXPECT_FALSE(include.name.starts_with("bench/")) << where(file, include);
    }
}

TEST(IncludeRule, ThirdPartiesAreIncludedWhereTheyBelong) {
    for (const SourceFile& file : library()) {
        const Names allowed = permitted(file);
        for (const Include& include : includes_of(file.text)) {
            const std::string party = include.quoted ? "" : third_party(include.name);
            if (party.empty()) continue;
            EXPECT_TRUE(allowed.contains(party) || allowed.contains("*")) << where(file, include) << " is " << party;
        }
    }
}

TEST(IncludeRule, HeadersThatIncludeThirdPartiesArePrivate) {
    const Names hidden = private_headers();
    for (const SourceFile& file : source_files()) {
        for (const Include& include : includes_of(file.text)) {
            if (!include.quoted || !hidden.contains(include.name)) continue;
            const bool further = file.path.starts_with("bench/executor/") && include.name.starts_with("engine/executor/");
            const bool same_room = further || room_of(include.name) == room_of(file.path);  // further executors run in the same arenas
            EXPECT_TRUE(same_room || file.part() == "tests") << where(file, include) << " is private to its folder";
        }
    }
}

/// Floors of a part's rooms, the ground floor first; what stands on one floor does not know its neighbours. A room of no floor is a
/// mistake.
const std::map<std::string, std::vector<Names>> floors{
    {"model",
     {{"model/basis"},
      {"model/parameters"},
      {"model/law"},
      {"model/machine"},
      {"model/force"},
      {"model/chain"},
      {"model/contact"},
      {"model/kernels"},
      {"model/rigid"},
      {"model/variator"},
      {"model/start"},
      {"model/observe"}}},
    {"engine",
     {{"engine/base"},
      {"engine/graph", "engine/event", "engine/thread"},
      {"engine/method", "engine/executor", "engine/record"},
      {"engine/alone"}}},
    {"tasks",
     {{"tasks/step"},
      {"tasks/method"},
      {"tasks/channel"},
      {"tasks/scene"},
      {"tasks/schedule", "tasks/sizing"},
      {"tasks/run"},
      {"tasks/batch"},
      {"tasks/tuning"}}},
};

/// -1 for rooms without a floor.
int floor_of(const std::string& room) {
    const std::vector<Names>& of_part = floors.at(room.substr(0, room.find('/')));
    for (std::size_t floor = 0; floor < of_part.size(); ++floor) {
        if (of_part[floor].contains(room)) return static_cast<int>(floor);
    }
    return -1;
}

TEST(IncludeRule, RoomsStandOnFloors) {
    for (const SourceFile& file : library()) {
        if (!floors.contains(file.part())) continue;
        const std::string room = room_of(file.path);
        EXPECT_GE(floor_of(room), 0) << file.path << ": its room stands on no floor";
        for (const Include& include : includes_of(file.text)) {
            if (!include.quoted || include.name.substr(0, include.name.find('/')) != file.part() || room_of(include.name) == room) continue;
            EXPECT_GT(floor_of(room), floor_of(room_of(include.name))) << where(file, include) << " points upwards";
        }
    }
}

TEST(IncludeRule, PublicHeadersIncludeTheStandardLibraryAndOneAnother) {
    for (const SourceFile& file : library()) {
        if (!file.path.starts_with("api/include/")) continue;
        for (const Include& include : includes_of(file.text)) {
            EXPECT_FALSE(include.quoted) << where(file, include);
            EXPECT_TRUE(third_party(include.name).empty() && (!include.name.ends_with(".h") || include.name.starts_with("cvtflow/")))
                << where(file, include);
        }
    }
}

TEST(IncludeRule, ThreadsLiveInTwoRooms) {
    for (const SourceFile& file : library()) {
        if (file.path.starts_with("engine/executor/") || file.path.starts_with("engine/thread/")) continue;
        for (const Include& include : includes_of(file.text)) EXPECT_FALSE(thread_headers.contains(include.name)) << where(file, include);
        EXPECT_EQ(code_only(file.text).find("thread_local"), std::string::npos) << file.path;
        EXPECT_EQ(file.text.find("#pragma omp"), std::string::npos) << file.path;
    }
}

TEST(IncludeRule, HeadersGuardThemselves) {
    for (const SourceFile& file : source_files()) {
        EXPECT_TRUE(!file.header() || file.text.starts_with("#pragma once\n")) << file.path;
    }
}

TEST(IncludeRule, ThirdPartiesAreRecognised) {
    EXPECT_EQ(third_party("vector"), "");
    EXPECT_EQ(third_party("unistd.h"), "");
    EXPECT_EQ(third_party("sys/stat.h"), "");
    EXPECT_EQ(third_party("Eigen/Dense"), "Eigen");
    EXPECT_EQ(third_party("hdf5_hl.h"), "HDF5");
    EXPECT_EQ(third_party("oneapi/tbb/flow_graph.h"), "oneTBB");
    EXPECT_EQ(third_party("omp.h"), "OpenMP");
    EXPECT_EQ(third_party("fmt/format.h"), "fmt");
}

}  // namespace
}  // namespace cvtflow::architecture
