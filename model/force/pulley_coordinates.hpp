#pragma once
/// Coordinates of the pulleys: where the rotation of a shaft and the travel of its movable sheave are in the pulleys' block [q | v].
/// (model/EQUATIONS.md section 8)

#include "model/parameters/chain_layout.hpp"

namespace cvtflow::model {

class PulleyCoordinates {
public:
    /// Coordinates of a body of elastic pulleys.
    enum Freedom { ux = 0, uy = 1, tilt_x = 2, tilt_y = 3, axial = 4, turn = 5 };

    /// Becomes the coordinates of other parameters.
    void adopt(const Parameters& parameters) noexcept;

    [[nodiscard]] int size() const noexcept { return size_; }
    [[nodiscard]] bool elastic() const noexcept { return size_ == 36; }
    /// Index of a shaft's rotation, and of its movable sheave's axial motion, in the pulleys' q.
    [[nodiscard]] int rotation(int shaft) const noexcept { return elastic() ? body_freedom(shaft, turn) : shaft; }
    [[nodiscard]] int sheave_rotation(int shaft, int side) const noexcept {
        return elastic() ? body_freedom(sheave_body(shaft, side), turn) : shaft;
    }
    [[nodiscard]] int movable(int shaft) const noexcept { return elastic() ? body_freedom(movable_body(shaft), axial) : 2 + shaft; }
    /// Speed of shaft 0 or 1. block [unknowns of the pulleys]
    [[nodiscard]] double shaft_speed(const double* block, int shaft) const noexcept { return block[size_ + rotation(shaft)]; }
    /// Axial position of a shaft's movable sheave relative to the shaft. block [unknowns of the pulleys]
    [[nodiscard]] double clamped_position(const double* block, int shaft) const noexcept { return opening(block, shaft); }
    /// Running radius by the position of the movable sheave, as a transmission measures it: straight flanks, stiff sheaves [m].
    [[nodiscard]] double running_radius(const double* block, int shaft) const noexcept {
        return arc_position_ - narrowing_ * movable_side(shaft) * opening(block, shaft);
    }

    /// Side that moves: +z on the driving shaft, -z on the driven one; its sign.
    [[nodiscard]] static int movable_body(int shaft) noexcept { return sheave_body(shaft, shaft == 0 ? 1 : 0); }
    [[nodiscard]] static double movable_side(int shaft) noexcept { return shaft == 0 ? 1.0 : -1.0; }

protected:
    /// w of the movable sheave relative to its shaft, of positions or velocities.
    [[nodiscard]] double opening(const double* coordinates, int shaft) const noexcept {
        const double moved = coordinates[movable(shaft)];
        return elastic() ? moved - coordinates[body_freedom(shaft, axial)] : moved;
    }

private:
    int size_ = 0;
    double arc_position_ = 0.0;
    double narrowing_ = 0.0;  ///< 1/(2 tan β), loss of running radius per opening of the groove [1]
};

}  // namespace cvtflow::model
