#include "model/observe/pin_halves.hpp"

#include <cstddef>

#include "model/kernels/pins/rolling.hpp"

namespace cvtflow::model {

namespace {

/// What of a pin is where in a state.
struct PinReading {
    const ChainLayout& at;
    const double* state;

    [[nodiscard]] const double* q(int pin) const noexcept { return state + at.link_begin(pin); }
    [[nodiscard]] Plane<double> middle(int pin, int rate) const noexcept {
        const double* from = q(pin) + rate * at.link_size();
        return {from[at.x(End::rear, 0)], from[at.y(End::rear, 0)]};
    }
    [[nodiscard]] PitchLine<double> line(int pin) const noexcept {
        return pitch_line<double>(middle(at.next(pin), 0) - middle(pin, 0), middle(at.next(pin), 1) - middle(pin, 1));
    }
};

void copy_half(const PinReading& from, const Coefficients& c, int pin, End end, const ChainLayout& to, double* link) {
    const Rolling<double> r = rolling<double>(c.joint.diameter, c.joint.arm, from.line(from.at.previous(pin)), from.line(pin));
    const double side = end == End::rear ? -0.5 : 0.5;
    for (int rate = 0; rate < 2; ++rate) {
        const double* source = from.q(pin) + rate * from.at.link_size();
        double* target = link + rate * to.link_size();
        for (int m = 0; m <= to.order; ++m) {
            target[to.x(end, m)] = source[from.at.x(end, m)];
            target[to.y(end, m)] = source[from.at.y(end, m)];
        }
        target[to.z(end)] = source[from.at.z(end)];
        target[to.e(end)] = from.at.rigid ? 0.0 : source[from.at.e(end)];
        if (from.at.rigid) {
            target[to.x(end, 0)] -= c.plate_bow * source[from.at.x(end, 2)];
            target[to.y(end, 0)] -= c.plate_bow * source[from.at.y(end, 2)];
            target[to.z(end)] += side * source[from.at.slide()];
        }
        const Plane<double>& reach = rate == 0 ? r.reach : r.reach_rate;
        target[to.x(end, 0)] += side * reach.x;
        target[to.y(end, 0)] += side * reach.y;
    }
}

}  // namespace

ChainLayout halves_layout(ChainLayout layout) noexcept {
    layout.whole = layout.rigid = false;
    return layout;
}

void halves_of(const Coefficients& coefficients, const double* state, std::vector<double>& halves) {
    const ChainLayout to = halves_layout(coefficients.layout);
    if (!coefficients.layout.whole) return halves.assign(state, state + to.pulley_begin());
    halves.resize(static_cast<std::size_t>(to.pulley_begin()));
    const PinReading from{coefficients.layout, state};
    for (int link = 0; link < to.links; ++link) {
        double* block = halves.data() + to.link_begin(link);
        copy_half(from, coefficients, link, End::rear, to, block);
        copy_half(from, coefficients, to.next(link), End::front, to, block);
    }
}

}  // namespace cvtflow::model
