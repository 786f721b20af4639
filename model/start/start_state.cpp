#include "model/start/start_state.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>

#include "model/basis/portable_math.hpp"
#include "model/force/pulley.hpp"
#include "model/variator/variator.hpp"

namespace cvtflow::model {

double link_mass(const Parameters& p) noexcept { return 2.0 * p.half.mass + p.plate.count * p.plate.mass; }

namespace {

/// Calls put(link block, end, pin) for every half, or for every rigid pin.
template <class Put>
void for_every_half(const ChainLayout& at, std::vector<double>& state, const Put& put) {
    for (int link = 0; link < at.links; ++link) {
        double* block = state.data() + at.link_begin(link);
        put(block, End::rear, static_cast<std::size_t>(link));
        if (at.rigid) continue;
        put(block, End::front, static_cast<std::size_t>(at.next(link)));
    }
}

/// Place of a half, or of a rigid pin in the middle between both.
[[nodiscard]] Point place_of(const ChainLayout& at, const PlacedChain& chain, End end, std::size_t pin) {
    if (at.rigid) return 0.5 * (chain.front[pin] + chain.rear[pin]);
    return (end == End::rear ? chain.rear : chain.front)[pin];
}

void fill_positions(const ChainLayout& at, const PlacedChain& now, std::vector<double>& state) {
    for_every_half(at, state, [&](double* block, End end, std::size_t pin) {
        const Point here = place_of(at, now, end, pin);
        block[at.x(end, 0)] = here.x;
        block[at.y(end, 0)] = here.y;
    });
}

/// Pins of unequal length start without axial force.
void fill_lengths(const Parameters& p, const ChainLayout& at, std::vector<double>& state) {
    const std::vector<double> longer = longer_halves(p);
    if (at.rigid || longer.empty()) return;
    for_every_half(at, state, [&](double* block, End end, std::size_t pin) { block[at.e(end)] = longer[pin]; });
}

/// Velocities as differences of two placements; axially the strands climb by `rise`.
void fill_velocities(const ChainLayout& at, const PlacedChain& before, const PlacedChain& after, double rate, double rise,
                     std::vector<double>& state) {
    for_every_half(at, state, [&](double* block, End end, std::size_t pin) {
        const Point moved = place_of(at, after, end, pin) - place_of(at, before, end, pin);
        double* v = block + at.link_size();
        v[at.x(end, 0)] = rate * moved.x;
        v[at.y(end, 0)] = rate * moved.y;
        v[at.z(end)] = rate * rise * (after.along[pin] - before.along[pin]);
    });
}

/// Moves the arcs axially onto the fixed sheaves and the movable sheaves onto the arcs, until the deepest tip just touches.
class SheaveFitter {
public:
    SheaveFitter(const Parameters& p, std::vector<double>& state, const std::vector<double>& along)
        : model_(make_chain(p)),
          pulleys_(p),
          state_(state),
          along_(along),
          blocks_(static_cast<std::size_t>((model_.layout().links + 2 * model_.layout().halo()) * model_.layout().link_block())),
          probes_(static_cast<std::size_t>(model_.layout().links)) {}

    /// Axial distance from the driving to the driven arc [m].
    double fit() {
        for (int iteration = 0; iteration < 30; ++iteration) {
            probe();
            for (int shaft = 0; shaft < 2; ++shaft) shift_[shaft] -= fixed_sign(shaft) * deepest(shaft, shaft == 0 ? 0 : 1);
            place_axially();
        }
        for (int iteration = 0; iteration < 30; ++iteration) {
            probe();
            for (int shaft = 0; shaft < 2; ++shaft) {
                const double overlap = deepest(shaft, shaft == 0 ? 1 : 0);
                state_[static_cast<std::size_t>(model_.layout().pulley_begin() + pulleys_.coordinates().movable(shaft))] -=
                    fixed_sign(shaft) * overlap;
            }
        }
        return shift_[1] - shift_[0];
    }

private:
    [[nodiscard]] static double fixed_sign(int shaft) { return shaft == 0 ? -1.0 : 1.0; }

