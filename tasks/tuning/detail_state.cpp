#include "tasks/tuning/dial.hpp"

#include <algorithm>

#include "model/force/pulley_inputs.hpp"
#include "model/machine/coefficients.hpp"
#include "model/observe/chain_forces.hpp"

namespace cvtflow::tasks {

namespace {

using model::ChainLayout;
using model::End;

/// A half's coordinates or velocities. weight: share of them that is added to the target, as many as both have.
void add_half(const ChainLayout& from, const double* source, const ChainLayout& to, double* target, End end, double weight) {
    for (int m = 0; m < std::min(from.lateral(), to.lateral()); ++m) {
        target[to.x(end, m)] += weight * source[from.x(end, m)];
        target[to.y(end, m)] += weight * source[from.y(end, m)];
    }
    target[to.z(end)] += weight * source[from.z(end)];
    if (to.rigid)
        target[to.e(End::rear)] += (end == End::front ? 1.0 : -1.0) * source[from.z(end)];
    else
        target[to.e(end)] += weight * source[from.e(end)];
}

/// Links between halves (from) to links, or to the pins in the middle between their two halves.
void copy_links(const ChainLayout& from, const double* source, const ChainLayout& to, double* target) {
    const double weight = to.rigid ? 0.5 : 1.0;
    for (int rate = 0; rate < 2; ++rate) {
        for (int link = 0; link < from.links; ++link) {
            const double* halves = source + from.link_begin(link) + rate * from.link_size();
            const auto block = [&](int number) { return target + to.link_begin(number) + rate * to.link_size(); };
            add_half(from, halves, to, block(link), End::rear, weight);
            add_half(from, halves, to, block(to.rigid ? to.next(link) : link), End::front, weight);
        }
    }
}

/// x_0 and y_0 of rigid pins are means over their plates.
void refer_to_plates(const ChainLayout& at, double plate_bow, double* state) {
    for (int pin = 0; pin < at.links; ++pin) {
        for (int rate = 0; rate < 2; ++rate) {
            double* q = state + at.link_begin(pin) + rate * at.link_size();
            q[at.x(End::rear, 0)] += plate_bow * q[at.x(End::rear, 2)];
            q[at.y(End::rear, 0)] += plate_bow * q[at.y(End::rear, 2)];
        }
    }
}

/// The pulleys' coordinates or velocities.
void copy_pulleys(const ChainLayout& from, const double* source, const ChainLayout& to, double* target) {
    using At = model::PulleyCoordinates;
    using model::body_freedom;
    if (from.pulley_size == to.pulley_size) {
        std::copy(source, source + from.pulley_size, target);
    } else if (from.pulley_size == 36 && to.pulley_size == 4) {
        for (int shaft = 0; shaft < 2; ++shaft) {
            target[shaft] = source[body_freedom(shaft, At::turn)];
            target[2 + shaft] = source[body_freedom(model::movable_body(shaft), At::axial)] - source[body_freedom(shaft, At::axial)];
        }
    } else if (from.pulley_size == 4 && to.pulley_size == 36) {
        for (int shaft = 0; shaft < 2; ++shaft) {
            for (const int body : {shaft, model::sheave_body(shaft, 0), model::sheave_body(shaft, 1)})
                target[body_freedom(body, At::turn)] = source[shaft];
            target[body_freedom(model::movable_body(shaft), At::axial)] = source[2 + shaft];
        }
    }
}

}  // namespace

engine::SavedState convert_state(const engine::SavedState& saved, const model::Parameters& from, const model::Parameters& to) {
    const ChainLayout before = model::layout_of(from), after = model::layout_of(to);
    engine::SavedState result;
    result.time = saved.time;
    result.phases = saved.phases;
    result.state.assign(static_cast<std::size_t>(after.control_begin()), 0.0);
    std::vector<double> halves;
    if (before.rigid) model::halves_of(model::Coefficients(from), saved.state.data(), halves);
    const double* links = before.rigid ? halves.data() : saved.state.data();
    copy_links(model::halves_layout(before), links, after, result.state.data());
    if (after.rigid) refer_to_plates(after, model::Coefficients(to).plate_bow, result.state.data());
    for (const bool velocity : {false, true}) {
        copy_pulleys(before, saved.state.data() + before.pulley_begin() + velocity * before.pulley_size, after,
                     result.state.data() + after.pulley_begin() + velocity * after.pulley_size);
    }
    return result;
}

}  // namespace cvtflow::tasks
