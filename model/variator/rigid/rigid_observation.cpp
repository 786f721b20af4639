#include "model/variator/rigid/rigid_observation.hpp"

#include <algorithm>
#include <cmath>

#include "model/basis/portable_math.hpp"

namespace cvtflow::model {

namespace {

/// Pins of a stepper with cyclic numbers.
class PinView {
public:
    explicit PinView(const RigidStepper& stepper) noexcept : columns_(stepper.columns()), pins_(columns_.pins()) {}

    [[nodiscard]] double operator()(Column c, int pin) const noexcept { return columns_[c][(pin + pins_) % pins_]; }
    /// Normal force of both halves' tips at one end.
    [[nodiscard]] double normal(int pin, int side) const noexcept {
        return (*this)(Column::normal + side, pin) + (*this)(Column::normal + (2 + side), pin);
    }
    [[nodiscard]] bool touches(int pin) const noexcept { return normal(pin, 0) + normal(pin, 1) > 0.0; }
    [[nodiscard]] int pins() const noexcept { return pins_; }

private:
    const RigidColumns& columns_;
    int pins_;
};

/// A strand's inner links: neither they nor their neighbours touch.
void observe_strands(const PinView& pin, RigidObservation& o) noexcept {
    double sum[2] = {0.0, 0.0};
    int count[2] = {0, 0};
    for (int link = 0; link < pin.pins(); ++link) {
        if (pin.touches(link - 1) || pin.touches(link) || pin.touches(link + 1) || pin.touches(link + 2)) continue;
        const int strand = pin(Column::y, link) < 0.0 ? 1 : 0;
        sum[strand] += pin(Column::tension, link);
        ++count[strand];
    }
    o.tight = count[0] > 0 ? sum[0] / count[0] : 0.0;
    o.slack = count[1] > 0 ? sum[1] / count[1] : 0.0;
}

void observe_contacts(const PinView& pin, double middle, RigidObservation& o) noexcept {
    int count[2] = {0, 0};
    for (int k = 0; k < pin.pins(); ++k) {
        for (int tip = 0; tip < rigid_tips; ++tip) o.touching += pin(Column::normal + tip, k) > 0.0 ? 1 : 0;
        o.largest_normal = std::max({o.largest_normal, pin.normal(k, 0), pin.normal(k, 1)});
        if (!pin.touches(k)) continue;
        const std::size_t shaft = pin(Column::x, k) > middle ? 1 : 0;
        const double x = pin(Column::x, k) - (shaft == 1 ? 2.0 * middle : 0.0), y = pin(Column::y, k);
        o.radius[shaft] += portable_hypot(x, y);
        o.pin_speed[shaft] += (x * pin(Column::vy, k) - y * pin(Column::vx, k)) / (x * x + y * y);
        ++count[shaft];
    }
    for (std::size_t shaft = 0; shaft < 2; ++shaft) {
        if (count[shaft] == 0) continue;
        o.radius[shaft] /= count[shaft];
        o.pin_speed[shaft] /= count[shaft];
    }
}

void observe_shafts(const RigidStepper& stepper, RigidObservation& o) noexcept {
    const PulleyModel& pulleys = stepper.model().pulleys();
    const RigidForces& forces = stepper.forces();
    o.torque = {forces.inputs.drive_torque, forces.inputs.load_torque};
    o.clamping = forces.inputs.clamping;
    for (int shaft = 0; shaft < 2; ++shaft) o.speed[static_cast<std::size_t>(shaft)] = pulleys.shaft_speed(stepper.tail(), shaft);
    for (std::size_t sheave = 0; sheave < 4; ++sheave) o.axial_force[sheave] = forces.reaction.sheaves[sheave][4];
    o.ratio = o.speed[0] / o.speed[1];
    const double geared = o.speed[0] * o.pin_speed[1];
    o.slip = geared != 0.0 ? 1.0 - o.pin_speed[0] * o.speed[1] / geared : 0.0;
    const double driven = std::abs(o.axial_force[2]) + std::abs(o.axial_force[3]);
    o.thrust_ratio = driven != 0.0 ? (std::abs(o.axial_force[0]) + std::abs(o.axial_force[1])) / driven : 0.0;
}

}  // namespace

RigidObservation observe(const RigidStepper& stepper) noexcept {
    RigidObservation o;
    o.time = stepper.time();
    const PinView pin(stepper);
    observe_strands(pin, o);
    if (stepper.model().layout().pulley_size == 0) return o;
    observe_contacts(pin, stepper.model().coefficients().middle, o);
    observe_shafts(stepper, o);
    return o;
}

}  // namespace cvtflow::model