    void place_axially() {
        const ChainLayout& at = model_.layout();
        for_every_half(at, state_, [&](double* block, End end, std::size_t pin) {
            block[at.z(end)] = shift_[0] + along_[pin] * (shift_[1] - shift_[0]);
        });
    }

    /// Depths of all tips.
    void probe() {
        const ChainLayout& at = model_.layout();
        SheaveMotion sheaves[4];
        pulleys_.motions(state_.data() + at.pulley_begin(), sheaves);
        for (int place = 0; place < at.links + 2 * at.halo(); ++place)
            std::copy_n(state_.data() + at.link_begin(at.wrapped(place - at.halo())), at.link_block(),
                        blocks_.data() + place * at.link_block());
        model_.probe_links(blocks_.data() + at.halo() * at.link_block(), at.links, sheaves, false, probes_.data());
    }

    /// Largest of the depths on one side of one shaft.
    [[nodiscard]] double deepest(int shaft, int side) const {
        double depth = -1.0;
        for (int link = 0; link < model_.layout().links; ++link) {
            if (model_.shaft_of(state_.data() + model_.layout().link_begin(link)) != shaft) continue;
            const TipProbe& probe = probes_[static_cast<std::size_t>(link)];
            depth = std::max({depth, probe.depth[side], probe.depth[2 + side]});
        }
        return depth;
    }

