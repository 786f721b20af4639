/// Rows on operating points, contacts and transitions.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "bench/study/extremes/extremes.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

/// Places of shaft 1's movable sheave in the state.
struct Sheave {
    explicit Sheave(const Simulation& simulation, int shaft) {
        const model::ChainLayout& at = simulation.workspace().layout();
        position = static_cast<std::size_t>(at.pulley_begin() + simulation.workspace().variator.pulleys().coordinates().movable(shaft));
        velocity = position + static_cast<std::size_t>(at.pulley_size);
        outwards = shaft == 0 ? 1.0 : -1.0;
    }
    std::size_t position, velocity;
    double outwards;  ///< sign of motion that opens the wedge
};

constexpr std::array both_ends{model::End::rear, model::End::front};

/// Deepest tip between any sheaves for a state.
double deepest(const Simulation& simulation, const std::vector<double>& state) {
    const model::Variator& variator = simulation.workspace().variator;
    const model::ChainLayout& at = variator.layout();
    model::SheaveMotion sheaves[4];
    variator.pulleys().motions(state.data() + at.pulley_begin(), sheaves);
    double most = -1.0;
    for (int link = 0; link < at.links; ++link) {
        model::TipProbe probe;
        model::NeighbourWindow strip;
        variator.chain().probe(strip.of(at, state.data(), link), sheaves, false, probe);
        for (int tip = 0; tip < model::tips_per_link; ++tip) most = std::max(most, static_cast<double>(probe.depth[tip]));
    }
    return most;
}

void move_both(const Simulation& simulation, IntegrationState& start, double distance, double speed) {
    for (int shaft = 0; shaft < 2; ++shaft) {
        const Sheave sheave(simulation, shaft);
        start.state[sheave.position] += sheave.outwards * distance;
        start.state[sheave.velocity] += sheave.outwards * speed;
    }
}

void penetrate(const Simulation& simulation, double, IntegrationState& start) { move_both(simulation, start, -1e-3, 0.0); }
void penetrate_a_little(const Simulation& simulation, double, IntegrationState& start) { move_both(simulation, start, -2e-5, 0.0); }
/// A hundred micrometres within the first step.
void tear_open(const Simulation& simulation, double step, IntegrationState& start) { move_both(simulation, start, 0.0, 1e-4 / step); }
/// Every link moves towards the middle between the shafts.
void compress(const Simulation& simulation, double, IntegrationState& start) {
    const model::ChainLayout& at = simulation.workspace().layout();
    const double middle = 0.5 * simulation.workspace().parameters.pulley.centre_distance;
    for (int link = 0; link < at.links; ++link) {
        double* q = start.state.data() + at.link_begin(link);
        for (const model::End end : both_ends) q[at.link_size() + at.x(end, 0)] -= std::copysign(10.0, q[at.x(end, 0)] - middle);
    }
}
/// The whole chain moves across both pulleys: by a millimetre within 10 us.
void throw_aside(const Simulation& simulation, double, IntegrationState& start) {
    const model::ChainLayout& at = simulation.workspace().layout();
    for (int link = 0; link < at.links; ++link) {
        double* v = start.state.data() + at.link_begin(link) + at.link_size();
        for (const model::End end : both_ends) v[at.y(end, 0)] += 100.0;
    }
}
void open_wide(const Simulation& simulation, double, IntegrationState& start) { move_both(simulation, start, 1e-3, 0.0); }

/// Opens both wedges about their pins: the movable sheaves by `distance`, the links between them by half of it, so that tips on both sides
/// part.
void move_wedges(const Simulation& simulation, IntegrationState& start, double distance, double speed) {
    move_both(simulation, start, distance, speed);
    const model::ChainLayout& at = simulation.workspace().layout();
    const double middle = 0.5 * simulation.workspace().parameters.pulley.centre_distance;
    for (int link = 0; link < at.links; ++link) {
        double* q = start.state.data() + at.link_begin(link);
        const double outwards = Sheave(simulation, q[at.x(model::End::rear, 0)] < middle ? 0 : 1).outwards;
        for (const model::End end : both_ends) {
            q[at.z(end)] += 0.5 * outwards * distance;
            q[at.link_size() + at.z(end)] += 0.5 * outwards * speed;
        }
    }
}

/// The state after a time in which nothing is accelerated.
std::vector<double> drifted(const Simulation& simulation, std::vector<double> state, double time) {
    const model::ChainLayout& at = simulation.workspace().layout();
    const auto drift = [&](int begin, int size) {
        for (int k = begin; k < begin + size; ++k) state[static_cast<std::size_t>(k)] += time * state[static_cast<std::size_t>(k + size)];
    };
    for (int link = 0; link < at.links; ++link) drift(at.link_begin(link), at.link_size());
    drift(at.pulley_begin(), at.pulley_size);
    return state;
}

/// Opens both wedges until the deepest tip of all, after the time `later`, has a depth of zero to the accuracy of doubles.
void open_to_zero(const Simulation& simulation, IntegrationState& start, double later) {
    const std::vector<double> closed = start.state;
    double low = -1e-4, high = 1e-3;  // wider, and links of the strands would meet the sheaves of the other shaft
    for (int halving = 0; halving < 200; ++halving) {
        const double middle = 0.5 * (low + high);
        start.state = closed;
        move_wedges(simulation, start, middle, 0.0);
        (deepest(simulation, drifted(simulation, start.state, later)) > 0.0 ? low : high) = middle;
    }
    std::fill(start.phases.begin(), start.phases.end(), model::Phase::free);
}

