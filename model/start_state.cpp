#include "model/start_state.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

#include "model/chain_model.hpp"
#include "model/force/pulley.hpp"

namespace cvtflow::model {

double link_mass(const Parameters& p) noexcept { return 2.0 * p.half.mass + p.plate.count * p.plate.mass; }

namespace {

[[nodiscard]] Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y}; }
[[nodiscard]] Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
[[nodiscard]] Point operator*(double s, Point a) { return {s * a.x, s * a.y}; }
[[nodiscard]] double norm(Point a) { return std::hypot(a.x, a.y); }
[[nodiscard]] Point unit(Point a) { return (1.0 / norm(a)) * a; }

using PathOf = std::function<PitchPath(double)>;   ///< path for a radius of the driving pulley (or ring)

/// Positions of both halves of every pin, and where the pin is on the path.
struct PlacedChain {
    std::vector<Point> front, rear;   ///< L_i, R_i
    std::vector<double> along;        ///< share of the way from the driving to the driven pulley
    double radius;                    ///< of the driving pulley or ring
};

/// Chain closed on its path: pins at chord distances, joints rolling purely (arc centres along the bisector), links at the given lengths.
class ChainPlacer {
public:
    ChainPlacer(const Parameters& p, double pretension, PathOf path_of, double guess)
        : path_of_(std::move(path_of)), guess_(guess), arm_(p.joint.radius - 0.5 * p.half.width),
          diameter_(2.0 * p.joint.radius - pretension / p.joint.stiffness) {
        const double stretch = pretension / (p.plate.count * p.plate.stiffness);
        for (int i = 0; i < p.chain.pins; ++i) length_.push_back(p.chain.pitch[static_cast<std::size_t>(i) % p.chain.pitch.size()] + p.half.width + stretch);
    }

    /// @param rise axial distance from the driving to the driven arc, climbed evenly along the strands [m]
    [[nodiscard]] PlacedChain place(double phase, double rise) const {
        const std::size_t n = length_.size();
        std::vector<double> chord(n);
        for (std::size_t i = 0; i < n; ++i) chord[i] = length_[i] - (diameter_ - 2.0 * arm_);
        std::vector<Point> direction;
        for (int iteration = 0; iteration < 200; ++iteration) {
            const auto [pins, placed] = close(chord, phase);
            if (!(placed.radius > 0.0) || !std::isfinite(placed.radius)) break;   // a link is longer than the smaller pulley is wide
            if (direction.empty()) {
                for (std::size_t i = 0; i < n; ++i) direction.push_back(unit(pins[(i + 1) % n] - pins[i]));
            }
            PlacedChain chain = placed;
            if (relax(pins, rise, chord, direction, chain) < 1e-15 * static_cast<double>(iteration + 1)) return chain;
        }
        throw std::invalid_argument("start: the chain cannot be closed around the pulleys with its joints rolling");
    }

private:
    /// Radius for which the chords close, and the pins on that path.
    [[nodiscard]] std::pair<std::vector<Point>, PlacedChain> close(const std::vector<double>& chord, double phase) const {
        double radius = guess_;
        double nearby = guess_ * 1.001;
        double error = excess(path_of_(nearby), chord, phase);
        for (int iteration = 0; iteration < 60; ++iteration) {   // secant; once round grows steadily with the radius
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
        for (const double c : chord) {
            pins.push_back(path.at(s));
            chain.along.push_back(path.side_at(s));
            s = path.advance(s, c);
        }
        return {pins, chain};
    }

    /// How much further than once round the chords lead.
    [[nodiscard]] static double excess(const PitchPath& path, const std::vector<double>& chord, double phase) {
        double s = phase;
        for (const double c : chord) s = path.advance(s, c);
        return s - phase - path.length();
    }

    /// Halves from pins; corrects chords and directions; returns the largest error of a link's length [m].
    double relax(const std::vector<Point>& pins, double rise, std::vector<double>& chord, std::vector<Point>& direction, PlacedChain& chain) const {
        const std::size_t n = pins.size();
        std::vector<Point> reach(n);   // from the pin's middle to its front half
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
            const Point turned = unit(link);
            const double climb = rise * (chain.along[(i + 1) % n] - chain.along[i]);
            const double error = std::hypot(norm(link), climb) - length_[i];
            worst = std::max({worst, std::abs(error), norm(turned - direction[i]) * length_[i]});
            chord[i] -= error;
            direction[i] = turned;
        }
        return worst;
    }

    PathOf path_of_;
    double guess_;
    double arm_, diameter_;
    std::vector<double> length_;
};

/// Calls put(link block, end, pin) for every half.
template <class Put>
void for_every_half(const ChainLayout& at, std::vector<double>& state, const Put& put) {
    for (int link = 0; link < at.links; ++link) {
        double* block = state.data() + at.link_begin(link);
        put(block, End::rear, static_cast<std::size_t>(link));
        put(block, End::front, static_cast<std::size_t>(at.next(link)));
    }
}

void fill_positions(const ChainLayout& at, const PlacedChain& now, std::vector<double>& state) {
    for_every_half(at, state, [&](double* block, End end, std::size_t pin) {
        const Point here = (end == End::rear ? now.rear : now.front)[pin];
        block[at.x(end, 0)] = here.x;
        block[at.y(end, 0)] = here.y;
    });
}

