#include "bench/lab/command/schedule/runtimes.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "engine/thread/child_process.hpp"
#include "tools/program/front.hpp"

namespace cvtflow::bench {

namespace {

constexpr const char* results_variable = "CVTFLOW_LAB_RESULTS";
constexpr int turns = 3;

std::vector<std::string> command_line() {
    std::ifstream file("/proc/self/cmdline", std::ios::binary);
    std::vector<std::string> words;
    for (std::string word; std::getline(file, word, '\0');) words.push_back(word);
    return words;
}

/// The profile of a process with this runtime loaded first (empty: the linked one) and this wait policy (empty: none is set).
Json profile_with(const std::string& library, const std::string& policy) {
    const int file = memfd_create("profile", 0);
    const std::string path = fmt::format("/proc/self/fd/{}", file);
    std::vector<std::string> words = command_line();
    const engine::ChildEnd end = engine::run_child([&] {
        setenv(results_variable, path.c_str(), 1);
        library.empty() ? unsetenv("LD_PRELOAD") : setenv("LD_PRELOAD", library.c_str(), 1);
        policy.empty() ? unsetenv("OMP_WAIT_POLICY") : setenv("OMP_WAIT_POLICY", policy.c_str(), 1);
        execv("/proc/self/exe", tools::pointers(words).data());
        return 1;
    });
    Json profile;
    if (end.status == 0) profile = Json::parse(std::ifstream(path));
    close(file);
    if (end.status != 0) throw std::runtime_error(fmt::format("a process with the runtime '{}' failed", library));
    return profile;
}

}  // namespace

bool is_runtime_child() noexcept { return std::getenv(results_variable) != nullptr; }

void hand_back(const Json& profile) {
    std::ofstream file(std::getenv(results_variable));
    file << profile;
    file.close();
    if (!file) throw std::runtime_error(fmt::format("{}: cannot write", std::getenv(results_variable)));
}

Json profiles_by_runtime(std::vector<std::string> libraries) {
    if (libraries.empty()) {
        for (const char* usual : {"/usr/lib/llvm-14/lib/libomp.so.5", "/usr/lib/x86_64-linux-gnu/libomp.so.5"}) {
            if (libraries.empty() && std::filesystem::exists(usual)) libraries.emplace_back(usual);
        }
        if (libraries.empty())
            throw std::runtime_error("no OpenMP runtime of LLVM here (Debian: libomp-14-dev): name one by --openmp FILE");
    }
    for (std::string& library : libraries) {
        if (!std::filesystem::exists(library)) throw std::runtime_error(library + ": no such file");
        library = std::filesystem::absolute(library).string();
    }
    libraries.insert(libraries.begin(), "");
    Json results{{"turns", turns}, {"profiles", Json::array()}, {"complaints", Json::array()}};
    for (int turn = 0; turn < turns; ++turn) {
        for (const std::string& library : libraries) {
            for (const char* policy : {"", "active", "passive"}) {
                Json profile = profile_with(library, policy);
                const std::string used = profile["machine"]["openmp"];
                if (!library.empty() && used.find(std::filesystem::path(library).filename().string()) == std::string::npos)
                    results["complaints"].push_back(fmt::format("{} is not in use: {}", library, used));
                for (const Json& complaint : profile.value("complaints", Json::array())) results["complaints"].push_back(complaint);
                results["profiles"].push_back(std::move(profile));
            }
        }
    }
    return results;
}

}  // namespace cvtflow::bench
