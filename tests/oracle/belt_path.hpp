#pragma once
/// A closed chain laid on a belt around two pulleys or on a ring: where every half sits, with given joint depths and plate stretches.

#include "model/parameters/parameters.hpp"
#include "tests/oracle/vectors.hpp"

#include <vector>

namespace cvtflow::oracle {

/// A closed smooth curve, passed anti-clockwise: two arcs and two strands, or a circle.
class BeltPath {
public:
    /// Arcs of radii r and ratio r around (0, 0) and (distance, 0).
    static BeltPath around_pulleys(Real radius, Real ratio, Real distance);
    static BeltPath ring(Real radius);

    enum class Part { strand_to_driven, driven_arc, strand_to_driving, driving_arc };
    struct Place {
        Vec2 point;    ///< [m]
        Vec2 tangent;  ///< unit vector of travel
        Part part;
        Real fraction;  ///< fraction of this part already passed, 0…1
    };
    [[nodiscard]] Real length() const;         ///< [m]
    [[nodiscard]] Place at(Real along) const;  ///< any distance from the start [m], taken modulo the length

private:
    Real lengths_[4] = {};  ///< lengths of the parts
    Real radius_[2] = {};   ///< radii of the arcs around the driving and driven axis
    Vec2 axis_[2];
    Real entry_[2] = {};  ///< polar angles at which the arcs begin
};

/// Targets of the chain that is laid out.
struct ChainTargets {
    std::vector<Real> depth;    ///< depth of joint i [m]
    std::vector<Real> lean;     ///< turn of joint i's contact normal from the bisector [rad]
    std::vector<Real> stretch;  ///< stretch of the plates of link i [m]
};

struct LaidHalf {
    Vec2 point;             ///< m = 0 position [m]
    BeltPath::Place place;  ///< place of its pin on the path
};
struct LaidChain {
    std::vector<LaidHalf> rear;   ///< R_i, by link
    std::vector<LaidHalf> front;  ///< L_{i+1}, by link
    Real radius;                  ///< radius of the driving arc or ring [m]
};

/// Finds the radius with which the chain closes on the path.
LaidChain lay_chain(const model::Parameters& parameters, const ChainTargets& targets);

}  // namespace cvtflow::oracle
