/// cvtflow-lab profile: schedules against each other, and one profile per wait policy. OpenMP's runtimes read the policy from the
/// environment when they are loaded, so each policy runs in a child process.

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/executor/further_executors.hpp"
#include "bench/lab/command/command.hpp"
#include "bench/lab/report/profile_report.hpp"
#include "bench/study/profile/report.hpp"
#include "engine/base/provenance.hpp"
#include "engine/executor/catalogue.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

struct WaitPolicy {
    std::string name;
    std::vector<std::string> executors;                            ///< executors that it affects
    std::vector<std::pair<std::string, std::string>> environment;  ///< set in the child; others of these names are unset
    std::vector<std::string> options;                              ///< options of `cvtflow-lab profile`
};

/// Measurements of a child process.
struct PolicyResult {
    std::string name;
    std::string csv_rows;         ///< rows without a heading
    nlohmann::ordered_json json;  ///< whole profile of the child
};

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

/// All of them; the first changes nothing.
std::vector<WaitPolicy> wait_policies() {
#if defined(__clang__)  // LLVM's runtime spins for a time, GNU's for a count
    const char* spin = "KMP_BLOCKTIME";
    const char* counts[] = {"0", "1", "infinite"};
#else
    const char* spin = "GOMP_SPINCOUNT";
    const char* counts[] = {"0", "3000", "infinity"};
#endif
    std::vector<std::string> all, openmp, self_waiting;
    for (const engine::ExecutorRow& row : engine::executors()) {
        if (!row.parallel) continue;
        all.emplace_back(row.name);
        if (row.waiting == engine::Waiting::environment) openmp.emplace_back(row.name);
        if (row.waiting == engine::Waiting::own) self_waiting.emplace_back(row.name);
    }
    std::vector<WaitPolicy> policies{{"usual", all, {}, {}}, {"pinned", all, {}, {"--pin"}}};
    for (const char* policy : {"active", "passive"})
        policies.push_back({fmt::format("OMP_WAIT_POLICY={}", policy), openmp, {{"OMP_WAIT_POLICY", policy}}, {}});
    for (const char* count : counts) policies.push_back({fmt::format("{}={}", spin, count), openmp, {{spin, count}}, {}});
    for (const char* wait : {"spin", "passive"}) policies.push_back({fmt::format("--wait {}", wait), self_waiting, {}, {"--wait", wait}});
    return policies;
}

/// Runs `cvtflow words…` once per policy, with the fused schedules that it concerns.
/// @param words "profile" and the measurement's options, without schedules and files   @param names schedules of the user, of which the
/// policy's are taken; none: all
/// @param progress called with one line before every child
/// @throws std::runtime_error if a child fails, with its message
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

using Row = std::vector<std::string>;

void add_loads(const nlohmann::ordered_json& schedule, Row& row) {
    for (const auto& load : schedule["loads"]) {
        const bool known = load["rounds"].get<int>() > 0;
        const auto text = [&](double value) { return known ? fmt::format("{:.2f}", value) : std::string("-"); };
        row.insert(row.end(),
                   {text(1e6 * load["step"]["median"].get<double>()), text(load["speed_up"]), text(1e6 * load["burnt"].get<double>())});
    }
}

/// Time per step, factor against serial and processor time burnt, under every load: a row per schedule and policy.
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

struct ProfileArguments {
    SceneArguments scene;
    ScheduleChoice choice;
    MeasureOptions measure;
    double round_milliseconds = 60.0;
    std::string csv, json, trace, stages, curves;
    OutputArguments output;
    std::string wait = "balanced";
    bool policies = false;
    bool quiet = false;
};

const std::map<std::string, engine::Wait> waits{
    {"spin", engine::Wait::spin}, {"balanced", engine::Wait::balanced}, {"passive", engine::Wait::passive}};

void write_file(const std::string& path, const std::string& text) {
    if (path.empty()) return;
    std::ofstream file(path, std::ios::binary);
    file << text;
    file.close();
    if (!file) throw std::runtime_error(path + ": cannot write");
}

