#pragma once
/// Geometry of a state: positions of halves, depths of joints, extensions of plates. Written from model/EQUATIONS.md, not from the kernels.
/// Rigid pins are treated as the halves that they consist of.

#include <vector>

#include "model/parameters/chain_layout.hpp"

namespace cvtflow::claims {

struct Vector {
    double x, y, z;
};
[[nodiscard]] Vector operator+(Vector a, Vector b);
[[nodiscard]] Vector operator-(Vector a, Vector b);
[[nodiscard]] Vector operator*(double s, Vector a);
[[nodiscard]] double dot(Vector a, Vector b);
[[nodiscard]] double norm(Vector a);

class ChainView {
public:
    ChainView(const model::Parameters& parameters, const double* state);

    [[nodiscard]] int links() const { return layout_.links; }
    /// Middle of a half (m = 0) and its velocity.
    [[nodiscard]] Vector position(int link, model::End end) const { return read(link, end, 0); }
    [[nodiscard]] Vector velocity(int link, model::End end) const { return read(link, end, layout_.link_size()); }
    /// Middle between both halves of a pin.
    [[nodiscard]] Vector pin(int pin) const;
    /// Direction of a link in the plane, and its turning rate.
    [[nodiscard]] Vector direction(int link) const;
    [[nodiscard]] double turning(int link) const;
    /// Depth of the joint of a pin at the middle of its line [m] and how fast it closes [m/s].
    [[nodiscard]] double joint_depth(int pin) const;
    [[nodiscard]] double joint_closing(int pin) const;
    /// Distance of both halves of a link beyond its plates' free length [m] and how fast it grows [m/s].
    [[nodiscard]] double stretch(int link) const;
    [[nodiscard]] double stretching(int link) const;
    /// Linear momentum and angular momentum about z of the whole chain, all orders.
    [[nodiscard]] Vector momentum() const;
    [[nodiscard]] double angular_momentum() const;

private:
    [[nodiscard]] Vector read(int link, model::End end, int offset) const;
    [[nodiscard]] Vector centres(int pin) const;  ///< C_L - C_R

    const model::Parameters& parameters_;
    model::ChainLayout own_;     ///< layout of the state
    model::ChainLayout layout_;  ///< layout of its halves
    const double* state_;
    std::vector<double> halves_;
};

}  // namespace cvtflow::claims