    ChainModel model_;
    PulleyModel pulleys_;
    std::vector<double>& state_;
    const std::vector<double>& along_;
    std::vector<double> blocks_;    ///< blocks of all links, with their neighbours around the ring
    std::vector<TipProbe> probes_;  ///< [links]
    double shift_[2] = {0.0, 0.0};
};

/// Mean angular speed, per path speed, of the pins on the driving (along = 0) or the driven arc (along = 1) [1/m]. A bent chain is shorter
/// than its path, so pins turn a little slower than path speed over radius.
[[nodiscard]] double turning_of_arc(const PlacedChain& before, const PlacedChain& now, const PlacedChain& after, double step, double along,
                                    Point axis) {
    double sum = 0.0;
    int count = 0;
    for (std::size_t pin = 0; pin < now.along.size(); ++pin) {
        if (before.along[pin] != along || after.along[pin] != along) continue;
        const auto middle = [pin](const PlacedChain& chain) { return 0.5 * (chain.front[pin] + chain.rear[pin]); };
        const Point arm = middle(now) - axis;
        const Point moved = middle(after) - middle(before);
        sum += (arm.x * moved.y - arm.y * moved.x) / (2.0 * step * (arm.x * arm.x + arm.y * arm.y));
        ++count;
    }
    return sum / std::max(1, count);
}

void spin_shafts(const Parameters& p, const ChainLayout& at, const double* turning, std::vector<double>& state) {
    const PulleyModel pulleys(p);
    double* q = state.data() + at.pulley_begin();
    const auto turn = [&](int coordinate, double rate) {
        q[at.pulley_size + coordinate] = rate;
        q[coordinate] = -rate * p.start.settling_time;  // angles count from t = 0
    };
    for (int shaft = 0; shaft < 2; ++shaft) {
        const double rate = turning[shaft];
        turn(pulleys.coordinates().rotation(shaft), rate);
        if (at.pulley_size != 36) continue;
        for (int side = 0; side < 2; ++side) turn(body_freedom(sheave_body(shaft, side), 5), rate);
    }
}

/// Path, pre-tension and speed of a scene.
struct StartPlan {
    BeltRadii radii;  ///< nominal, of a belt as long as the sum of pitches
    PathOf path_of;
    double turning;     ///< speed of the driving shaft or the ring [rad/s]
    double pretension;  ///< σ v²: centrifugal pull of the chain [N]
    double mean_pitch;  ///< [m]
};

[[nodiscard]] StartPlan plan_start(const Parameters& p) {
    const double a = p.pulley.centre_distance;
    const double ratio = p.start.ratio;
    const double length = chain_length(p.chain);
    const bool ring = p.start.layout == StartLayout::ring;
    StartPlan plan;
    plan.mean_pitch = length / p.chain.pins;
    if (ring) {
        plan.radii = {length / (2.0 * std::numbers::pi), length / (2.0 * std::numbers::pi)};
        plan.path_of = [](double r) { return PitchPath(r); };
        plan.turning = p.start.ring_speed;
    } else {
        const auto radii = belt_radii(length, ratio, a);
        if (!radii) throw std::invalid_argument("start: the chain does not close around the pulleys at start.ratio");
        plan.radii = *radii;
        plan.path_of = [=](double r) { return PitchPath(BeltRadii{r, ratio * r}, a); };
        plan.turning = p.drive.mode != DriveMode::torque ? p.drive.speed.at(0.0) : p.control.reference_speed;
    }
    const double speed = plan.radii.driving * plan.turning;
    plan.pretension = link_mass(p) / plan.mean_pitch * speed * speed;
    // Tension grows with the radius, P = P0 (1 + ε) for a stretch of ε pitches, and Hooke's law gives P = K p ε: none fits where P0 ≥ K p.
    if (plan.pretension >= p.plate.count * p.plate.stiffness * plan.mean_pitch) {
        throw std::invalid_argument("start: the chain bursts at this speed: the centrifugal tension exceeds what its links can carry");
    }
    return plan;
}

}  // namespace

StartState start_state(const Parameters& p) {
    const ChainLayout at = layout_of(p);
    const StartPlan plan = plan_start(p);
    const ChainPlacer placer(p, plan.pretension, plan.path_of, plan.radii.driving);
    const double phase = 0.25 * plan.mean_pitch;
    const double step = 1e-3 * plan.mean_pitch;  // velocities: how the placed chain moves with its phase
    PlacedChain now = placer.place(phase, 0.0);
    StartState start;
    start.state.assign(static_cast<std::size_t>(at.size()), 0.0);
    start.phases.assign(static_cast<std::size_t>(tips_per_link * at.links), Phase::free);
    fill_positions(at, now, start.state);
    fill_lengths(p, at, start.state);
    double rise = 0.0;
    for (int iteration = 0; iteration < 3 && at.pulley_size != 0; ++iteration) {  // the climb of strands shortens them in second order only
        rise = SheaveFitter(p, start.state, now.along).fit();
        now = placer.place(phase, rise);
        fill_positions(at, now, start.state);
    }
    start.radii = {now.radius, p.start.layout == StartLayout::ring ? now.radius : p.start.ratio * now.radius};
    const PlacedChain before = placer.place(phase - step, rise);
    const PlacedChain after = placer.place(phase + step, rise);
    const double driving = turning_of_arc(before, now, after, step, 0.0, {0.0, 0.0});
    start.speed = plan.turning / driving;
    fill_velocities(at, before, after, start.speed / (2.0 * step), rise, start.state);
    if (at.pulley_size == 0) return start;
    const double turning[] = {plan.turning, start.speed * turning_of_arc(before, now, after, step, 1.0, {p.pulley.centre_distance, 0.0})};
    spin_shafts(p, at, turning, start.state);
    return start;
}

namespace {

[[nodiscard]] double norm(Point a) { return portable_hypot(a.x, a.y); }
[[nodiscard]] Point unit(Point a) { return (1.0 / norm(a)) * a; }

/// Length by which the chords exceed the pitch path.
[[nodiscard]] double excess(const PitchPath& path, const std::vector<double>& chord, double phase) {
    double s = phase;
    Point point = path.at(s);
    for (const double c : chord) s = path.advance(s, c, point);
    return s - phase - path.length();
}

}  // namespace

ChainPlacer::ChainPlacer(const Parameters& p, double pretension, PathOf path_of, double guess)
    : path_of_(std::move(path_of)),
      ring_(p.start.layout == StartLayout::ring),
      pitch_lines_(p.detail.pins == PinDetail::rigid),
      guess_(guess),
      arm_(p.joint.radius - 0.5 * p.half.width),
      diameter_(2.0 * p.joint.radius - (p.detail.pins == PinDetail::halves ? pretension / p.joint.stiffness : 0.0)) {
    // Joints of halves yield by the depth of their contact, those of rigid pins within the link, whose spring is both in series.
    const double joint = p.detail.pins == PinDetail::rigid ? pretension / p.joint.stiffness : 0.0;
    const double stretch = pretension / (p.plate.count * p.plate.stiffness) + joint;
    for (int i = 0; i < p.chain.pins; ++i)
        length_.push_back(p.chain.pitch[static_cast<std::size_t>(i) % p.chain.pitch.size()] + p.half.width + stretch);
}

PlacedChain ChainPlacer::place(double phase, double rise) const {
    const std::size_t n = length_.size();
    std::vector<double> chord(n);
    for (std::size_t i = 0; i < n; ++i) chord[i] = length_[i] - (diameter_ - 2.0 * arm_);
    std::vector<Point> direction;
    for (int iteration = 0; iteration < 200; ++iteration) {
        const auto [pins, placed] = close(chord, phase);
        if (!(placed.radius > 0.0) || !std::isfinite(placed.radius)) break;  // a link is longer than the smaller pulley is wide
        if (direction.empty()) {
            for (std::size_t i = 0; i < n; ++i) direction.push_back(unit(pins[(i + 1) % n] - pins[i]));
        }
        PlacedChain chain = placed;
        if (relax(pins, rise, chord, direction, chain) < 1e-15 * static_cast<double>(iteration + 1)) return chain;
    }
    throw std::invalid_argument(std::string("start: the chain cannot be closed ") + (ring_ ? "into a ring" : "around the pulleys") +
                                " with its joints rolling");
}

std::pair<std::vector<Point>, PlacedChain> ChainPlacer::close(const std::vector<double>& chord, double phase) const {
    double radius = guess_;
    double nearby = guess_ * 1.001;
    double error = excess(path_of_(nearby), chord, phase);
    for (int iteration = 0; iteration < 60; ++iteration) {  // secant; once round grows steadily with the radius
        const double now = excess(path_of_(radius), chord, phase);
        if (std::abs(now) < 1e-16 || now == error) break;
        const double next = radius - now * (radius - nearby) / (now - error);
        nearby = radius;
        error = now;
        radius = next;
    }
    PlacedChain chain;
    chain.radius = radius;
    const PitchPath path = path_of_(chain.radius);
    std::vector<Point> pins;
    double s = phase;
    Point point = path.at(s);
    for (const double c : chord) {
        pins.push_back(point);
        chain.along.push_back(path.side_at(s));
        s = path.advance(s, c, point);
    }
    return {pins, chain};
}

double ChainPlacer::relax(const std::vector<Point>& pins, double rise, std::vector<double>& chord, std::vector<Point>& direction,
                          PlacedChain& chain) const {
    const std::size_t n = pins.size();
    std::vector<Point> reach(n);  // from the pin's middle to its front half
    for (std::size_t i = 0; i < n; ++i) {
        const Point both = direction[(i + n - 1) % n] + direction[i];
        reach[i] = (0.5 * (diameter_ - arm_ * norm(both))) * unit(both);
    }
    double worst = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        chain.front.push_back(pins[i] + reach[i]);
        chain.rear.push_back(pins[i] - reach[i]);
    }
    for (std::size_t i = 0; i < n; ++i) {
        const Point link = chain.front[(i + 1) % n] - chain.rear[i];
        const Point turned = unit(pitch_lines_ ? pins[(i + 1) % n] - pins[i] : link);
        const double climb = rise * (chain.along[(i + 1) % n] - chain.along[i]);
        const double error = portable_hypot(norm(link), climb) - length_[i];
        worst = std::max({worst, std::abs(error), norm(turned - direction[i]) * length_[i]});
        chord[i] -= error;
        direction[i] = turned;
    }
    return worst;
}

}  // namespace cvtflow::model
