#include "model/start/chain_placer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "model/basis/portable_math.hpp"

namespace cvtflow::model {

namespace {

[[nodiscard]] double norm(Point a) { return portable_hypot(a.x, a.y); }
[[nodiscard]] Point unit(Point a) { return (1.0 / norm(a)) * a; }

/// How much further than once round the chords lead.
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
      guess_(guess),
      arm_(p.joint.radius - 0.5 * p.half.width),
      diameter_(2.0 * p.joint.radius - (p.detail.pins == PinDetail::halves ? pretension / p.joint.stiffness : 0.0)) {
    const double stretch = pretension / (p.plate.count * p.plate.stiffness);
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
        const Point turned = unit(link);
        const double climb = rise * (chain.along[(i + 1) % n] - chain.along[i]);
        const double error = portable_hypot(norm(link), climb) - length_[i];
        worst = std::max({worst, std::abs(error), norm(turned - direction[i]) * length_[i]});
        chord[i] -= error;
        direction[i] = turned;
    }
    return worst;
}

}  // namespace cvtflow::model