std::string machine_text(const Profile& result) {
    const engine::Provenance here = engine::current_provenance();
    return field("machine",
                 fmt::format("{}, {}, {} usable", here.cpu, plural(here.cores, "core"), plural(tasks::usable_threads(), "thread"))) +
           field("program", fmt::format("cvtflow {} ({}), {} {}", here.version, here.commit, here.compiler, here.build_type)) +
           field("flags", compiler_flags()) + field("libraries", bench::runtime_versions()) +
           field("load average", fmt::format("{:.2f} before, {:.2f} after", result.load_before, result.load_after)) +
           field(result.crowded() ? "crowded" : "quiet",
                 crowding_text(result) + (result.crowded() ? ": other processes are busy, so comparisons are unreliable" : ""));
}

MeasureOptions options_of(const ProfileArguments& arguments) {
    MeasureOptions options = arguments.measure;
    options.round_seconds = 1e-3 * arguments.round_milliseconds;
    std::vector<int>& loads = options.neighbours;
    loads.push_back(0);
    std::sort(loads.begin(), loads.end());
    loads.erase(std::unique(loads.begin(), loads.end()), loads.end());
    return options;
}

/// Words of this command, without those that the sweep adds itself.
std::vector<std::string> repeated(const ProfileArguments& arguments, const MeasureOptions& options) {
    std::vector<std::string> words{"profile",      arguments.scene.scene,
                                   "--steps",      fmt::format("{}", options.steps),
                                   "--rounds",     fmt::format("{}", options.rounds),
                                   "--round-ms",   fmt::format("{}", arguments.round_milliseconds),
                                   "--neighbours", fmt::format("{}", fmt::join(options.neighbours, ","))};
    const auto add = [&](const std::string& option, const std::string& value) {
        if (!value.empty()) words.insert(words.end(), {option, value});
    };
    for (const std::string& setting : arguments.scene.settings) add("--set", setting);
    for (const Shortcut& shortcut : arguments.scene.shortcuts) add(shortcut.option, shortcut.value.value_or(""));
    add("--detail", arguments.scene.detail);
    add("--threads", fmt::format("{}", fmt::join(arguments.choice.threads, ",")));
    add("--segments", fmt::format("{}", fmt::join(arguments.choice.segments, ",")));
    if (options.steps == 0) words.erase(words.begin() + 2, words.begin() + 4);
    return words;
}

/// Tables, JSON and pictures of -o; @return which were written
std::string write_folder(const ProfileArguments& arguments, const tasks::Scene& scene, const Profile& result, const std::string& csv,
                         const std::string& json) {
    OutputFolder folder(arguments.output);
    folder.write("profile.csv", csv);
    folder.write("stages.csv", profile_stages_csv(scene, result));
    folder.write("profile.json", json);
    folder.write("stages.svg", svg(stages_plot(scene.name, result)));
    folder.write("loads.svg", svg(loads_plot(scene.name, result)));
    if (result.predicts()) {
        folder.write("curves.csv", profile_curves_csv(scene, result));
        folder.write("curves.svg", svg(curves_plot(scene.name, result)));
    }
    return folder.written();
}

/// @return written() of the folder of -o
std::string write_files(const ProfileArguments& arguments, const tasks::Scene& scene, const MeasureOptions& options, const Profile& result,
                        const std::vector<PolicyResult>& policies) {
    std::string rows;
    auto list = nlohmann::ordered_json::array();
    for (const PolicyResult& each : policies) {
        rows += each.csv_rows;
        list.push_back({{"policy", each.name}, {"profile", each.json}});
    }
    const std::string csv = profile_csv(scene, result) + rows;
    auto json = nlohmann::ordered_json::parse(profile_json(scene, options, result));
    json["policies"] = list;
    write_file(arguments.csv, csv);
    write_file(arguments.json, json.dump(2) + "\n");
    if (!arguments.trace.empty()) write_file(arguments.trace, profile_trace(result));
    write_file(arguments.stages, profile_stages_csv(scene, result));
    if (result.predicts()) write_file(arguments.curves, profile_curves_csv(scene, result));
    return write_folder(arguments, scene, result, csv, json.dump(2) + "\n");
}

