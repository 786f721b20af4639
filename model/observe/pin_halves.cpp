#include "model/observe/pin_halves.hpp"

#include <cmath>
#include <cstddef>

#include "model/start/belt.hpp"

namespace cvtflow::model {

namespace {

/// Line from a pin's middle to that of the next one.
struct PitchLine {
    Point along;     ///< t
    double turning;  ///< θ' [rad/s]
};

/// From the rear half R to the front half L of the link before. (model/EQUATIONS.md section 10)
struct Reach {
    Point offset, rate;  ///< u [m], [m/s]
};

/// Halves roll on each other, so that their distance is a function of the angle between the links.
/// @param diameter 2ρ, arm c_a [m]
[[nodiscard]] Reach rolling(double diameter, double arm, const PitchLine& before, const PitchLine& after) noexcept {
    const Point s = before.along + after.along;
    const double inverse = 1.0 / std::sqrt(s.x * s.x + s.y * s.y);
    const Point b = inverse * s;
    const double wide = diameter * inverse, stretch = wide - arm;
    const double xx = stretch - wide * b.x * b.x, xy = -(wide * b.x * b.y), yy = stretch - wide * b.y * b.y;  // ∂u/∂s
    const Point rate{-(before.turning * before.along.y + after.turning * after.along.y),
                     before.turning * before.along.x + after.turning * after.along.x};
    return {stretch * s, {xx * rate.x + xy * rate.y, xy * rate.x + yy * rate.y}};
}

/// Reads the coordinates of a pin in a state.
struct PinReading {
    const ChainLayout& at;
    const double* state;

    [[nodiscard]] const double* q(int pin) const noexcept { return state + at.link_begin(pin); }
    [[nodiscard]] Point middle(int pin, int rate) const noexcept {
        const double* from = q(pin) + rate * at.link_size();
        return {from[at.x(End::rear, 0)], from[at.y(End::rear, 0)]};
    }
    [[nodiscard]] PitchLine line(int pin) const noexcept {
        const Point step = middle(at.next(pin), 0) - middle(pin, 0), rate = middle(at.next(pin), 1) - middle(pin, 1);
        const double inverse = 1.0 / std::sqrt(step.x * step.x + step.y * step.y);
        const Point t = inverse * step;
        return {t, (t.x * rate.y - t.y * rate.x) * inverse};
    }
};

void copy_half(const PinReading& from, const Coefficients& c, int pin, End end, const ChainLayout& to, double* link) {
    const Reach r = rolling(c.joint.diameter, c.joint.arm, from.line(from.at.previous(pin)), from.line(pin));
    const double side = end == End::rear ? -0.5 : 0.5;
    for (int rate = 0; rate < 2; ++rate) {
        const double* source = from.q(pin) + rate * from.at.link_size();
        double* target = link + rate * to.link_size();
        for (int m = 0; m <= to.order; ++m) {
            target[to.x(end, m)] = source[from.at.x(end, m)];
            target[to.y(end, m)] = source[from.at.y(end, m)];
        }
        target[to.z(end)] = source[from.at.z(end)] + side * source[from.at.slide()];
        target[to.e(end)] = 0.0;
        const Point reach = rate == 0 ? r.offset : r.rate;
        target[to.x(end, 0)] = target[to.x(end, 0)] - c.plate_bow * source[from.at.x(end, 2)] + side * reach.x;
        target[to.y(end, 0)] = target[to.y(end, 0)] - c.plate_bow * source[from.at.y(end, 2)] + side * reach.y;
    }
}

}  // namespace

ChainLayout halves_layout(ChainLayout layout) noexcept {
    layout.rigid = false;
    return layout;
}

void halves_of(const Coefficients& coefficients, const double* state, std::vector<double>& halves) {
    const ChainLayout to = halves_layout(coefficients.layout);
    if (!coefficients.layout.rigid) return halves.assign(state, state + to.pulley_begin());
    halves.resize(static_cast<std::size_t>(to.pulley_begin()));
    const PinReading from{coefficients.layout, state};
    for (int link = 0; link < to.links; ++link) {
        double* block = halves.data() + to.link_begin(link);
        copy_half(from, coefficients, link, End::rear, to, block);
        copy_half(from, coefficients, to.next(link), End::front, to, block);
    }
}

}  // namespace cvtflow::model
