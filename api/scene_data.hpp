#pragma once
/// What a public scene holds. Internal to api.

#include <cvtflow/scene.hpp>

#include "tasks/scene/scene.hpp"

namespace cvtflow {
inline namespace v0 {

struct Scene::Data {
    tasks::Scene scene;
};

}  // namespace v0
}  // namespace cvtflow
