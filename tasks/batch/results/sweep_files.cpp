#include "tasks/batch/results/sweep_files.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <regex>
#include <set>
#include <utility>

#include "engine/base/hash.hpp"
#include "engine/base/provenance.hpp"
#include "tasks/run/saved_start.hpp"
#include "tasks/run/simulation.hpp"

namespace cvtflow::tasks {

namespace {

namespace fs = std::filesystem;

/// Whether a file has a name of ours and, if it is not empty, is a state.
auto states_named(const char* pattern, const Sweep& sweep) {
    return [names = std::regex(pattern), inputs = input_files(sweep.scene)](const fs::path& file) {
        std::error_code absent;
        const auto is_input = [&](const fs::path& input) { return !input.empty() && fs::equivalent(file, input, absent) && !absent; };
        if (!std::regex_match(file.filename().string(), names) || std::any_of(inputs.begin(), inputs.end(), is_input)) return false;
        return fs::file_size(file, absent) == 0 || engine::is_state_file(file.string());
    };
}

constexpr const char* remove_by_hand = "move it away, or name another folder";

}  // namespace

engine::Permit permit_table(const std::string& file, const std::string& definition, bool read) {
    const auto own = [file, read, same = engine::table_with("definition", definition)](const std::string& there) {
        return (read && there == file) || same(there);
    };
    return {file, {.what = "table of this sweep", .own = own, .repeats = true, .advice = remove_by_hand}};
}

engine::Permit permit_record(const std::string& file, const Scene& of_case) {
    const auto own = [same = engine::record_with("parameters", write_scene(of_case))](const std::string& there) {
        return engine::is_torn_record(there) || same(there);
    };
    return {file, {.what = "record of this case", .own = own, .inputs = input_files(of_case), .repeats = true, .advice = remove_by_hand}};
}

engine::Permit permit_state(const std::string& file, const Sweep& sweep) {
    return {file, {.what = "state of a sweep", .own = engine::is_state_file, .inputs = input_files(sweep.scene), .advice = remove_by_hand}};
}

void remove_case_files(const fs::path& checkpoints, const fs::path& continuation, const Sweep& sweep) {
    engine::remove_own_files(checkpoints, states_named(R"((case|check|plain)-\d{6,}\.h5(\.part)?)", sweep));
    engine::remove_own_files(continuation, states_named(R"(end-\d{6,}\.h5(\.part)?)", sweep));
}

void remove_ends(const fs::path& continuation, const Sweep& sweep, long strand) {
    const auto is_end = states_named(R"(end-\d{6,}\.h5(\.part)?)", sweep);
    engine::remove_own_files(continuation, [&](const fs::path& file) {
        return is_end(file) && std::stol(file.filename().string().substr(4)) / sweep.strand() == strand;
    });
}

namespace {

/// Attributes of a table, and what they are called in messages.
constexpr std::pair<const char*, const char*> sources[] = {
    {"program", "program"}, {"start_states", "content of start.state"}, {"records", "outputs.records"}};
constexpr std::string_view mixture = "; ";

/// Hash of the start states that cases name: the one of the scene, or those of an axis.
std::string start_states_of(const Sweep& sweep) {
    if (sweep.start != StartMode::scene) return "none";
    std::vector<Scene> scenes;
    for (const Axis& axis : sweep.axes) {
        for (std::size_t key = 0; key < axis.keys.size(); ++key) {
            for (std::size_t row = 0; axis.keys[key]->key == "start.state" && row < axis.rows(); ++row) {
                scenes.push_back(sweep.scene);
                apply(*axis.keys[key], axis.at(row, key), scenes.back());
            }
        }
    }
    if (scenes.empty()) scenes.push_back(sweep.scene);
    engine::Hash hash;
    bool any = false;
    for (const Scene& scene : scenes) {
        if (scene.state_file.empty()) continue;
        hash.add(content_hash(*saved_start(scene)));
        any = true;
    }
    return any ? hash.hex() : "none";
}

}  // namespace

void set_origin(engine::CaseTable& table, const Sweep& sweep) {
    table.set({"program", engine::version_text()});
    table.set({"start_states", start_states_of(sweep)});
    table.set({"records", sweep.records ? "true" : "false"});
}

void set_programs_of_rows(engine::CaseTable& table) {
    const std::size_t program = table.layout.column("program");
    std::set<std::string> programs;
    for (std::size_t row = 0; row < table.size(); ++row) programs.insert(table.layout.text(table.row(row), program));
    if (!programs.empty()) table.set({"program", fmt::format("{}", fmt::join(programs, mixture))});
}

void require_same_origin(const std::string& path, engine::CaseTable& there, const engine::CaseTable& here, bool mixed) {
    std::vector<std::string> differences;
    for (const auto& [attribute, name] : sources) {
        const std::string was = there.attribute(attribute), is = here.attribute(attribute);
        if (was == is) continue;
        differences.push_back(fmt::format("{} {} there, {} here", name, was, is));
        if (was.find(is) == std::string::npos) there.set({attribute, fmt::format("{}{}{}", was, mixture, is)});
    }
    if (differences.empty() || mixed) return;
    throw SimulationError(
        fmt::format("{}: {}; use another folder, or mix them knowingly with --mixed", path, fmt::join(differences, "; ")));
}

}  // namespace cvtflow::tasks
