#include "tasks/study/detail_state.hpp"

#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "model/parameters/chain_layout.hpp"

namespace cvtflow::tasks {

namespace {

using model::ChainLayout;
using model::End;

/// One link's coordinates or velocities.
void copy_link(const ChainLayout& from, const double* source, const ChainLayout& to, double* target) {
    for (const End end : {End::rear, End::front}) {
        for (int m = 0; m <= std::min(from.order, to.order); ++m) {
            target[to.x(end, m)] = source[from.x(end, m)];
            target[to.y(end, m)] = source[from.y(end, m)];
        }
        target[to.z(end)] = source[from.z(end)];
        target[to.e(end)] = source[from.e(end)];
    }
}

constexpr int axial = 4, turn = 5;  // freedoms of a body
/// Movable sheaves: 1+ and 2-.
constexpr int movable(int shaft) { return model::sheave_body(shaft, shaft == 0 ? 1 : 0); }

/// The pulleys' coordinates or velocities.
void copy_pulleys(const ChainLayout& from, const double* source, const ChainLayout& to, double* target) {
    using model::body_freedom;
    if (from.pulley_size == to.pulley_size) {
        std::copy(source, source + from.pulley_size, target);
    } else if (from.pulley_size == 36 && to.pulley_size == 4) {
        for (int shaft = 0; shaft < 2; ++shaft) {
            target[shaft] = source[body_freedom(shaft, turn)];
            target[2 + shaft] = source[body_freedom(movable(shaft), axial)] - source[body_freedom(shaft, axial)];
        }
    } else if (from.pulley_size == 4 && to.pulley_size == 36) {
        for (int shaft = 0; shaft < 2; ++shaft) {
            for (const int body : {shaft, model::sheave_body(shaft, 0), model::sheave_body(shaft, 1)})
                target[body_freedom(body, turn)] = source[shaft];
            target[body_freedom(movable(shaft), axial)] = source[2 + shaft];
        }
    }
}

}  // namespace

engine::SavedState brought_over(const engine::SavedState& saved, const model::Parameters& from, const model::Parameters& to) {
    const ChainLayout before = model::layout_of(from), after = model::layout_of(to);
    engine::SavedState result;
    result.time = saved.time;
    result.phases = saved.phases;
    result.state.assign(static_cast<std::size_t>(after.control_begin()), 0.0);
    const double* source = saved.state.data();
    double* target = result.state.data();
    for (const bool velocity : {false, true}) {
        for (int link = 0; link < before.links; ++link) {
            copy_link(before, source + before.link_begin(link) + velocity * before.link_size(), after,
                      target + after.link_begin(link) + velocity * after.link_size());
        }
        copy_pulleys(before, source + before.pulley_begin() + velocity * before.pulley_size, after,
                     target + after.pulley_begin() + velocity * after.pulley_size);
    }
    return result;
}

void turn_shaft(engine::SavedState& state, const model::Parameters& parameters, int shaft, double angle) {
    const ChainLayout at = model::layout_of(parameters);
    double* coordinates = state.state.data() + at.pulley_begin();
    if (at.pulley_size == 4) coordinates[shaft] += angle;
    if (at.pulley_size != 36) return;
    for (const int body : {shaft, model::sheave_body(shaft, 0), model::sheave_body(shaft, 1)})
        coordinates[model::body_freedom(body, turn)] += angle;
}

StateFile::StateFile(const engine::SavedState& state)
    : path_((std::filesystem::temp_directory_path() / ("cvtflow_detail_" + std::to_string(getpid()) + ".h5")).string()) {
    engine::write_state(path_, state);
}

StateFile::~StateFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
}

}  // namespace cvtflow::tasks
