/// Whole pins: halves that roll on each other as a constraint, by virtual work (EQUATIONS.md, section 10).

#include "tests/oracle/friction.hpp"
#include "tests/oracle/system.hpp"

#include <algorithm>

namespace cvtflow::oracle {

using model::End;

namespace {

Real arc_offset(const model::Parameters& parameters) { return parameters.joint.radius - Real{parameters.half.width} / 2.0L; }

const PitchLine& line_before(const System& system, int pin) { return system.lines[system.layout.previous(pin)]; }

/// Distance u from the rear to the front half and its rate: the arc centres are 2ρ apart along the bisector b, u = 2ρ b - c_a (t₋ + t₊).
Vec2 reach(const System& system, int pin) {
    const PitchLine &before = line_before(system, pin), &after = system.lines[pin];
    return (2.0L * system.parameters.joint.radius) * system.pins[pin].t - arc_offset(system.parameters) * (before.t + after.t);
}
Vec2 reach_rate(const System& system, int pin) {
    const PitchLine &before = line_before(system, pin), &after = system.lines[pin];
    return (2.0L * system.parameters.joint.radius * system.pins[pin].turning) * system.pins[pin].n -
           arc_offset(system.parameters) * (before.turning * before.n + after.turning * after.n);
}

Half shifted(Half half, Vec2 by, Vec2 rate) {
    half.shape[0] += by;
    half.shape_rate[0] += rate;
    return half;
}

PitchLine line_from(const Half& here, const Half& next) {
    const Vec2 d = next.shape[0] - here.shape[0];
    PitchLine line{unit(d), left_of(unit(d)), norm(d), 0.0L};
    line.turning = dot(line.n, next.shape_rate[0] - here.shape_rate[0]) / line.length;
    return line;
}

/// Half of what the halves of a pin are pulled apart with: f_L less f_R, over two.
Vec2 pulled_apart(const System& system, const Totals& totals, int pin) {
    return 0.5L * (totals.link[system.layout.previous(pin)].front.shape[0] - totals.link[pin].rear.shape[0]);
}

/// The moment that a pin's tips have on its bisector, written as a couple of arm 1 by LinkForce::turn.
Real moment_on(const System& system, const Totals& totals, int pin) { return dot(totals.pin[pin].front.shape[0], system.pins[pin].n); }

}  // namespace

void unpack_whole_pins(System& system, std::span<const Real> state) {
    const auto& layout = system.layout;
    for (int i = 0; i < layout.links; ++i) {
        Link pin;
        pin.rear = pin.front = unpack_half(system.parameters, layout, End::rear, state.subspan(layout.link_begin(i), layout.link_block()));
        pin.length = 1.0L;
        system.pins.push_back(pin);
    }
    for (int i = 0; i < layout.links; ++i) system.lines.push_back(line_from(system.pins[i].rear, system.pins[layout.next(i)].rear));
    for (int i = 0; i < layout.links; ++i) {
        Link& pin = system.pins[i];
        pin.t = unit(line_before(system, i).t + system.lines[i].t);
        pin.n = left_of(pin.t);
        pin.o = -pin.n;
        pin.turning = 0.5L * (line_before(system, i).turning + system.lines[i].turning);
    }
    const auto& pitch = system.parameters.chain.pitch;
    for (int i = 0; i < layout.links; ++i) {
        const int next = layout.next(i);
        Link link;
        link.rear = shifted(system.pins[i].rear, -0.5L * reach(system, i), -0.5L * reach_rate(system, i));
        link.front = shifted(system.pins[next].rear, 0.5L * reach(system, next), 0.5L * reach_rate(system, next));
        make_frame(link);
        link.rest_length = Real{pitch[static_cast<std::size_t>(i) % pitch.size()]} + Real{system.parameters.half.width};
        system.links.push_back(link);
    }
}

void add_rolling(const System& system, Totals& totals) {
    const auto& joint = system.parameters.joint;
    for (int i = 0; i < system.layout.links; ++i) {
        const Real normal = std::max(0.0L, -dot(pulled_apart(system, totals, i), system.pins[i].t));
        const Real arm = 0.11L * std::sqrt(joint.radius * normal / joint.stiffness);
        const Real sliding = arm * (system.lines[i].turning - line_before(system, i).turning);
        const Real force =
            joint.friction.coefficient * normal * friction_slope(system.parameters.detail, joint.friction, std::abs(sliding)) * sliding;
        totals.rolling[i] = -arm * force;
        totals.loss(model::Loss::joint_friction) += force * sliding;
    }
}

std::vector<Real> pack_whole_pins(const System& system, const Totals& totals) {
    const auto& layout = system.layout;
    std::vector<Vec2> couple;  // on the pin at the end of each line
    for (int i = 0; i < layout.links; ++i) {
        const PitchLine& line = system.lines[i];
        Real moment = totals.rolling[i] - totals.rolling[layout.next(i)];
        for (const int pin : {i, layout.next(i)}) {
            const Vec2 g = pulled_apart(system, totals, pin);
            moment += system.parameters.joint.radius * dot(g, system.pins[pin].n) - arc_offset(system.parameters) * dot(g, line.n) +
                      0.5L * moment_on(system, totals, pin);
        }
        couple.push_back((moment / line.length) * line.n);
    }
    std::vector<Real> forces(static_cast<std::size_t>(layout.links * layout.link_size()), 0.0L);
    for (int i = 0; i < layout.links; ++i) {
        const int begin = i * layout.link_size(), before = layout.previous(i);
        const auto add = [&](const HalfForce& f) {
            for (int m = 0; m <= layout.order; ++m) {
                forces[begin + layout.x(End::rear, m)] += f.shape[m].x;
                forces[begin + layout.y(End::rear, m)] += f.shape[m].y;
            }
            forces[begin + layout.z(End::rear)] += f.z;
            forces[begin + layout.e(End::rear)] += f.e;
        };
        add(totals.link[before].front);
        add(totals.link[i].rear);
        add(totals.pin[i].rear);
        add(totals.pin[i].front);
        const Vec2 turned = couple[before] - couple[i];
        forces[begin + layout.x(End::rear, 0)] += turned.x;
        forces[begin + layout.y(End::rear, 0)] += turned.y;
    }
    return forces;
}

}  // namespace cvtflow::oracle
