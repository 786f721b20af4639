#include "bench/lab/measure/wait_policies.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>

#include "engine/executor/catalogue.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using Environment = std::vector<std::pair<std::string, std::string>>;

constexpr const char* variables[] = {"OMP_WAIT_POLICY", "GOMP_SPINCOUNT", "KMP_BLOCKTIME"};

std::vector<std::string> environment_of(const Environment& requested) {
    std::vector<std::string> words;
    for (char** each = environ; *each != nullptr; ++each) {
        const std::string word = *each, name = word.substr(0, word.find('='));
        if (std::find(std::begin(variables), std::end(variables), name) == std::end(variables)) words.push_back(word);
    }
    for (const auto& [name, value] : requested) words.push_back(name + "=" + value);
    return words;
}

std::vector<char*> pointers(std::vector<std::string>& words) {
    std::vector<char*> list;
    for (std::string& word : words) list.push_back(word.data());
    list.push_back(nullptr);
    return list;
}

std::string read_file(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// A folder for the children's files, gone with this.
class Scratch {
public:
    Scratch() {
        std::string name = (std::filesystem::temp_directory_path() / "cvtflow-profile-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) throw std::runtime_error(name + ": cannot create a folder for the children's files");
        path_ = name;
    }
    ~Scratch() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    [[nodiscard]] std::string file(const char* name) const { return (path_ / name).string(); }

private:
    std::filesystem::path path_;
};

/// Runs this program with these words; its output goes to files of the scratch folder. @throws std::runtime_error unless it ends with
/// status 0
void run_child(std::vector<std::string> words, const Environment& environment, const Scratch& scratch) {
    words.insert(words.begin(), "cvtflow-lab");
    std::vector<std::string> settings = environment_of(environment);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, scratch.file("out").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, scratch.file("err").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    pid_t child = -1;
    const int refused = posix_spawn(&child, "/proc/self/exe", &actions, nullptr, pointers(words).data(), pointers(settings).data());
    posix_spawn_file_actions_destroy(&actions);
    int status = 0;
    if (refused != 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        throw std::runtime_error(fmt::format("a child with other wait policies failed: {}", read_file(scratch.file("err"))));
    }
}

/// Fused schedules that a policy affects, restricted to those that the user named. Staged ones wait in the same way, more often.
std::vector<std::string> schedules_of(const WaitPolicy& policy, const std::vector<std::string>& names) {
    std::vector<std::string> list;
    for (const std::string& executor : policy.executors) {
        const bool named =
            std::any_of(names.begin(), names.end(), [&](const std::string& name) { return name.substr(0, name.find(':')) == executor; });
        if (names.empty() || named) list.push_back(executor + ":fused");
    }
    return list;
}

}  // namespace

std::vector<WaitPolicy> wait_policies() {
#if defined(__clang__)  // LLVM's runtime spins for a time, GNU's for a count
    const char* spin = "KMP_BLOCKTIME";
    const char* counts[] = {"0", "1", "infinite"};
#else
    const char* spin = "GOMP_SPINCOUNT";
    const char* counts[] = {"0", "3000", "infinity"};
#endif
    std::vector<std::string> all, openmp, own;
    for (const engine::ExecutorRow& row : engine::executors()) {
        if (!row.parallel) continue;
        all.emplace_back(row.name);
        if (row.waiting == engine::Waiting::environment) openmp.emplace_back(row.name);
        if (row.waiting == engine::Waiting::own) own.emplace_back(row.name);
    }
    std::vector<WaitPolicy> policies{{"usual", all, {}, {}}, {"pinned", all, {}, {"--pin"}}};
    for (const char* policy : {"active", "passive"})
        policies.push_back({fmt::format("OMP_WAIT_POLICY={}", policy), openmp, {{"OMP_WAIT_POLICY", policy}}, {}});
    for (const char* count : counts) policies.push_back({fmt::format("{}={}", spin, count), openmp, {{spin, count}}, {}});
    for (const char* wait : {"spin", "passive"}) policies.push_back({fmt::format("--wait {}", wait), own, {}, {"--wait", wait}});
    return policies;
}

std::vector<PolicyResult> measure_policies(const std::vector<std::string>& words, const std::vector<std::string>& names,
                                           const std::function<void(const std::string&)>& progress) {
    const Scratch scratch;
    std::vector<PolicyResult> results;
    for (const WaitPolicy& policy : wait_policies()) {
        const std::vector<std::string> schedules = schedules_of(policy, names);
        if (schedules.empty()) continue;
        progress("wait policy: " + policy.name);
        std::vector<std::string> child = words;
        child.insert(child.end(), policy.options.begin(), policy.options.end());
        child.insert(child.end(), {"--schedules", fmt::format("{}", fmt::join(schedules, ",")), "--csv", scratch.file("csv"), "--json",
                                   scratch.file("json"), "-q"});
        run_child(child, policy.environment, scratch);
        const std::string csv = read_file(scratch.file("csv"));
        results.push_back({policy.name, csv.substr(csv.find('\n') + 1), nlohmann::ordered_json::parse(read_file(scratch.file("json")))});
    }
    return results;
}

namespace {

using Row = std::vector<std::string>;

void add_loads(const nlohmann::ordered_json& schedule, Row& row) {
    for (const auto& load : schedule["loads"]) {
        const bool known = load["rounds"].get<int>() > 0;
        const auto text = [&](double value) { return known ? fmt::format("{:.2f}", value) : std::string("-"); };
        row.insert(row.end(),
                   {text(1e6 * load["step"]["median"].get<double>()), text(load["speed_up"]), text(1e6 * load["burnt"].get<double>())});
    }
}

}  // namespace

std::string policies_text(const std::vector<PolicyResult>& results) {
    if (results.empty()) return {};
    std::vector<Table::Column> columns{{"schedule"}, {"threads", Align::right}, {"segments", Align::right}, {"wait policy"}};
    for (const auto& load : results.front().json["schedules"].front()["loads"]) {
        for (const std::string& heading :
             {fmt::format("{} busy [us]", load["neighbours"].get<int>()), std::string("factor"), std::string("burnt")}) {
            columns.push_back({heading, Align::right});
        }
    }
    std::map<std::tuple<std::string, int, int>, std::vector<Row>> rows;  // by schedule, policies in their order
    for (const PolicyResult& result : results) {
        for (const auto& schedule : result.json["schedules"]) {
            const std::string name = schedule["schedule"];
            const int threads = schedule["threads"], segments = schedule["segments"];
            if (name.starts_with("serial")) continue;
            Row row{name, fmt::format("{}", threads), fmt::format("{}", segments), result.name};
            add_loads(schedule, row);
            rows[{name, threads, segments}].push_back(row);
        }
    }
    Table table(columns);
    for (const auto& [key, list] : rows) {
        for (const Row& row : list) table.add(row);
    }
    return "Wait policies: time per step, factor against serial in the same process under the same load, processor time per step beyond "
           "serial's [us]\n" +
           table.text();
}

}  // namespace cvtflow::bench