/// Whether all requested results exist; prints a line for each missing one.
ExitStatus exit_status_of(const ProfileArguments& arguments, const Profile& result) {
    for (const std::string& line : result.differences) print_error(fmt::format("states differ: {}", line));
    const bool refused = !arguments.curves.empty() && !result.predicts();
    if (refused) print_error(fmt::format("{}: not written: no prediction: {}", arguments.curves, no_prediction_text(result)));
    return result.differences.empty() && !refused ? ExitStatus::finished : ExitStatus::error;
}

ExitStatus profile(const ProfileArguments& arguments) {
    const LoadedScene loaded = load_scene(arguments.scene);
    if (!loaded.notice.empty() && !arguments.quiet) print_error(loaded.notice);
    const tasks::Scene& scene = loaded.scene;
    for (const std::string& file : {arguments.csv, arguments.json, arguments.trace, arguments.stages, arguments.curves})
        engine::require_no_input(file, input_files(scene));
    const MeasureOptions options = options_of(arguments);
    ScheduleChoice choice = arguments.choice;
    choice.wait = waits.at(arguments.wait);
    const auto schedules = chosen_schedules(scene, choice);
    const auto progress = [&](const std::string& line) {
        if (!arguments.quiet) print_error(line);
    };
    const Profile result = profile_schedules(scene, schedules, options, progress);
    fmt::print("{}: {}, alternating, medians of {}\n{}", scene.name, plural(static_cast<long>(schedules.size()), "schedule"),
               plural(options.rounds, "round"), machine_text(result));
    for (const std::string& part : {timing_text(result), gains_text(result), neighbours_text(result), stages_text(result),
                                    serial_text(result), model_text(result), predictions_text(result)}) {
        if (!part.empty()) fmt::print("\n{}", part);
    }
    std::vector<PolicyResult> policies;
    if (arguments.policies) {
        policies = measure_policies(repeated(arguments, options), arguments.choice.names, progress);
        fmt::print("\n{}", policies_text(policies));
    }
    fmt::print("{}", write_files(arguments, scene, options, result, policies));
    return exit_status_of(arguments, result);
}

constexpr const char* profile_explanation =
    "Stages are the names of the graph's tasks; a method with further cycles adds its own.\n"
    "All schedules run in one process, in alternating rounds. Speed-ups refer to serial:fused, which is always included.\n"
    "States are compared bitwise after the same steps; a difference is an error (exit status 1).\n"
    "Columns:\n"
    "  evaluation   time per evaluation of the right-hand side, detection and control included [us]\n"
    "  cpu/wall     processor time of the process over wall time\n"
    "  active       threads that ran tasks in the recorded pass\n"
    "  sync         loss of a thread per cycle [us], from a recorded pass apart from the timing:\n"
    "               (waits of the n active threads - (n - 1) x controller) / (n x cycles), that is\n"
    "               (n x (time - controller) - task times) / (n x cycles) without entering and leaving\n"
    "  alone        a cycle of one task of 2 us per thread, above the time of that task [us]; absent: a thread never ran\n"
    "  bare         a bare barrier of as many threads, in turn with `alone` [us]\n"
    "  burnt        processor time per step above that of serial under the same load [us]: spinning threads\n"
    "  min task     METG: task length with an efficiency of 50 %: the loss per level of the graph [us]\n"
    "  imbalance    longest over mean task time of the threads\n"
    "  recording    increase of the step time by recording, in its own pass\n"
    "Speed-ups against serial's turn of the same round are kept apart by the bare barrier just before the turn, near and far.\n"
    "Independent runs, as many serial ones at once as threads, show what the processors give without any synchronisation.\n"
    "Predictions require a quiet machine: calibrations before, during and after (each thread counts arithmetic for 50 ms) and the "
    "schedules\n"
    "must obtain nine tenths of the processors. -o writes profile.csv, stages.csv, curves.csv, profile.json, stages.svg, loads.svg, "
    "curves.svg.\nThe critical path of a cycle is the slowest segment, the controller and the synchronisation a + b M.\n"
    "--policies restarts this program for each wait policy, because OpenMP's runtimes read OMP_WAIT_POLICY, GOMP_SPINCOUNT and\n"
    "KMP_BLOCKTIME when they are loaded; oneTBB has no such setting. Each child compares with serial in its own process. Their rows are\n"
    "appended to the CSV file, their profiles to the JSON file.";

