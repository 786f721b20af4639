#pragma once
/// Derivatives of all accelerations with respect to coordinates and velocities, as blocks: a link sees its two neighbours and, while it
/// touches, the sheaves of its pulley. The pulleys' block counts the integrals I of controllers, where there are any, as its last unknowns:
/// velocities without a coordinate, whose "acceleration" is I'.

#include <span>
#include <vector>

#include "bench/method/product_names.hpp"
#include "model/parameters/chain_layout.hpp"

namespace cvtflow::bench {

/// With respect to what: coordinates (K) or velocities (D).
enum class With { position = 0, velocity = 1 };
/// Whose: of the link before, the link itself, the link after.
enum class Near { before = 0, same = 1, after = 2 };

class AccelerationJacobian {
public:
    explicit AccelerationJacobian(const ChainLayout& layout);

    [[nodiscard]] int links() const noexcept { return links_; }
    /// Coordinates of a link.
    [[nodiscard]] int size() const noexcept { return size_; }
    /// Pulley coordinates and, with control, the integrals.
    [[nodiscard]] int border() const noexcept { return border_; }

    /// ∂(acceleration of a link)/∂(coordinates or velocities of it or a neighbour): [size × size], row-major [1/s²] or [1/s].
    [[nodiscard]] double* link(int link, Near near, With with) noexcept { return numbers_.data() + link_at(link, near, with); }
    [[nodiscard]] const double* link(int link, Near near, With with) const noexcept { return numbers_.data() + link_at(link, near, with); }
    /// ∂(acceleration of a link)/∂(pulleys): [size × border]. Zero for links that do not touch.
    [[nodiscard]] double* columns(int link, With with) noexcept { return numbers_.data() + columns_begin_ + border_at(link, with); }
    [[nodiscard]] const double* columns(int link, With with) const noexcept {
        return numbers_.data() + columns_begin_ + border_at(link, with);
    }
    /// ∂(acceleration of the pulleys)/∂(a link): [border × size].
    [[nodiscard]] double* rows(int link, With with) noexcept { return numbers_.data() + rows_begin_ + border_at(link, with); }
    [[nodiscard]] const double* rows(int link, With with) const noexcept { return numbers_.data() + rows_begin_ + border_at(link, with); }
    /// ∂(acceleration of the pulleys)/∂(pulleys): [border × border].
    [[nodiscard]] double* corner(With with) noexcept {
        return numbers_.data() + corner_begin_ + static_cast<int>(with) * border_ * border_;
    }
    [[nodiscard]] const double* corner(With with) const noexcept {
        return numbers_.data() + corner_begin_ + static_cast<int>(with) * border_ * border_;
    }

    /// All of them, one block after the other.
    [[nodiscard]] std::span<double> numbers() noexcept { return numbers_; }
    [[nodiscard]] std::span<const double> numbers() const noexcept { return numbers_; }
    [[nodiscard]] std::size_t bytes() const noexcept { return numbers_.size() * sizeof(double); }

private:
    [[nodiscard]] int link_at(int link, Near near, With with) const noexcept {
        return ((3 * link + static_cast<int>(near)) * 2 + static_cast<int>(with)) * size_ * size_;
    }
    [[nodiscard]] int border_at(int link, With with) const noexcept { return (2 * link + static_cast<int>(with)) * size_ * border_; }

    int links_, size_, border_;
    int columns_begin_, rows_begin_, corner_begin_;
    std::vector<double> numbers_;  ///< links, columns, rows, corner [m/s² or rad/s² per unit of the unknown]
};

}  // namespace cvtflow::bench
