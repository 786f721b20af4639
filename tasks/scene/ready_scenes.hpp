#pragma once
/// The scenes that come with the program, found by name.

#include <filesystem>
#include <string>
#include <vector>

namespace cvtflow::tasks {

struct Scene;

struct ReadyScene {
    std::string name;  ///< the file's stem
    std::filesystem::path path;
};

/// Folders that may hold scenes, nearest first: ./scenes, those of the environment variable CVTFLOW_SCENES (separated by ':'),
/// share/cvtflow/scenes of the installation that this program or library belongs to (wherever it was moved), the source tree that it was
/// built from.
[[nodiscard]] std::vector<std::filesystem::path> scene_folders();

/// All scenes in these folders, by name. If several have one name, only the nearest one. In the core library, which reads no files, the
/// scenes that are embedded in it.
[[nodiscard]] std::vector<ReadyScene> ready_scenes();

/// All sweeps in the subfolder "sweeps" of these folders, likewise.
[[nodiscard]] std::vector<ReadyScene> ready_sweeps();

/// A file of that path, else the ready scene of that name. A path (with '/' or the ending .toml) is returned unchanged.
/// @throws SceneError  `no scene 'basline' (did you mean 'baseline'?)`
[[nodiscard]] std::filesystem::path find_scene(const std::string& argument);

/// Reads what find_scene finds. In the core library it begins from the geometric start, since saved states are files. @throws SceneError
[[nodiscard]] Scene read_ready_scene(const std::string& name);

}  // namespace cvtflow::tasks
