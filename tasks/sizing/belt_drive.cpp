#include "tasks/sizing/belt_drive.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>

namespace cvtflow::tasks {

namespace {

constexpr int max_iterations = 60;
constexpr double kilo = 1e3, milli = 1e-3;
/// Where friction falls with the speed, a belt without inertia has several insets on a finer mesh. With 24 to 96 nodes slip changes by 2 %.
constexpr int nodes_under_law = 96;

/// Quadrature of a mean over a normal distribution with deviation 1: Gauss and Hermite's seven nodes.
struct Quadrature {
    double deviation, weight;
};
constexpr std::array<Quadrature, 7> gauss{{{0.0, 16.0 / 35.0},
                                           {1.1544053947399682, 0.24012317860501272},
                                           {-1.1544053947399682, 0.24012317860501272},
                                           {2.3667594107345416, 0.03075712396758650},
                                           {-2.3667594107345416, 0.03075712396758650},
                                           {3.7504397177257420, 0.00054826885597221781},
                                           {-3.7504397177257420, 0.00054826885597221781}}};
constexpr std::array<Quadrature, 1> still{{{0.0, 1.0}}};

/// Zero of an increasing function between low and high, by false position with halved weights (Illinois).
template <class Function>
double zero_of(const Function& f, double low, double high, double tolerance) {
    double below = f(low), above = f(high);
    for (int k = 0; k < max_iterations && high - low > tolerance; ++k) {
        const double x = (low * above - high * below) / (above - below), y = f(x);
        if (std::abs(y) < tolerance) return x;
        const bool under = y < 0.0;
        (under ? low : high) = x;
        (under ? above : below) *= 0.5;
        (under ? below : above) = y;
    }
    return 0.5 * (low + high);
}

/// [N/m] of a link with its joint.
[[nodiscard]] double link_stiffness(const model::Parameters& p) {
    return 1.0 / (1.0 / (p.plate.count * p.plate.stiffness) + 1.0 / p.joint.stiffness);
}

using Four = std::array<double, 4>;

[[nodiscard]] double norm_of(const Four& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]); }

/// Solution of a linear system by Gauss' elimination with row pivots. rows [row][column]
[[nodiscard]] Four solution_of(std::array<Four, 4> rows, Four right) {
    for (std::size_t k = 0; k < 4; ++k) {
        std::size_t pivot = k;
        for (std::size_t r = k + 1; r < 4; ++r)
            if (std::abs(rows[r][k]) > std::abs(rows[pivot][k])) pivot = r;
        std::swap(rows[k], rows[pivot]);
        std::swap(right[k], right[pivot]);
        for (std::size_t r = 0; r < 4; ++r) {
            if (r == k) continue;
            const double factor = rows[r][k] / rows[k][k];
            for (std::size_t c = k; c < 4; ++c) rows[r][c] -= factor * rows[k][c];
            right[r] -= factor * right[k];
        }
    }
    for (std::size_t k = 0; k < 4; ++k) right[k] /= rows[k][k];
    return right;
}

}  // namespace

BeltArcSolver::BeltArcSolver(const model::Parameters& p, const BeltPulley& pulley, const BeltParts& parts)
    : pulley_(pulley),
      friction_(p.tip.largest_friction()),
      saturation_(p.tip.friction.saturation_speed * (parts.saturation_speed ? 1.0 : 1e-3)),
      sin_(std::sin(p.tip.angle)),
      law_(model::tip_law(p, p.oil.temperature)),
      vibration_(parts.vibration),
      yielding_(parts.yielding_pins),
      count_(law_ ? std::min(parts.nodes, nodes_under_law) : parts.nodes) {
    if (parts.crowned_flank) sin_ += (pulley.radius - p.pulley.arc_position) / (p.pulley.arc_radius + p.tip.radius);
    cos_ = std::sqrt(1.0 - sin_ * sin_);
    const double pitch = model::chain_length(p.chain) / p.chain.pins, speed = pulley.speed * pulley.radius;
    weight_ = (2.0 * p.half.mass + p.plate.count * p.plate.mass) / pitch * speed * speed;
    stretch_ = parts.stretching_belt ? 1.0 / (link_stiffness(p) * pitch) : 0.0;
    const bool tilting = parts.tilting_sheaves && p.detail.pulleys == model::PulleyDetail::elastic;
    tilt_ = tilting ? pulley.radius * pulley.radius * cos_ / (p.pulley.attachment_tilt * sin_) : 0.0;
    hertz_ = p.tip.hertz;
    bar_ = p.half.length / (p.chain.young_modulus * p.half.area);
    share_ = 0.5 * pitch / pulley.radius;
}

