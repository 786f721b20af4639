#pragma once
/// Contents of a public scene. Internal to api.

#include <cvtflow/scene.hpp>

#include "tasks/scene/scene.hpp"

namespace cvtflow {
inline namespace v0 {

struct Scene::Data {
    tasks::Scene scene;
};

}  // namespace v0
}  // namespace cvtflow
