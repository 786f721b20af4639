#include "tests/claims/chain_view_fixture.hpp"

#include <cmath>

#include "model/machine/link_inertia.hpp"
#include "model/observe/chain_forces.hpp"

namespace cvtflow::claims {

using model::End;

Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vector operator*(double s, Vector a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
double norm(Vector a) { return std::sqrt(dot(a, a)); }

namespace {

Vector turned(Vector a) { return {-a.y, a.x, 0.0}; }  // k×a
double arm(const model::Parameters& p) { return p.joint.radius - 0.5 * p.half.width; }

}  // namespace

ChainView::ChainView(const model::Parameters& parameters, const double* state)
    : parameters_(parameters), own_(model::layout_of(parameters)), layout_(model::halves_layout(own_)), state_(state) {
    model::halves_of(model::Coefficients(parameters), state, halves_);
}

Vector ChainView::read(int link, End end, int offset) const {
    const double* block = halves_.data() + layout_.link_begin(link) + offset;
    return {block[layout_.x(end, 0)], block[layout_.y(end, 0)], block[layout_.z(end)]};
}

Vector ChainView::pin(int pin) const { return 0.5 * (position(layout_.previous(pin), End::front) + position(pin, End::rear)); }

Vector ChainView::direction(int link) const {
    Vector d = position(link, End::front) - position(link, End::rear);
    d.z = 0.0;
    return (1.0 / norm(d)) * d;
}

double ChainView::turning(int link) const {
    Vector d = position(link, End::front) - position(link, End::rear);
    d.z = 0.0;
    return dot(turned(direction(link)), velocity(link, End::front) - velocity(link, End::rear)) / norm(d);
}

Vector ChainView::centres(int pin) const {
    const int before = layout_.previous(pin);
    Vector between = position(before, End::front) - position(pin, End::rear) + arm(parameters_) * (direction(before) + direction(pin));
    between.z = 0.0;
    return between;
}

double ChainView::joint_depth(int pin) const { return 2.0 * parameters_.joint.radius - norm(centres(pin)); }

double ChainView::joint_closing(int pin) const {
    const int before = layout_.previous(pin);
    const Vector rate = velocity(before, End::front) - velocity(pin, End::rear) +
                        arm(parameters_) * (turning(before) * turned(direction(before)) + turning(pin) * turned(direction(pin)));
    return -dot(centres(pin), rate) / norm(centres(pin));
}

double ChainView::stretch(int link) const {
    const auto& pitch = parameters_.chain.pitch;
    const double free = pitch[static_cast<std::size_t>(link) % pitch.size()] + parameters_.half.width;
    return norm(position(link, End::front) - position(link, End::rear)) - free;
}

double ChainView::stretching(int link) const {
    const Vector d = position(link, End::front) - position(link, End::rear);
    return dot(d, velocity(link, End::front) - velocity(link, End::rear)) / norm(d);
}

Vector ChainView::momentum() const {
    const model::LinkInertia inertia = model::link_inertia(parameters_);
    const int lateral = own_.lateral(), size = own_.bodies() * lateral, axial = 2 * own_.bodies();
    Vector sum{0.0, 0.0, 0.0};
    for (int link = 0; link < links(); ++link) {
        const double* v = state_ + own_.link_begin(link) + own_.link_size();
        for (int row = 0; row < size; row += lateral) {  // m = 0 of every body; plates couple it with bending
            for (int column = 0; column < size; ++column) {
                const double mass = inertia.lateral_matrix[static_cast<std::size_t>(size * row + column)];
                sum = sum + Vector{mass * v[column], mass * v[size + column], 0.0};
            }
        }
        for (int row = 0; row < axial; row += 2) {
            for (int column = 0; column < axial; ++column)
                sum.z += inertia.axial_matrix[static_cast<std::size_t>(axial * row + column)] * v[2 * size + column];
        }
    }
    return sum;
}

double ChainView::angular_momentum() const {
    const model::LinkInertia inertia = model::link_inertia(parameters_);
    const int size = own_.bodies() * own_.lateral();
    double sum = 0.0;
    for (int link = 0; link < links(); ++link) {
        const double* q = state_ + own_.link_begin(link);
        const double* v = q + own_.link_size();
        for (int row = 0; row < size; ++row) {
            for (int column = 0; column < size; ++column) {
                sum += inertia.lateral_matrix[static_cast<std::size_t>(row * size + column)] *
                       (q[row] * v[size + column] - q[size + row] * v[column]);
            }
        }
    }
    return sum;
}

}  // namespace cvtflow::claims
