#pragma once
/// Elimination of a run of blocks between two separators: the unit of parallel work of the cyclic solver.
///
///     interior rows     L_i x_{i-1} + D_i x_i + U_i x_{i+1} + C_i y = f_i          i = 0 … count-1,  x_{-1} = left, x_{count} = right
///     outer rows        the part of the left separator's and of the border's rows that lies on the interior: [U_left on x_0; R_i on x_i]
///
/// After eliminate() the interior is expressed by left, right and the border's active unknowns y, and what it adds to their rows is known.

#include <vector>

#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

class BlockChain {
public:
    /// Where the entries of one interior block go; row-major.
    struct Rows {
        double* lower;     ///< L [size × size]
        double* diagonal;  ///< D [size × size]
        double* upper;     ///< U [size × size], rows `stride` apart
        double* columns;   ///< C [size × active], rows `stride` apart
        double* rows;      ///< R [active × size]
        int stride;
    };

    /// @param count interior blocks, may be 0   @param border most active border unknowns
    BlockChain(int count, int size, int border);

    /// Number of border unknowns that this run sees; clears all entries.
    void clear(int active) noexcept;
    [[nodiscard]] Rows block(int i) noexcept;
    /// L of the right separator's row, on the last interior block. Without interior: on the left separator.
    [[nodiscard]] double* right_lower() noexcept { return right_lower_.data(); }
    /// U of the left separator's row, on the first interior block. Without interior: on the right separator.
    [[nodiscard]] double* left_upper() noexcept { return left_upper_.data(); }

    /// @return false if a pivot vanished
    [[nodiscard]] bool eliminate() noexcept;

    /// Contribution of the run to the right separator's row: [on right (size) | on left (size) | on active], rows `stride` apart, size
    /// rows.
    [[nodiscard]] const double* right_row() const noexcept { return right_row_.data(); }
    [[nodiscard]] int stride() const noexcept { return 2 * size_ + active_; }
    /// Its contribution to the outer rows (left separator, then active border rows), size + active of them: [on right | on left | on
    /// active].
    [[nodiscard]] const double* outer_rows() const noexcept { return outer_sum_.data(); }

    /// Forward substitution of f [count × size].
    void forward(const double* f) noexcept;
    /// Its contribution to the right-hand side of the right separator [size], and of the outer rows [size + active].
    [[nodiscard]] const double* right_part() const noexcept { return right_part_.data(); }
    [[nodiscard]] const double* outer_part() const noexcept { return outer_part_.data(); }
    /// Interior unknowns [count × size] from those around. @param y active border unknowns [active]
    void backward(const double* left, const double* right, const double* y, double* x) const noexcept;

    [[nodiscard]] int count() const noexcept { return count_; }
    [[nodiscard]] int active() const noexcept { return active_; }

private:
    [[nodiscard]] double* lower(int i) noexcept { return lower_.data() + i * size_ * size_; }
    [[nodiscard]] double* diagonal(int i) noexcept { return diagonal_.data() + i * size_ * size_; }
    [[nodiscard]] double* panel(int i) noexcept { return panel_.data() + i * size_ * (2 * size_ + border_); }
    [[nodiscard]] double* outer(int i) noexcept { return outer_.data() + i * (size_ + border_) * size_; }
    void close_without_interior() noexcept;
    void eliminate_outer(int i) noexcept;

    int count_, size_, border_, active_ = 0;
    std::vector<double> lower_, diagonal_;  ///< [count][size × size]
    std::vector<double> panel_;             ///< [count][size × (2 size + active)]: U | left | C, then D⁻¹ times it
    std::vector<double> outer_;             ///< [count][(size + active) × size]: outer rows on the block when its turn comes
    std::vector<int> exchanges_;            ///< [count][size]
    std::vector<double> right_lower_, left_upper_, right_row_, outer_sum_, right_part_, outer_part_, solution_;
};

}  // namespace cvtflow::bench
