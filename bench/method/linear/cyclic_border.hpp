#pragma once
/// LU of a cyclic block-tridiagonal matrix with a border: every block is coupled to its neighbours in a ring and to some border unknowns.
///
///     L_i x_{i-1} + D_i x_i + U_i x_{i+1} + C_i y = f_i     i = 0 … blocks-1, cyclic
///     Σ_i R_i x_i + B y = g
///
/// The ring is cut into chunks whose last block is a separator. Chunks are eliminated independently of each other, then the separators and
/// the border, then everything is substituted back:
///
///     eliminate[chunk] ─► join         forward[chunk] ─► join_solution ─► backward[chunk]
///
/// Chunks are a property of the matrix, not of the threads that work on them: results are bitwise equal for any number of threads. Pivots
/// are sought within a block only, which suffices for matrices near the identity (or an inertia) plus a dissipative part.

#include <memory>
#include <span>
#include <vector>

#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

// Small dense kernels on row-major matrices, for the block solver. Each entry's sum is taken in one fixed order without fused
// multiply-adds, so results are bitwise the same on every machine. Nothing is allocated.

/// C -= A B.   A is [rows × inner], B [inner × columns], C [rows × columns]; a `stride` is the distance of two rows.
void subtract_product(int rows, int inner, int columns, const double* a, int a_stride, const double* b, int b_stride, double* c,
                      int c_stride) noexcept;

/// P A = L U in place with row exchanges: row k was exchanged with row exchanges[k] ≥ k. A is [size × size], rows `size` apart.
/// @return false if a pivot is zero or not finite; A is then invalid
[[nodiscard]] bool factorise(int size, double* a, int* exchanges) noexcept;

/// X ← A⁻¹ X with the result of factorise(). X is [size × columns].
void solve_factorised(int size, const double* lu, const int* exchanges, double* x, int stride, int columns) noexcept;

/// Elimination of a run of blocks between two separators: the unit of parallel work of the cyclic solver.
///
///     interior rows     L_i x_{i-1} + D_i x_i + U_i x_{i+1} + C_i y = f_i          i = 0 … count-1,  x_{-1} = left, x_{count} = right
///     outer rows        the part of the left separator's and of the border's rows that lies on the interior: [U_left on x_0; R_i on x_i]
///
/// After eliminate() the interior is expressed by left, right and the border's active unknowns y, with its contribution to their rows.
class BlockChain {
public:
    /// Places of the entries of one interior block; row-major.
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

    /// Sets the number of border unknowns that this run is coupled to; clears all entries.
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
    /// Contribution of the run to the outer rows (left separator, then active border rows), size + active of them: [on right | on left | on
    /// active].
    [[nodiscard]] const double* outer_rows() const noexcept { return outer_sum_.data(); }

    /// Forward substitution of f [count × size].
    void forward(const double* f) noexcept;
    /// Contribution of f to the right-hand side of the right separator [size], and of the outer rows [size + active].
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

class CyclicBorder {
public:
    /// Entries of one block's rows and of the border's rows on it; row-major, all zero after clear().
    struct Block {
        double* lower;     ///< L_i [size × size]
        double* diagonal;  ///< D_i [size × size]
        double* upper;     ///< U_i [size × size], rows `upper_stride` apart; a separator's belongs to the next chunk
        double* columns;   ///< C_i [size × border.size()], rows `columns_stride` apart
        double* rows;      ///< R_i [border.size() × size]
        int upper_stride, columns_stride;
        std::span<const int> border;  ///< border unknowns of C_i and R_i
    };
    struct Range {
        int first, last;  ///< blocks [first, last); last - 1 is the separator
        [[nodiscard]] int size() const noexcept { return last - first; }
    };

    /// @param size unknowns of a block   @param border unknowns of the border, may be 0   @param chunks 1 ≤ chunks ≤ blocks
    CyclicBorder(int blocks, int size, int border, int chunks);

    [[nodiscard]] int chunks() const noexcept { return static_cast<int>(ranges_.size()); }
    [[nodiscard]] const Range& range(int chunk) const noexcept { return ranges_[static_cast<std::size_t>(chunk)]; }
    /// Numbers in a right-hand side or solution: blocks one after the other, then the border.
    [[nodiscard]] int unknowns() const noexcept { return blocks_ * size_ + border_; }

    /// Clears the entries of a chunk's blocks (and U of the separator before it), and sets the border unknowns that its inner blocks couple
    /// to.
    /// @param border at most `border` numbers
    void clear(int chunk, std::span<const int> border) noexcept;
    /// Destination of a block's entries, between clear() and eliminate() of its chunk. With a single block L, D and U add up.
    [[nodiscard]] Block block(int number) noexcept;
    /// B [border × border], row-major; the caller fills it before every join().
    [[nodiscard]] double* corner() noexcept { return corner_.data(); }

    /// Eliminates the inner blocks of a chunk. @return false if a pivot vanished
    [[nodiscard]] bool eliminate(int chunk) noexcept;
    /// Separators and border, after all chunks. @return false if a pivot vanished
    [[nodiscard]] bool join() noexcept;

    /// Solves with the results of eliminate() and join(); right-hand side and solution have unknowns() numbers and may be the same array. f
    /// [rows of the matrix]
    void forward(int chunk, const double* f) noexcept;
    void join_solution(const double* f) noexcept;  ///< f [rows of the matrix]
    /// Writes the chunk's blocks of x; chunk 0 also the border's.
    void backward(int chunk, double* x) noexcept;

private:
    struct Place {
        double* at;
        int stride;
    };

    [[nodiscard]] int previous(int chunk) const noexcept { return chunk == 0 ? chunks() - 1 : chunk - 1; }
    [[nodiscard]] BlockChain& inner(int chunk) const noexcept { return *inner_[static_cast<std::size_t>(chunk)]; }
    [[nodiscard]] std::span<const int> active(int chunk) const noexcept;
    [[nodiscard]] Place place(int row, int column) noexcept;
    void collect_given(int chunk) noexcept;
    void collect_inner(int chunk) noexcept;
    void collect_ring() noexcept;
    /// Diagonal, columns and rows of a separator as given.
    [[nodiscard]] double* separator(int chunk) noexcept { return separators_.data() + chunk * size_ * (size_ + 2 * border_); }
    [[nodiscard]] double* known(int chunk) noexcept { return known_.data() + chunk * size_; }

    int blocks_, size_, border_;
    std::vector<Range> ranges_;
    std::vector<std::unique_ptr<BlockChain>> inner_;
    std::vector<int> active_, active_count_, all_border_;
    std::vector<double> separators_;       ///< [chunk] D, C, R of its separator
    BlockChain ring_;                      ///< separators but the last
    std::vector<double> corner_, matrix_;  ///< B; last separator and border: [size + border]²
    std::vector<int> exchanges_;
    std::vector<double> known_;  ///< separators and border: right-hand side, then solution [rows of the matrix]
    std::vector<double> seen_;   ///< [chunk][border] solution of the active border unknowns
};

}  // namespace cvtflow::bench