/// Inset by pins and tips that yield to an axial force per angle. s [N/rad]
double BeltArcSolver::yielding_inset(double axial) const {
    if (!yielding_) return 0.0;
    const double force = axial * share_, root = std::cbrt(force / (cos_ * hertz_));
    return 0.5 * (2.0 * root * root / cos_ + force * bar_) * cos_ / sin_;
}

/// Friction coefficient at a sliding speed [m/s].
double BeltArcSolver::coefficient(double speed) const { return law_ ? friction_ * law_->by_speed.at(speed) : friction_; }

/// Forces of a belt that slides like this, while pins vibrate across. reduced: tension without centrifugal part [N]; pace: of the speed
/// across that the law of friction sees. At the entry the belt yields at once, a pin over one pitch.
BeltArcSolver::Contact BeltArcSolver::contact(double reduced, double along, double across, double pace) const {
    double per_speed = 0.0, outwards = 0.0;  // friction over sliding speed and outward friction, by normal force
    for (const auto& [deviation, weight] : vibration_ > 0.0 ? std::span<const Quadrature>(gauss) : std::span<const Quadrature>(still)) {
        const double now = across + deviation * vibration_, speed = std::sqrt(along * along + now * now), seen = pace * now;
        const double share = coefficient(std::sqrt(along * along + seen * seen)) / std::max(speed, saturation_);
        per_speed += weight * share;
        outwards += weight * share * now;
    }
    const double normal = reduced / (sin_ - outwards * cos_);
    return {per_speed * along * normal, 0.5 * normal * (cos_ + outwards * sin_), per_speed * normal};
}

BeltArcSolver::Sums BeltArcSolver::sweep(const Unknowns& u, std::vector<BeltNode>* nodes) const {
    const double step = pulley_.wrap / count_, speed = pulley_.speed * pulley_.radius;
    const auto opening = [&](double angle) {
        const double from_middle = angle - 0.5 * pulley_.wrap;
        return -tilt_ * kilo * (u.middle * std::cos(from_middle) + u.side * std::sin(from_middle));
    };
    double tension = kilo * u.entry, inset = opening(0.0);
    Sums sums{};
    for (int k = 1; k <= count_; ++k) {
        const double angle = (k - 0.5) * step, open = opening(angle), reduced = tension - weight_,
                     pace = k == 1 ? 0.5 * step / share_ : 1.0;
        if (reduced <= 0.0) throw std::domain_error("the belt is slack");
        const double flow = speed * (1.0 + milli * u.creep + stretch_ * (tension - kilo * u.entry)) - pulley_.growth * angle;
        const auto along = [&](double d) { return flow - pulley_.speed * (pulley_.radius + d); };
        const auto across = [&](double d) { return (pulley_.growth + pulley_.speed * (d - inset) / step) / cos_; };
        const auto excess = [&](double d) { return d - open + yielding_inset(contact(reduced, along(d), across(d), pace).axial); };
        const double most = yielding_inset(0.5 * reduced * (cos_ + friction_) / (sin_ - friction_ * cos_));
        const double found = most > 0.0 ? zero_of(excess, open - most, open, 1e-13) : open;
        const Contact now = contact(reduced, along(found), across(found), pace);
        if (nodes) nodes->push_back({angle, tension, now.axial, found, along(found), across(found), now.per_speed});
        inset = found;
        tension += step * now.along;
        sums.clamping += step * now.axial;
        sums.middle += step * now.axial * std::cos(angle - 0.5 * pulley_.wrap);
        sums.side += step * now.axial * std::sin(angle - 0.5 * pulley_.wrap);
    }
    sums.difference = tension - kilo * u.entry;
    return sums;
}

BeltArcSolver::Unknowns BeltArcSolver::converge(Unknowns u, const Ends& ends) const {
    const auto residual = [&](const Four& x) {
        const Sums sums = sweep({x[0], x[1], x[2], x[3]}, nullptr);
        const double first = ends.entry_given ? kilo * x[0] - ends.first : sums.clamping - ends.first;
        return Four{first, sums.difference - ends.difference, sums.middle - kilo * x[2], sums.side - kilo * x[3]};
    };
    Four x{u.entry, u.creep, u.middle, u.side}, r = residual(x);
    for (int k = 0; k < max_iterations; ++k) {
        if (norm_of(r) < 1e-6 * kilo) return {x[0], x[1], x[2], x[3]};
        std::array<Four, 4> slopes{};
        for (std::size_t j = 0; j < 4; ++j) {
            Four moved = x;
            moved[j] += 1e-6;
            const Four there = residual(moved);
            for (std::size_t i = 0; i < 4; ++i) slopes[i][j] = (there[i] - r[i]) / 1e-6;
        }
        const Four change = solution_of(slopes, r);
        const double most = std::min(1.0, (0.3 + 0.3 * std::abs(x[1])) / std::abs(change[1]));  // beyond, friction saturates, slopes vanish
        for (double part = most;; part *= 0.5) {
            if (!(part >= 1e-4 * most)) throw std::domain_error("friction cannot carry this difference of tensions");
            Four tried = x;
            for (std::size_t i = 0; i < 4; ++i) tried[i] -= part * change[i];
            if (kilo * tried[0] <= weight_) continue;
            try {
                const Four now = residual(tried);
                if (!(norm_of(now) < norm_of(r))) continue;
                x = tried;
                r = now;
                break;
            } catch (const std::domain_error&) {}
        }
    }
    throw std::domain_error("friction cannot carry this difference of tensions");
}

