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

    [[nodiscard]] PlacedChain place(double phase) const {
        const std::size_t n = length_.size();
        std::vector<double> chord(n);
        for (std::size_t i = 0; i < n; ++i) chord[i] = length_[i] - (diameter_ - 2.0 * arm_);
        std::vector<Point> direction;
        for (int iteration = 0; iteration < 200; ++iteration) {
            const auto [pins, placed] = close(chord, phase);
            if (direction.empty()) {
                for (std::size_t i = 0; i < n; ++i) direction.push_back(unit(pins[(i + 1) % n] - pins[i]));
            }
            PlacedChain chain = placed;
            if (relax(pins, chord, direction, chain) < 1e-15 * static_cast<double>(iteration + 1)) return chain;
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
    double relax(const std::vector<Point>& pins, std::vector<double>& chord, std::vector<Point>& direction, PlacedChain& chain) const {
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
            const double error = norm(link) - length_[i];
            worst = std::max({worst, std::abs(error), 1e-3 * norm(turned - direction[i]) * length_[i]});
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

/// Writes positions to q and velocities to v of every link.
void fill_links(const ChainLayout& at, const PlacedChain& now, const PlacedChain& before, const PlacedChain& after, double rate, std::vector<double>& state) {
    const auto put = [&](double* block, End end, std::size_t pin, const std::vector<Point>& here, const std::vector<Point>& back, const std::vector<Point>& forth) {
        block[at.x(end, 0)] = here[pin].x;
        block[at.y(end, 0)] = here[pin].y;
        block[at.link_size() + at.x(end, 0)] = rate * (forth[pin].x - back[pin].x);
        block[at.link_size() + at.y(end, 0)] = rate * (forth[pin].y - back[pin].y);
    };
    for (int link = 0; link < at.links; ++link) {
        double* block = state.data() + at.link_begin(link);
        put(block, End::rear, static_cast<std::size_t>(link), now.rear, before.rear, after.rear);
        put(block, End::front, static_cast<std::size_t>(at.next(link)), now.front, before.front, after.front);
    }
}

/// Moves the arcs axially onto the fixed sheaves and the movable sheaves onto the arcs, until the deepest tip just touches.
class SheaveFitter {
public:
    SheaveFitter(const Parameters& p, std::vector<double>& state, const std::vector<double>& along)
        : model_(p), pulleys_(p), state_(state), along_(along) {}

    void fit() {
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
    }

private:
    [[nodiscard]] static double fixed_sign(int shaft) { return shaft == 0 ? -1.0 : 1.0; }

    void place_axially() {
        const ChainLayout& at = model_.layout();
        for (int link = 0; link < at.links; ++link) {
            double* block = state_.data() + at.link_begin(link);
            const auto z = [&](int pin) { return shift_[0] + along_[static_cast<std::size_t>(pin)] * (shift_[1] - shift_[0]); };
            block[at.z(End::rear)] = z(link);
            block[at.z(End::front)] = z(at.next(link));
        }
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

/// Path, pre-tension and speed that a scene asks for.
struct StartPlan {
    BeltRadii radii;     ///< nominal, of a belt as long as the sum of pitches
    PathOf path_of;
    double turning;      ///< of the driving shaft or the ring [rad/s]
    double pretension;   ///< σ v²: what the chain's own motion pulls [N]
    double mean_pitch;   ///< [m]
};

[[nodiscard]] StartPlan plan_start(const Parameters& p) {
    const double a = p.pulley.centre_distance;
    const double ratio = p.start.ratio;
    const double length = nominal_length(p);
    const bool ring = p.start.layout == StartLayout::ring;
    StartPlan plan;
    plan.mean_pitch = length / p.chain.pins;
    if (ring) {
        plan.radii = {length / (2.0 * std::numbers::pi), length / (2.0 * std::numbers::pi)};
        plan.path_of = [](double r) { return PitchPath(r); };
        plan.turning = p.start.ring_speed;
    } else {
        const auto radii = belt_radii(length, ratio, a);
        if (!radii) throw std::invalid_argument("start: the chain does not close around the pulleys at the wanted ratio");
        plan.radii = *radii;
        plan.path_of = [=](double r) { return PitchPath(BeltRadii{r, ratio * r}, a); };
        plan.turning = p.drive.mode == DriveMode::speed ? p.drive.speed.at(0.0) : p.control.reference_speed;
    }
    const double speed = plan.radii.driving * plan.turning;
    plan.pretension = link_mass(p) / plan.mean_pitch * speed * speed;
    return plan;
}

}  // namespace

StartState start_state(const Parameters& p) {
    const ChainLayout at = layout_of(p);
    const StartPlan plan = plan_start(p);
    const ChainPlacer placer(p, plan.pretension, plan.path_of, plan.radii.driving);
    const double phase = 0.25 * plan.mean_pitch;
    const double step = 1e-3 * plan.mean_pitch;   // velocities: how the placed chain moves with its phase
    const PlacedChain now = placer.place(phase);

    StartState start;
    start.state.assign(static_cast<std::size_t>(at.size()), 0.0);
    start.phases.assign(static_cast<std::size_t>(tips_per_link * at.links), Phase::free);
    start.radii = {now.radius, p.start.layout == StartLayout::ring ? now.radius : p.start.ratio * now.radius};
    start.speed = plan.turning * now.radius;
    fill_links(at, now, placer.place(phase - step), placer.place(phase + step), start.speed / (2.0 * step), start.state);
    if (at.pulley_size != 0) {
        SheaveFitter(p, start.state, now.along).fit();
        spin_shafts(p, at, start.radii, start.speed, start.state);
    }
    return start;
}

}  // namespace cvtflow::model
