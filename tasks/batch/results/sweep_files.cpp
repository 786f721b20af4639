#include "tasks/batch/results/sweep_files.hpp"

#include <stdlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <regex>

#include "engine/record/run/schema.hpp"

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

auto files_named(const char* pattern) {
    return [names = std::regex(pattern)](const fs::path& file) { return std::regex_match(file.filename().string(), names); };
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
    engine::remove_own_files(checkpoints, states_named(R"((case|check)-\d{6,}\.h5(\.part)?)", sweep));
    engine::remove_own_files(continuation, states_named(R"(strand-\d{6,}-[01]\.h5(\.part)?)", sweep));
}

BenchFolder::BenchFolder(const std::string& parent, const Sweep& sweep) : sweep_(sweep) {
    std::error_code reported_later;
    fs::create_directories(parent, reported_later);
    std::string name = (fs::path(parent) / "bench-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw engine::RecordError(name + ": cannot create: " + std::strerror(errno));
    path_ = name;
}

BenchFolder::~BenchFolder() {
    remove_case_files(path_ / "checkpoints", path_ / "continuation", sweep_);
    engine::remove_own_files(path_ / "records", files_named(R"(case-\d{6,}\.h5(\.part|\.before)?)"));
    engine::remove_own_files(path_ / "states", files_named(R"([0-9a-f]{16}\.h5(\.part)?)"));
    engine::remove_own_files(path_, files_named(R"(lock|cases\.h5(\.part)?)"));
}

void BenchFolder::forget_table() const {
    std::error_code absent;
    fs::remove(path_ / "cases.h5", absent);
}

}  // namespace cvtflow::tasks
