#include "tasks/batch/results/sweep_files.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <regex>

#include "engine/record/run/run_reader.hpp"
#include "engine/record/run/state_file.hpp"

namespace cvtflow::tasks {

namespace {

namespace fs = std::filesystem;

/// Whether a file has a name of ours and is a state.
auto states_named(const char* pattern, const Sweep& sweep) {
    return [names = std::regex(pattern), inputs = input_files(sweep.scene)](const fs::path& file) {
        std::error_code absent;
        const auto is_input = [&](const fs::path& input) { return !input.empty() && fs::equivalent(file, input, absent) && !absent; };
        if (!std::regex_match(file.filename().string(), names) || std::any_of(inputs.begin(), inputs.end(), is_input)) return false;
        return engine::is_state_file(file.string());
    };
}

}  // namespace

std::string case_file(const fs::path& folder, std::string_view kind, long number) {
    return (folder / fmt::format("{}-{:06}.{}", kind, number, kind == "end" ? "state" : "h5")).string();
}

engine::OutputFile case_record(const std::string& file, const Scene& of_case) {
    engine::require_no_input(file, input_files(of_case));
    const auto own = [scene = write_scene(of_case)](const std::string& there) {
        return engine::is_torn_record(there) || engine::is_record_with(there, "parameters", scene, there.ends_with(".part"));
    };
    return {file, own, remove_by_hand};
}

void remove_ends(const fs::path& continuation, const Sweep& sweep, long strand) {
    const auto is_end = states_named(R"(end-\d{6,}\.state(\.part)?)", sweep);
    std::error_code ignored;
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(continuation, ignored)) {
        const fs::path& file = entry.path();
        if (fs::is_regular_file(entry.symlink_status(ignored)) && is_end(file) &&
            (strand < 0 || std::stol(file.filename().string().substr(4)) / sweep.strand() == strand))
            files.push_back(file);
    }
    for (const fs::path& file : files) fs::remove(file, ignored);
    fs::remove(continuation, ignored);  // only if it is empty
}

}  // namespace cvtflow::tasks
