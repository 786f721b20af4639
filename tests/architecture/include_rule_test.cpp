/// Who may include whom, and where threads and third parties may be spoken of.
///
///     model  → std, Eigen (.cpp)                                tools, bench, tests → everything
///     engine → std, POSIX, fmt and Eigen (.cpp), HDF5 in engine/record (.cpp), oneTBB and OpenMP in engine/executor (.cpp)
///     tasks  → model, engine, std, any third party (.cpp)
///     api    → model, engine, tasks, std; its public headers (api/include) → std and one another only
///     threads, locks and atomics: engine/executor only
///
/// A header that includes a third party, itself or through another one, is private: only files of its own folder and
/// tests include it.

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

const Names thread_headers{"atomic", "barrier",   "condition_variable", "future",     "latch",
                           "mutex",  "semaphore", "shared_mutex",       "stop_token", "thread", "pthread.h"};
const Names posix_headers{"dlfcn.h", "fcntl.h", "poll.h", "pthread.h", "sched.h", "unistd.h"};

/// Third party behind a header in angle brackets; empty for the standard library and POSIX.
std::string third_party(const std::string& name) {
    if (posix_headers.contains(name) || name.starts_with("sys/") || name == "immintrin.h") return "";   // ships with the compiler
    if (name.starts_with("cvtflow/")) return "";   // our public headers
    if (name == "omp.h") return "OpenMP";
    if (name.starts_with("hdf5") || name.starts_with("H5")) return "HDF5";
    if (name.starts_with("tbb/") || name.starts_with("oneapi/")) return "oneTBB";
    if (name.find_first_of("./") == std::string::npos) return name == "Eigen" ? "Eigen" : "";
    return name.substr(0, name.find('/'));
}

/// Third parties that a folder's .cpp files may include; "*" for any.
Names permitted(const SourceFile& file) {
    if (file.part() == "model") return {"Eigen"};
    if (file.part() == "tasks") return {"*"};
    if (file.part() == "api") return {};
    if (file.path.starts_with("engine/record/")) return {"Eigen", "fmt", "HDF5"};
    if (file.path.starts_with("engine/executor/")) return {"Eigen", "fmt", "oneTBB", "OpenMP"};
    return {"Eigen", "fmt"};
}

std::string where(const SourceFile& file, const Include& include) {
    return file.path + ":" + std::to_string(include.line) + ": " + include.name;
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
            const bool own = include.name.substr(0, include.name.rfind('/')) == file.folder();
            EXPECT_TRUE(own || file.part() == "tests") << where(file, include) << " is private to its folder";
        }
    }
}

TEST(IncludeRule, PublicHeadersIncludeTheStandardLibraryAndOneAnother) {
    for (const SourceFile& file : library()) {
        if (!file.path.starts_with("api/include/")) continue;
        for (const Include& include : includes_of(file.text)) {
            EXPECT_FALSE(include.quoted) << where(file, include);
            EXPECT_TRUE(third_party(include.name).empty() && (!include.name.ends_with(".h") || include.name.starts_with("cvtflow/"))) << where(file, include);
        }
    }
}

TEST(IncludeRule, ThreadsLiveInOneFolder) {
    for (const SourceFile& file : library()) {
        if (file.path.starts_with("engine/executor/")) continue;
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
