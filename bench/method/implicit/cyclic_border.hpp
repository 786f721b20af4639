#pragma once
/// LU of a cyclic block-tridiagonal matrix with a border: every block is coupled to its neighbours in a ring and to some border unknowns.
///
///     L_i x_{i-1} + D_i x_i + U_i x_{i+1} + C_i y = f_i     i = 0 … blocks-1, cyclic
///     Σ_i R_i x_i + B y = g
///
/// The ring is cut into chunks [first(chunk), first(chunk + 1)) whose last block is a separator. Chunks are eliminated independently of
/// each other, then the separators and the border, then everything is substituted back:
///
///     eliminate[chunk] ─► join         forward[chunk] ─► join_solution ─► backward[chunk]
///
/// Chunks are a property of the matrix, not of the threads that work on them: results are bitwise equal for any number of threads. Pivots
/// are sought within a block only, which suffices for matrices near the identity (or an inertia) plus a dissipative part.

#include <Eigen/LU>
#include <span>
#include <vector>

#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

/// Blocks in a row, each coupled to the next one and to outer unknowns behind them, of which the first are eliminated. Rows and columns:
/// [blocks | outer].
struct BlockChain {
    /// @param outer most outer unknowns
    BlockChain(int size, int blocks, int eliminated, int outer);

    void clear(int outer_now);
    /// Leaves D⁻¹[U | outer] in the rows of eliminated blocks, and their contribution in the other rows. @return false if a pivot vanished
    [[nodiscard]] bool eliminate();
    void forward();                                                        ///< substitutes into x [blocks, outer]
    void backward();                                                       ///< substitutes back into x
    [[nodiscard]] int kept() const noexcept { return size * eliminated; }  ///< number of the first unknown that is kept

    int size, blocks, eliminated, outer = 0;
    Eigen::MatrixXd matrix, scratch;
    Eigen::VectorXd x;
    std::vector<Eigen::PartialPivLU<Eigen::MatrixXd>> pivots;  ///< [eliminated] D
};

class CyclicBorder {
public:
    using Part = Eigen::Block<Eigen::MatrixXd>;

    /// @param size unknowns of a block   @param border unknowns of the border, may be 0   @param chunks 1 ≤ chunks ≤ blocks
    CyclicBorder(int blocks, int size, int border, int chunks);

    [[nodiscard]] int chunks() const noexcept { return chunks_; }
    /// First block of a chunk, or behind the last one.
    [[nodiscard]] int first(int chunk) const noexcept { return static_cast<int>(static_cast<long>(blocks_) * chunk / chunks_); }
    /// Numbers in a right-hand side or solution: blocks one after the other, then the border.
    [[nodiscard]] int unknowns() const noexcept { return blocks_ * size_ + border_; }

    /// Clears the entries of a chunk's blocks (of the last one without U, of the separator before it U), and sets the border unknowns that
    /// its blocks are coupled to. @param border at most `border` numbers
    void clear(int chunk, std::span<const int> border);
    // Destination of a block's entries, between clear() and eliminate() of the chunk that clears them.
    [[nodiscard]] Part lower(int block) noexcept;
    [[nodiscard]] Part diagonal(int block) noexcept;
    [[nodiscard]] Part upper(int block) noexcept;
    [[nodiscard]] Part columns(int block) noexcept;  ///< C on the border unknowns of the chunk
    [[nodiscard]] Part rows(int block) noexcept;     ///< R of the same
    /// B [border × border]; the caller fills it before every join().
    [[nodiscard]] Eigen::MatrixXd& corner() noexcept { return corner_; }

    /// Eliminates the inner blocks of a chunk. @return false if a pivot vanished
    [[nodiscard]] bool eliminate(int chunk) { return chain(chunk).eliminate(); }
    /// Separators and border, after all chunks. @return false if a pivot vanished
    [[nodiscard]] bool join();

    /// Solves with the results of eliminate() and join(); right-hand side and solution have unknowns() numbers and may be the same array. f
    /// [rows of the matrix]
    void forward(int chunk, const double* f);
    void join_solution(const double* f);  ///< f [rows of the matrix]
    /// Writes the chunk's blocks of x; chunk 0 also the border's.
    void backward(int chunk, double* x);

private:
    [[nodiscard]] BlockChain& chain(int chunk) noexcept { return chains_[static_cast<std::size_t>(chunk)]; }
    [[nodiscard]] int blocks_of(int chunk) const noexcept { return first(chunk + 1) - first(chunk); }
    [[nodiscard]] int chunk_of(int block) const noexcept;
    [[nodiscard]] int place(int chunk, int block) const noexcept;
    [[nodiscard]] Part part(int chunk, int row, int column) noexcept;

    int blocks_, size_, border_, chunks_;
    std::vector<BlockChain> chains_;      ///< [chunk] its blocks; outer: the separator before it, border unknowns
    std::vector<std::vector<int>> kept_;  ///< [chunk] numbers of its kept unknowns in the ring
    BlockChain ring_;                     ///< separators; outer: the last one, border
    Eigen::MatrixXd corner_;
    Eigen::PartialPivLU<Eigen::MatrixXd> last_;  ///< last separator and border
};

}  // namespace cvtflow::bench