/// Closing at one metre per second, the first tip at a gap of exactly zero, or due at the very end of the first step.
void due_at_start(const Simulation& simulation, double, IntegrationState& start) {
    move_wedges(simulation, start, 0.0, -1.0);
    open_to_zero(simulation, start, 0.0);
}
void due_at_end(const Simulation& simulation, double step, IntegrationState& start) {
    move_wedges(simulation, start, 0.0, -1.0);
    open_to_zero(simulation, start, step);
}
/// Ten micrometres in the first step.
void slam(const Simulation& simulation, double step, IntegrationState& start) {
    open_to_zero(simulation, start, 0.0);
    move_wedges(simulation, start, 0.0, -2e-5 / step);
}
void at_rest_on_zero(const Simulation& simulation, double, IntegrationState& start) { open_to_zero(simulation, start, 0.0); }

/// A new row of a group.
class Adder {
public:
    Adder(std::vector<Extreme>& rows, const char* group) : rows_(rows), group_(group) {}
    Extreme& operator()(std::string name, std::vector<std::string> settings, std::vector<Ending> allowed = {Ending::right}) const {
        rows_.push_back({group_, std::move(name), std::move(settings), std::move(allowed)});
        return rows_.back();
    }

private:
    std::vector<Extreme>& rows_;
    const char* group_;
};

}  // namespace

void add_operation_rows(std::vector<Extreme>& rows) {
    const Adder row(rows, "operation");
    row("slack: no clamping", {"clamping.driving=0", "clamping.driven=0"});
    row("compressed: the load drives with 10 times its torque", {"load.torque=-120 N*m"});
    row("strands compressed: both halves of the chain meet at 20 m/s", {}, right_or_fault).prepare = compress;
    rows.back().faults = {FaultKind::penetration, FaultKind::left_sheave};
    rows.back().steps = 400;
    row("10 times the load", {"load.torque=120 N*m"});
    row("gross slip: 1e5 N m stop shaft 2 in 75 us", {"load.torque=1e5 N*m"}).steps = 400;  // 20 us: tips slide at 1 m/s, 100 times v0
    row("jump of the load within one step", {"load.torque=[[0, \"12 N*m\"], [1e-12, \"-1e5 N*m\"]]"});
    row("jump of the clamping within one step", {"clamping.driving=[[0, \"7.7 kN\"], [1e-12, \"1e7 N\"]]"}, right_or_fault).faults = {
        FaultKind::penetration, FaultKind::left_sheave, FaultKind::blow_up};
    row("clamping gone within one step", {"clamping.driving=[[0, \"7.7 kN\"], [1e-12, \"0 N\"]]"});
    row("speed zero", {"drive.speed=0"});
    row("speed zero from the start", {"drive.speed=0", "load.torque=0"}).geometric = true;
    row("reversal within one step", {"drive.speed=[[0, \"2000 rpm\"], [1e-12, \"-2000 rpm\"]]"});
    row("20,000 rpm", {"drive.speed=20000 rpm"}, right_or_fault).geometric = true;
    rows.back().faults = {FaultKind::penetration, FaultKind::left_sheave};
    row("free ring at 20,000 rpm", {"detail.pulleys=absent", "start.layout=ring", "start.ring_speed=20000 rpm"},
        {Ending::right, Ending::refused});
    row("faster than the limit", {"drive.speed=40000 rpm"}, {Ending::refused});
    row("ratio beyond the sheaves", {"start.ratio=5"}, {Ending::refused}).geometric = true;
    row("the chain leaves the sheaves at 100 m/s", {"pulley.innermost=14.5 mm", "pulley.outermost=17.5 mm"}, {Ending::fault}).prepare =
        throw_aside;
    rows.back().faults = {FaultKind::left_sheave};
    rows.back().geometric = true;
    rows.back().steps = 1000;  // 50 us at most
    row("drive by a torque of 1e5 N m", {"drive.mode=torque", "drive.torque=1e5"}, right_or_fault).faults = {FaultKind::penetration,
                                                                                                             FaultKind::left_sheave};
    row("ratio control wound up", {"control.enabled=true", "control.ratio=5", "control.integral=1e12", "control.authority=1e6"},
        right_or_fault)
        .faults = {FaultKind::penetration, FaultKind::left_sheave};
}

void add_contact_rows(std::vector<Extreme>& rows) {
    const Adder row(rows, "contact");
    row("start 1 mm deep in the sheaves", {}, {Ending::fault}).prepare = penetrate;
    rows.back().faults = {FaultKind::penetration, FaultKind::left_sheave};
    row("start 20 um too deep", {}).prepare = penetrate_a_little;
    row("sheaves 1 mm apart", {}).prepare = open_wide;
    row("all tips leave within one step", {}).prepare = tear_open;
    rows.back().min_transitions = 20;
    rows.back().bound = 1e-2;
    row("a chain of 84: over 100 tips meet the sheaves within one step",
        {"chain.pins=84", "pulley.centre_distance=170 mm", "pulley.arc_position=54.44 mm", "pulley.innermost=25 mm",
         "pulley.outermost=80 mm"},
        {Ending::right})
        .prepare = slam;
    rows.back().geometric = true;
    rows.back().min_transitions = 100;
    rows.back().steps = 2;
    rows.back().bound = 1e-2;
    row("a gap of exactly zero, closing", {}).prepare = due_at_start;
    rows.back().min_transitions = 1;
    row("a gap of exactly zero, at rest", {}).prepare = at_rest_on_zero;
    row("due at the very end of a step", {}).prepare = due_at_end;
    rows.back().min_transitions = 1;
}

}  // namespace cvtflow::bench
