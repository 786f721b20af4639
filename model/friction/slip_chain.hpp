#pragma once
/// Elimination of the inner joints of a chain, block by block (Gauss and Jordan: matrices are symmetric with eigenvalues ≥ 1, no pivot is
/// sought). Lanes over the columns of a row.

#include <algorithm>

#include "model/basis/lanes.hpp"
#include "model/friction/slip_space.hpp"

namespace cvtflow::model {
namespace {

/// Size: unknowns of a joint, a constant for the compiler; 0: read from the chain.
template <int Size>
class SlipElimination {
public:
    using V = Lanes<slip_lanes>;

    explicit SlipElimination(SlipChain& chain) noexcept : c_(chain) {
        alignas(64) double mask[slip_lanes] = {};
        mask[size() % slip_lanes] = 1.0;
        right_side_ = load<slip_lanes>(mask);
    }

    void condense() noexcept {
        const int count = elements();
        for (int row = 0; row < size(); ++row) {
            for (int k = 0; k < parts(); ++k) {
                left_[row][k] = part(element(0).row(row), k);
                next_[row][k] = part(element(0).row(size() + row), k);
            }
        }
        for (int joint = 1; joint < count; ++joint) {
            enter(joint);
            jordan(panel(joint));
            reduce(joint);
        }
        for (int row = 0; row < size(); ++row) {
            for (int k = 0; k < parts(); ++k) {
                left_[row][k].copy_to(c_.condensed.row(row) + k * slip_lanes);
                next_[row][k].copy_to(c_.condensed.row(size() + row) + k * slip_lanes);
            }
        }
        if (count == 1) return;
        for (int row = 0; row < size(); ++row) {   // by symmetry
            for (int k = 0; k < size(); ++k) c_.condensed.row(k)[block() + row] = c_.condensed.row(size() + row)[k];
        }
    }

    /// Inner joints from those at the ends.
    void substitute() noexcept {
        const double* left = solution(0);
        for (int joint = elements() - 1; joint >= 1; --joint) {
            double* x = solution(joint);
            const double *next = solution(joint + 1), *p = panel(joint);
            for (int row = 0; row < size(); ++row) {
                const double* own = p + row * width();
                V total = part(own, 0) * part(left, 0) + part(own, half()) * part(next, 0);
                for (int k = 1; k < half(); ++k) total += part(own, k) * part(left, k) + part(own, half() + k) * part(next, k);
                x[row] = own[size()] - sum<slip_lanes>(total);
            }
        }
    }

    /// Both ends are one joint: solves for it, and all others.
    void close() noexcept {
        condense();
        double* rows = panel(0);
        for (int row = 0; row < size(); ++row) {
            const double *left = c_.condensed.row(row), *right = c_.condensed.row(size() + row);
            double* own = rows + row * width();
            for (int k = 0; k < half(); ++k) {
                const V all = (part(left, k) + part(left, half() + k)) + (part(right, k) + part(right, half() + k));
                matrix_[row][k] = all;
                all.copy_to(own + k * slip_lanes);
                V(0.0).copy_to(own + (half() + k) * slip_lanes);
            }
        }
        add_identity();
        jordan(rows);
        for (int row = 0; row < size(); ++row) solution(0)[row] = solution(elements())[row] = rows[row * width() + size()];
        substitute();
    }

private:
    static constexpr int most = Size > 0 ? Size : 2 * most_joint_lanes;
    static constexpr int most_parts = SlipElement::block(most) / slip_lanes;

    [[nodiscard]] int size() const noexcept { return Size > 0 ? Size : c_.size; }
    [[nodiscard]] int block() const noexcept { return SlipElement::block(size()); }
    [[nodiscard]] int width() const noexcept { return 2 * block(); }
    /// Vectors of a block, of a row.
    [[nodiscard]] int half() const noexcept { return block() / slip_lanes; }
    [[nodiscard]] int parts() const noexcept { return 2 * half(); }
    [[nodiscard]] int elements() const noexcept { return static_cast<int>(c_.elements.size()); }
    [[nodiscard]] const SlipElement& element(int number) const noexcept { return c_.elements[static_cast<std::size_t>(number)]; }
    [[nodiscard]] double* panel(int joint) noexcept { return c_.panels.data() + joint * size() * width(); }
    [[nodiscard]] double* solution(int joint) noexcept { return c_.solution.data() + joint * block(); }
    [[nodiscard]] static V part(const double* row, int k) noexcept { return load<slip_lanes>(row + k * slip_lanes); }
    /// A vector of a row's first block with nothing but the right-hand side.
    [[nodiscard]] V right_side(const V& vector, int k) const noexcept { return k == size() / slip_lanes ? right_side_ * vector : V(0.0); }