/// First guess: an arc without a difference of tensions, with an even axial force.
BeltArcSolver::Unknowns BeltArcSolver::guess(const Ends& ends) const {
    const double per_force = 2.0 * sin_ / (cos_ * pulley_.wrap);  // tension by clamping force
    const double clamping = ends.entry_given ? (ends.first - weight_) / per_force : ends.first;
    const double bulge = std::sin(0.5 * pulley_.wrap) / (0.5 * pulley_.wrap), middle = clamping * bulge;
    const double inset = -yielding_inset(clamping / pulley_.wrap) - tilt_ * middle * bulge;
    return {(clamping * per_force + weight_) / kilo, inset / pulley_.radius / milli, middle / kilo, 0.0};
}

/// Solves in steps of the difference, each from the one before: near the limit the creep is far from that of small differences.
BeltArc BeltArcSolver::arc(const Ends& ends) const {
    Unknowns u = guess(ends);
    constexpr int parts = 3;
    for (int k = 0; k <= parts; ++k) u = converge(u, {ends.first, ends.difference * k / parts, ends.entry_given});
    BeltArc arc;
    const Sums sums = sweep(u, &arc.nodes);
    arc.clamping = sums.clamping;
    arc.torque = sums.difference * pulley_.radius;
    double grip = 0.0, drag = 0.0;
    for (const BeltNode& node : arc.nodes) {
        const double step = pulley_.wrap / count_, radius = pulley_.radius + node.inset;
        drag += step * node.friction_per_speed * radius * node.along;
        grip += step * node.friction_per_speed * radius * radius;
        arc.sliding_power += step * node.friction_per_speed * (node.along * node.along + node.across * node.across);
    }
    arc.friction_speed = pulley_.speed + drag / grip;
    return arc;
}

BeltArc BeltArcSolver::between(double entry, double exit) const { return arc({entry, exit - entry, true}); }

BeltArc BeltArcSolver::clamped(double clamping, double difference) const { return arc({clamping, difference, false}); }

std::array<double, 2> belt_radii(const model::Parameters& p, double ratio) {
    const double centres = p.pulley.centre_distance, target = model::chain_length(p.chain);
    const auto length = [&](double r) {
        const double incline = std::asin(r * (ratio - 1.0) / centres);
        return 2.0 * centres * std::cos(incline) + std::numbers::pi * r * (ratio + 1.0) + 2.0 * incline * r * (ratio - 1.0);
    };
    double low = 0.0, high = 0.999 * centres / std::max(1.0, std::abs(ratio - 1.0));
    for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (low + high);
        (length(middle) < target ? low : high) = middle;
    }
    return {low, ratio * low};
}

double belt_torque_limit(const model::Parameters& p, const BeltPoint& point) {
    return 2.0 * p.tip.largest_friction() * point.clamping * belt_radii(p, point.ratio)[1] / std::cos(p.tip.angle);
}

BeltDrive solve_belt(const model::Parameters& p, const BeltPoint& point, const BeltParts& parts) {
    const auto [driving, driven] = belt_radii(p, point.ratio);
    const double incline = std::asin((driven - driving) / p.pulley.centre_distance);
    const double wrap_1 = std::numbers::pi - 2.0 * incline, wrap_2 = std::numbers::pi + 2.0 * incline;
    const BeltPulley first{driving, wrap_1, point.speed, point.growth};
    const BeltPulley second{driven, wrap_2, point.speed / point.ratio, -point.growth * wrap_1 / wrap_2};  // the belt keeps its length
    const double difference = point.torque / driven;
    const BeltArc second_arc = BeltArcSolver(p, second, parts).clamped(point.clamping, difference);
    const double slack = second_arc.nodes.front().tension, tight = slack + difference;
    const BeltArc first_arc = BeltArcSolver(p, first, parts).between(tight, slack);
    const double slip = 1.0 - first_arc.friction_speed / first.speed * second.speed / second_arc.friction_speed;
    const double shift = second.growth / second.radius - first.growth / first.radius;
    return {{first, second}, {first_arc, second_arc}, tight, slack, first_arc.clamping / point.clamping, slip, shift};
}

}  // namespace cvtflow::tasks
