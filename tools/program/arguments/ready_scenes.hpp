#pragma once
/// The scenes that come with the program, found by name.

#include "tasks/scene/ready_scenes.hpp"

namespace cvtflow::tools {

using tasks::find_scene;
using tasks::ready_scenes;
using tasks::ready_sweeps;
using tasks::ReadyScene;
using tasks::scene_folders;

}  // namespace cvtflow::tools