    void add_identity() noexcept {
        for (int row = 0; row < size(); ++row) {
            const int k = row / slip_lanes, lane = row % slip_lanes;
            alignas(64) double unit[slip_lanes] = {};
            unit[lane] = 1.0;
            matrix_[row][k] += load<slip_lanes>(unit);
        }
    }

    /// Matrix of a joint, and its rows on left (with the right-hand side) and next.
    void enter(int joint) noexcept {
        double* p = panel(joint);
        for (int row = 0; row < size(); ++row) {
            const double* after = element(joint).row(row);
            double* own = p + row * width();
            for (int k = 0; k < half(); ++k) {
                matrix_[row][k] = next_[row][half() + k] + part(after, k);
                (next_[row][k] + right_side(part(after, k), k)).copy_to(own + k * slip_lanes);
                part(after, half() + k).copy_to(own + (half() + k) * slip_lanes);
            }
        }
        add_identity();
        std::copy_n(p, size() * width(), before_);
    }

    /// Rows ← matrix⁻¹ rows.
    void jordan(double* rows) noexcept {
        V r[most][2 * most_parts];
        for (int row = 0; row < size(); ++row) {
            for (int k = 0; k < parts(); ++k) r[row][k] = part(rows + row * width(), k);
        }
        for (int pivot = 0; pivot < size(); ++pivot) {
            const int own = pivot / slip_lanes;
            const auto lane = static_cast<std::size_t>(pivot % slip_lanes);
            const V inverse(1.0 / matrix_[pivot][own][lane]);
            for (int k = own; k < half(); ++k) matrix_[pivot][k] = matrix_[pivot][k] * inverse;
            for (int k = 0; k < parts(); ++k) r[pivot][k] = r[pivot][k] * inverse;
            for (int row = 0; row < size(); ++row) {
                if (row == pivot) continue;
                const V factor(matrix_[row][own][lane]);
                for (int k = own; k < half(); ++k) matrix_[row][k] = matrix_[row][k] - factor * matrix_[pivot][k];
                for (int k = 0; k < parts(); ++k) r[row][k] = r[row][k] - factor * r[pivot][k];
            }
        }
        for (int row = 0; row < size(); ++row) {
            for (int k = 0; k < parts(); ++k) r[row][k].copy_to(rows + row * width() + k * slip_lanes);
        }
    }

    /// What the joint leaves on the left end and on the next joint.
    void reduce(int joint) noexcept {
        const double* p = panel(joint);
        for (int row = 0; row < size(); ++row) {
            const double* element_row = element(joint).row(size() + row);
            for (int k = 0; k < half(); ++k) {
                next_[row][k] = right_side(part(element_row, k), k);   // the element's rows on the joint itself have gone
                next_[row][half() + k] = part(element_row, half() + k);
            }
            for (int inner = 0; inner < size(); ++inner) {
                const V on_left(before_[inner * width() + row]), on_next(before_[inner * width() + block() + row]);
                for (int k = 0; k < half(); ++k) left_[row][k] = left_[row][k] - on_left * part(p + inner * width(), k);
                for (int k = 0; k < parts(); ++k) next_[row][k] = next_[row][k] - on_next * part(p + inner * width(), k);
            }
        }
    }

    SlipChain& c_;
    V right_side_;
    V left_[most][2 * most_parts], next_[most][2 * most_parts], matrix_[most][most_parts];
    alignas(64) double before_[most * 2 * most_parts * slip_lanes];
};

}  // namespace
}  // namespace cvtflow::model