void declare_waits_and_files(CLI::App& app, ProfileArguments& arguments) {
    app.add_option("--wait", arguments.wait, "Wait policy of flow and barrier: spin, balanced or passive")
        ->type_name("POLICY")
        ->check(CLI::IsMember({"spin", "balanced", "passive"}))
        ->capture_default_str();
    app.add_flag("--pin", arguments.choice.pin, "Pin each thread to a processor");
    app.add_flag("--policies", arguments.policies, "Repeat under every wait policy, pinned and not");
    app.add_flag("--predict", arguments.measure.predict_crowded, "Predict on a busy machine, too");
    app.add_option("-o,--output", arguments.output.folder, "Folder for tables, JSON and pictures")->type_name("DIR");
    app.add_option("--csv", arguments.csv, "Table to write, one row per schedule and load")->type_name("FILE");
    app.add_option("--json", arguments.json, "All results as JSON, with provenance")->type_name("FILE");
    app.add_option("--trace", arguments.trace, "Trace of the recorded passes, for chrome://tracing or ui.perfetto.dev")->type_name("FILE");
    app.add_option("--stages", arguments.stages, "Table of stages by thread")->type_name("FILE");
    app.add_option("--curves", arguments.curves, "Table of the speed-up curves")->type_name("FILE");
}

}  // namespace

Action declare_profile(CLI::App& app) {
    const auto arguments = std::make_shared<ProfileArguments>();
    MeasureOptions& measure = arguments->measure;
    declare_scene(app, arguments->scene);
    declare_shortcut(app, arguments->scene, "--method", "run.method", "NAME");
    declare_shortcut(app, arguments->scene, "--step", "run.step", "TIME");
    app.add_option("--schedules", arguments->choice.names,
                   "EXECUTOR[:ASSEMBLY], separated by commas (default: all, fused and staged; staged-serial-cholesky, -transition, -both "
                   "leave parts in one task)")
        ->type_name("LIST")
        ->delimiter(',');
    app.add_option("--threads", arguments->choice.threads, "Numbers of threads (default: all usable)")
        ->type_name("LIST")
        ->delimiter(',')
        ->check(CLI::Range(1, 1024));
    app.add_option("--segments", arguments->choice.segments, "Numbers of segments; 0: as many as threads (default)")
        ->type_name("LIST")
        ->delimiter(',')
        ->check(CLI::NonNegativeNumber);
    app.add_option("--steps", measure.steps, "Steps per round (default: chosen by --round-ms)")
        ->type_name("N")
        ->check(CLI::Range(1L, 10000000L));
    app.add_option("--rounds", measure.rounds, "Timed rounds")->type_name("N")->check(CLI::Range(1, 10000))->capture_default_str();
    app.add_option("--round-ms", arguments->round_milliseconds, "Time per round; schedules with a round over 2 s are dropped")
        ->type_name("MS")
        ->check(CLI::Range(1.0, 2000.0))
        ->capture_default_str();
    app.add_option("--neighbours", measure.neighbours, "Numbers of busy threads of other load, each measured; 0 always is")
        ->type_name("LIST")
        ->delimiter(',')
        ->check(CLI::Range(0, 1024))
        ->default_str("0,1,2");
    declare_waits_and_files(app, *arguments);
    app.add_flag("-q,--quiet", arguments->quiet, "No progress; results are printed all the same");
    app.footer(profile_explanation);
    return [arguments] { return profile(*arguments); };
}

}  // namespace cvtflow::bench
