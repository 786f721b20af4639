#include "tests/oracle/system.hpp"

#include "model/machine/coefficients.hpp"

#include "tests/oracle/legendre.hpp"
#include "tests/oracle/rigid_pins.hpp"

#include <algorithm>
#include <stdexcept>

namespace cvtflow::oracle {

using model::End;
using model::PulleyDetail;

Vec2 Half::at(Real xi) const {
    Vec2 sum;
    for (int m = 0; m <= order(); ++m) sum += legendre(m, xi) * shape[m];
    return sum;
}

Vec2 Half::rate_at(Real xi) const {
    Vec2 sum;
    for (int m = 0; m <= order(); ++m) sum += legendre(m, xi) * shape_rate[m];
    return sum;
}

Vec2 Half::slope_at(Real xi) const {
    Vec2 sum;
    for (int m = 0; m <= order(); ++m) sum += (2.0L / length * legendre_slope(m, xi)) * shape[m];
    return sum;
}

Vec2 Half::slope_rate_at(Real xi) const {
    Vec2 sum;
    for (int m = 0; m <= order(); ++m) sum += (2.0L / length * legendre_slope(m, xi)) * shape_rate[m];
    return sum;
}

Vec2 Half::mean_slope() const { return (2.0L / length) * shape[1]; }
Vec2 Half::mean_slope_rate() const { return (2.0L / length) * shape_rate[1]; }

void HalfForce::push(Real xi, Vec3 force) {
    for (int m = 0; m < static_cast<int>(shape.size()); ++m) shape[m] += legendre(m, xi) * in_plane(force);
    z += force.z;
    e += xi * force.z;
}

void LinkForce::turn(const Link& link, Real moment) {
    front.shape[0] += (moment / link.length) * link.n;
    rear.shape[0] += (-moment / link.length) * link.n;
}

Half unpack_half(const model::Parameters& parameters, const model::ChainLayout& layout, End end, std::span<const Real> block) {
    const auto rates = block.subspan(layout.link_size());
    Half half;
    half.length = parameters.half.length;
    for (int m = 0; m < layout.lateral(); ++m) {
        half.shape.push_back({block[layout.x(end, m)], block[layout.y(end, m)]});
        half.shape_rate.push_back({rates[layout.x(end, m)], rates[layout.y(end, m)]});
    }
    half.z = block[layout.z(end)];
    half.e = block[layout.e(end)];
    half.z_rate = rates[layout.z(end)];
    half.e_rate = rates[layout.e(end)];
    return half;
}

void make_frame(Link& link) {
    const Vec2 d = link.front.shape[0] - link.rear.shape[0];
    link.length = norm(d);
    link.t = unit(d);
    link.n = left_of(link.t);
    link.o = -link.n;
    link.turning = dot(link.n, link.front.shape_rate[0] - link.rear.shape_rate[0]) / link.length;
}

namespace {

Link unpack_link(const model::Parameters& parameters, const model::ChainLayout& layout, int number, std::span<const Real> state) {
    const auto block = state.subspan(layout.link_begin(number), layout.link_block());
    Link link;
    link.rear = unpack_half(parameters, layout, End::rear, block);
    link.front = unpack_half(parameters, layout, End::front, block);
    make_frame(link);
    const auto& pitch = parameters.chain.pitch;
    link.rest_length = Real{pitch[static_cast<std::size_t>(number) % pitch.size()]} + Real{parameters.half.width};
    return link;
}

std::array<Body, bodies> unpack_elastic(std::span<const Real> q, std::span<const Real> v) {
    std::array<Body, bodies> body;
    for (int b = 0; b < bodies; ++b) {
        const auto at = [b](std::span<const Real> values, int freedom) { return values[model::body_freedom(b, freedom)]; };
        body[b] = {
            {at(q, 0), at(q, 1)}, {at(q, 2), at(q, 3)}, {at(v, 0), at(v, 1)}, {at(v, 2), at(v, 3)}, at(q, 4), at(q, 5), at(v, 4), at(v, 5)};
    }
    return body;
}

/// Rigid pulleys have the coordinates (φ_1, φ_2, w_{1+}, w_{2-}).
std::array<Body, bodies> unpack_rigid(std::span<const Real> q, std::span<const Real> v) {
    std::array<Body, bodies> body;
    for (int shaft = 0; shaft < 2; ++shaft) {
        for (const int b : {shaft, model::sheave_body(shaft, 0), model::sheave_body(shaft, 1)}) {
            body[b].phi = q[shaft];
            body[b].phi_rate = v[shaft];
        }
    }
    body[model::sheave_body(0, 1)].w = q[2];
    body[model::sheave_body(0, 1)].w_rate = v[2];
    body[model::sheave_body(1, 0)].w = q[3];
    body[model::sheave_body(1, 0)].w_rate = v[3];
    return body;
}

}  // namespace

System unpack(const model::Parameters& parameters, double t, std::span<const Real> state, std::span<const model::Phase> phases) {
    const auto layout = model::layout_of(parameters);
    if (static_cast<int>(state.size()) != layout.size()) throw std::invalid_argument("state of the wrong size");
    System system{parameters, layout, t, {}, {}, {}, phases};
    for (const double longer : model::longer_halves(parameters)) system.longer.push_back(longer);
    if (layout.rigid) system.pins = unpack_pins(parameters, layout, state);
    for (int i = 0; i < layout.links && !layout.rigid; ++i) system.links.push_back(unpack_link(parameters, layout, i, state));
    const auto q = state.subspan(layout.pulley_begin(), layout.pulley_size);
    const auto v = state.subspan(layout.pulley_begin() + layout.pulley_size, layout.pulley_size);
    if (parameters.detail.pulleys == PulleyDetail::elastic) system.body = unpack_elastic(q, v);
    if (parameters.detail.pulleys == PulleyDetail::rigid) system.body = unpack_rigid(q, v);
    for (int k = 0; k < system.controllers(); ++k) system.control_integral[k] = state[layout.control_begin() + k];
    if (layout.hydraulic())
        std::copy_n(state.begin() + layout.ledger_begin() - model::hydraulic_unknowns, system.oil.size(), system.oil.begin());
    return system;
}

Totals empty_totals(const System& system) {
    HalfForce half;
    half.shape.resize(system.layout.lateral());
    Totals totals;
    totals.link.assign(system.links.size(), LinkForce{half, half});
    totals.pin.resize(system.pins.size());
    return totals;
}

std::vector<Real> pack_forces(const System& system, const Totals& totals) {
    const auto& layout = system.layout;
    std::vector<Real> forces(static_cast<std::size_t>(layout.coordinates()), 0.0L);
    for (std::size_t i = 0; i < totals.pin.size(); ++i) {
        const std::vector<Real> of_pin = pin_forces(system, totals.pin[i]);
        std::copy(of_pin.begin(), of_pin.end(), forces.begin() + static_cast<int>(i) * layout.link_size());
    }
    for (int i = 0; i < static_cast<int>(totals.link.size()); ++i) {
        for (const End end : {End::rear, End::front}) {
            const HalfForce& half = end == End::rear ? totals.link[i].rear : totals.link[i].front;
            const int begin = i * layout.link_size();
            for (int m = 0; m < layout.lateral(); ++m) {
                forces[begin + layout.x(end, m)] = half.shape[m].x;
                forces[begin + layout.y(end, m)] = half.shape[m].y;
            }
            forces[begin + layout.z(end)] = half.z;
            forces[begin + layout.e(end)] = half.e;
        }
    }
    const int begin = layout.links * layout.link_size();
    if (system.parameters.detail.pulleys == PulleyDetail::elastic) {
        for (int b = 0; b < bodies; ++b) {
            const BodyForce& body = totals.body[b];
            const Real values[] = {body.force.x, body.force.y, body.moment.x, body.moment.y, body.force.z, body.moment.z};
            for (int freedom = 0; freedom < 6; ++freedom) forces[begin + model::body_freedom(b, freedom)] = values[freedom];
        }
    }
    if (system.parameters.detail.pulleys == PulleyDetail::rigid) {
        for (int k = 0; k < 2; ++k) {
            forces[begin + k] =
                totals.body[k].moment.z + totals.body[model::sheave_body(k, 0)].moment.z + totals.body[model::sheave_body(k, 1)].moment.z;
        }
        forces[begin + 2] = totals.body[model::sheave_body(0, 1)].force.z;
        forces[begin + 3] = totals.body[model::sheave_body(1, 0)].force.z;
    }
    return forces;
}

}  // namespace cvtflow::oracle
