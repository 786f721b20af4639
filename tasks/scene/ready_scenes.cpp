#include "tasks/scene/ready_scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "engine/base/input_file.hpp"
#include "engine/base/text.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

namespace fs = std::filesystem;

namespace {

/// Folder of the program or shared library that this code is part of, by the list of what is mapped where; empty if unknown. (dladdr knows
/// a program by argv[0] only, and a library by the name under which it was found, which may be relative.)
fs::path own_folder() {
    const auto here = reinterpret_cast<std::uintptr_t>(&own_folder);
    std::ifstream maps("/proc/self/maps");
    for (std::string line; std::getline(maps, line);) {
        std::uintptr_t begin = 0, end = 0;
        int name = 0;  // where it begins
        if (std::sscanf(line.c_str(), "%" SCNxPTR "-%" SCNxPTR " %*s %*s %*s %*s %n", &begin, &end, &name) != 2 || here < begin ||
            here >= end)
            continue;
        std::error_code unknown;
        const fs::path path = fs::canonical(line.substr(static_cast<std::size_t>(name)), unknown);
        return unknown ? fs::path{} : path.parent_path();
    }
    return {};
}

/// First line of a plain file of root or of the program's owner, in a folder in which not everyone may write; empty: another file, or none.
std::string own_note(const fs::path& path, const fs::path& program) {
    std::error_code unknown;
    const auto owner = engine::identity_of(path.string()).owner;
    if (owner != 0 && owner != engine::identity_of(program.string()).owner) return {};
    const fs::perms folder = fs::status(path.parent_path(), unknown).permissions();
    const bool everyones = unknown || (folder & fs::perms::others_write) != fs::perms::none;
    if (everyones || !fs::is_regular_file(fs::symlink_status(path, unknown))) return {};
    try {
        const std::string text = engine::read_text_input(path.string(), 4096);
        return text.substr(0, text.find('\n'));
    } catch (const engine::InputError&) {
        return {};
    }
}

}  // namespace

std::vector<fs::path> scene_folders() {
    std::vector<fs::path> folders{"scenes"};
    if (const char* given = std::getenv("CVTFLOW_SCENES")) {
        std::istringstream list(given);
        for (std::string folder; std::getline(list, folder, ':');) {
            if (!folder.empty()) folders.emplace_back(folder);
        }
    }
    // bin/ or lib/ or lib/ARCHITECTURE/ beside share/
    const fs::path first_folder = own_folder();
    fs::path folder = first_folder;
    for (int level = 0; level < 2 && folder.has_relative_path(); ++level)
        folders.push_back((folder = folder.parent_path()) / "share/cvtflow/scenes");
    // a build folder, up to three levels above
    folder = first_folder;
    for (int level = 0; level < 4 && folder.has_relative_path(); ++level, folder = folder.parent_path()) {
        if (const std::string line = own_note(folder / "cvtflow-scenes.path", first_folder); !line.empty()) folders.emplace_back(line);
    }
    return folders;
}

namespace {

std::vector<ReadyScene> ready_files(const fs::path& below) {
    std::vector<ReadyScene> found;
    const auto take = [&found](const fs::path& path) {
        if (path.extension() == ".toml") found.push_back({path.stem().string(), path});
    };
    for (const engine::EmbeddedFile& file : engine::embedded_files()) take(fs::path(engine::embedded_folder) / file.name);
    const bool reads_files = found.empty();
    for (const fs::path& folder : reads_files ? scene_folders() : std::vector<fs::path>{}) {
        std::error_code unreadable;
        for (const fs::directory_entry& entry : fs::directory_iterator(folder / below, unreadable)) take(entry.path());
    }
    std::stable_sort(found.begin(), found.end(), [](const ReadyScene& a, const ReadyScene& b) { return a.name < b.name; });
    const auto same = [](const ReadyScene& a, const ReadyScene& b) { return a.name == b.name; };
    found.erase(std::unique(found.begin(), found.end(), same), found.end());
    return found;
}

}  // namespace

std::vector<ReadyScene> ready_scenes() { return ready_files({}); }

std::vector<ReadyScene> ready_sweeps() { return ready_files("sweeps"); }

fs::path find_scene(const std::string& argument) {
    std::error_code unreadable;
    if (argument.find('/') != std::string::npos || (fs::exists(argument, unreadable) && !fs::is_directory(argument, unreadable)))
        return argument;
    std::vector<std::string> names;
    for (const ReadyScene& scene : ready_scenes()) {
        if (scene.name == argument) return scene.path;
        names.push_back(scene.name);
    }
    for (const fs::path& folder : scene_folders()) {
        if (fs::is_regular_file(folder / "sweeps" / (argument + ".toml"), unreadable))
            throw SceneError(fmt::format("'{0}' is a ready sweep, not a scene; to run it: cvtflow batch {0}", argument));
    }
    for (const fs::directory_entry& file : fs::directory_iterator(".", unreadable))
        if (file.path().extension() == ".toml") names.push_back(file.path().filename().string());
    const std::string near = engine::closest(argument, names);
    if (near.empty() && argument.ends_with(".toml")) return argument;  // which does not exist
    const std::string hint = near.empty() ? "cvtflow list scenes" : fmt::format("did you mean '{}'?", near);
    throw SceneError(fmt::format("no scene '{}' ({})", argument, hint));
}

Scene read_ready_scene(const std::string& name) {
    return read_scene(find_scene(name), engine::embedded_files().empty() ? StartState::required : StartState::ignored);
}

}  // namespace cvtflow::tasks