/// Velocities as differences of two placements; axially the strands climb by `rise`.
void fill_velocities(const ChainLayout& at, const PlacedChain& before, const PlacedChain& after, double rate, double rise, std::vector<double>& state) {
    for_every_half(at, state, [&](double* block, End end, std::size_t pin) {
        const Point moved = (end == End::rear ? after.rear : after.front)[pin] - (end == End::rear ? before.rear : before.front)[pin];
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
        : model_(p), pulleys_(p), state_(state), along_(along) {}

    /// Axial distance from the driving to the driven arc [m].
    double fit() {
        for (int iteration = 0; iteration < 30; ++iteration) {
            for (int shaft = 0; shaft < 2; ++shaft) shift_[shaft] -= fixed_sign(shaft) * deepest(shaft, shaft == 0 ? 0 : 1);
            place_axially();
        }
        for (int iteration = 0; iteration < 30; ++iteration) {
            for (int shaft = 0; shaft < 2; ++shaft) {
                const double overlap = deepest(shaft, shaft == 0 ? 1 : 0);
                state_[static_cast<std::size_t>(model_.layout().pulley_begin() + pulleys_.movable(shaft))] -= fixed_sign(shaft) * overlap;
            }
        }
        return shift_[1] - shift_[0];
    }

private:
    [[nodiscard]] static double fixed_sign(int shaft) { return shaft == 0 ? -1.0 : 1.0; }

    void place_axially() {
        const ChainLayout& at = model_.layout();
        for_every_half(at, state_, [&](double* block, End end, std::size_t pin) { block[at.z(end)] = shift_[0] + along_[pin] * (shift_[1] - shift_[0]); });
    }

    /// Largest depth of tips on one side of one shaft.
    [[nodiscard]] double deepest(int shaft, int side) const {
        const ChainLayout& at = model_.layout();
        SheaveMotion sheaves[4];
        pulleys_.motions(state_.data() + at.pulley_begin(), sheaves);
        double depth = -1.0;
        for (int link = 0; link < at.links; ++link) {
            const double* block = state_.data() + at.link_begin(link);
            if (model_.shaft_of(block) != shaft) continue;
            TipProbe probe;
            model_.probe(block, sheaves, probe);
            depth = std::max({depth, probe.depth[side], probe.depth[2 + side]});
        }
        return depth;
    }

    ChainModel model_;
    PulleyModel pulleys_;
    std::vector<double>& state_;
    const std::vector<double>& along_;
    double shift_[2] = {0.0, 0.0};
};

void spin_shafts(const Parameters& p, const ChainLayout& at, const BeltRadii& radii, double speed, std::vector<double>& state) {
    const PulleyModel pulleys(p);
    double* q = state.data() + at.pulley_begin();
    const auto turn = [&](int coordinate, double rate) {
        q[at.pulley_size + coordinate] = rate;
        q[coordinate] = -rate * p.start.settling_time;   // angles count from t = 0
    };
    for (int shaft = 0; shaft < 2; ++shaft) {
        const double rate = speed / (shaft == 0 ? radii.driving : radii.driven);
        turn(pulleys.rotation(shaft), rate);
        if (at.pulley_size != 36) continue;
        for (int side = 0; side < 2; ++side) turn(body_freedom(sheave_body(shaft, side), 5), rate);
    }
}

[[nodiscard]] double nominal_length(const Parameters& p) {
    double length = 0.0;
    for (int i = 0; i < p.chain.pins; ++i) length += p.chain.pitch[static_cast<std::size_t>(i) % p.chain.pitch.size()];
    return length;
}

}  // namespace

StartState start_state(const Parameters& p) {
    const ChainLayout at = layout_of(p);
    const double a = p.pulley.centre_distance;
    const double length = nominal_length(p);
    const bool ring = p.start.layout == StartLayout::ring;
    const auto radii = ring ? BeltRadii{length / (2.0 * std::numbers::pi), length / (2.0 * std::numbers::pi)}
                            : belt_radii(length, p.start.ratio, a).value_or(BeltRadii{0.0, 0.0});
    if (radii.driving <= 0.0) throw std::invalid_argument("start: the chain does not close around the pulleys at the wanted ratio");
    const double turning = ring ? p.start.ring_speed : p.drive.mode == DriveMode::speed ? p.drive.speed.at(0.0) : p.control.reference_speed;
    const double ratio = p.start.ratio;
    const PathOf path_of = ring ? PathOf([](double r) { return PitchPath(r); }) : PathOf([=](double r) { return PitchPath(BeltRadii{r, ratio * r}, a); });

    const double mean_pitch = length / p.chain.pins;
    const double pull = link_mass(p) * radii.driving * turning * turning * radii.driving / mean_pitch;   // σ v²
    const ChainPlacer placer(p, pull, path_of, radii.driving);
    const double step = 1e-3 * mean_pitch;
    const double phase = 0.25 * mean_pitch;
    PlacedChain now = placer.place(phase, 0.0);
    StartState start{std::vector<double>(static_cast<std::size_t>(at.size()), 0.0), std::vector<Phase>(static_cast<std::size_t>(tips_per_link * at.links), Phase::free), {}, 0.0};
    fill_positions(at, now, start.state);
    double rise = 0.0;
    for (int iteration = 0; iteration < 3 && at.pulley_size != 0; ++iteration) {   // the climb of strands shortens them in second order only
        rise = SheaveFitter(p, start.state, now.along).fit();
        now = placer.place(phase, rise);
        fill_positions(at, now, start.state);
    }
    start.radii = {now.radius, ring ? now.radius : ratio * now.radius};
    start.speed = turning * now.radius;
    fill_velocities(at, placer.place(phase - step, rise), placer.place(phase + step, rise), start.speed / (2.0 * step), rise, start.state);
    if (at.pulley_size != 0) spin_shafts(p, at, start.radii, start.speed, start.state);
    return start;
}

}  // namespace cvtflow::model
