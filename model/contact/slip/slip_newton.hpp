#pragma once
/// One step of Newton's method inside the links of a group, lanes over links. (model/contact/slip/slip_space.hpp)

#include "model/contact/slip/slip_law.hpp"
#include "model/contact/slip/slip_tiles.hpp"

namespace cvtflow::model {
namespace {

/// Touching: whether a tip of the group touches; else its tips count for nothing.
template <int Points, bool Touching>
class SlipNewton {
public:
    using V = SlipV;
    using F = FloatLanes;

    SlipNewton(const SlipSpace& space, SlipGroup& group) noexcept : rows_(space, group), laws_(space, group), g_(group) {}

    /// λ = φ(w), all contacts.
    void forces() noexcept {
        for (int contact = 0; contact < rows_.contacts().count(); ++contact) {
            const V w[2] = {get(g_.slip, 2 * contact), get(g_.slip, 2 * contact + 1)};
            const SlipLaw law = laws_.template law<false>(contact, w);
            put(g_.force, 2 * contact, law.force[0]);
            put(g_.force, 2 * contact + 1, law.force[1]);
        }
    }

    /// φ and R at w.
    void linearise() noexcept {
        for (int contact = 0; contact < rows_.contacts().count(); ++contact) {
            if (is_missing(contact)) continue;
            const V w[2] = {get(g_.slip, 2 * contact), get(g_.slip, 2 * contact + 1)};
            const SlipLaw law = laws_.template law<true>(contact, w);
            for (int k = 0; k < 4; ++k) put(g_.root, 4 * contact + k, law.root[k]);
            for (int k = 0; k < 2; ++k) put(g_.law_force, 2 * contact + k, law.force[k]);
        }
    }

    /// What is left of the link for its joints, at w.
    void eliminate() noexcept {
        factorise();
        panels();
        joints();
    }

    /// Forces from the joints' unknowns.
    void substitute(const float* unknowns) noexcept {
        for (int slip = 0; slip < joint_slips(); slip += 2)
            step(SlipContacts::first_joint + slip / 2, load(unknowns + slip * slip_lanes), load(unknowns + (slip + 1) * slip_lanes));
        F y[local_end];
        for (int row = 0; row < local(); ++row) y[row] = panel(row, joint_slips());
        for (int k = 0; k < joint_slips(); ++k) {
            const F x = load(unknowns + k * slip_lanes);
            for (int row = 0; row < local(); ++row) y[row] = y[row] - panel(row, k) * x;
        }
        back_substitute(y, local(), [this](int row, int column) { return factor(row, column); });
        for (int contact = 0; contact < locals(); ++contact) step(contact, y[2 * contact], y[2 * contact + 1]);
    }

    /// Slope of the energy along the step at its start and at a share of it, and how far forces are off there. Joints count as rear ones.
    void search(double share) noexcept {
        V before(0.0), after(0.0), residual(0.0);
        for (int contact = 0; contact < SlipContacts::first_joint + rows_.points(); ++contact) {
            if (is_missing(contact)) continue;
            V w[2], off[2], change[2];
            for (int k = 0; k < 2; ++k) {
                const int row = 2 * contact + k;
                change[k] = get(g_.next_slip, row) - get(g_.slip, row);
                w[k] = get(g_.slip, row) + share * change[k];
                before += (get(g_.law_force, row) - get(g_.force, row)) * change[k];
            }
            const SlipLaw law = laws_.template law<false>(contact, w);
            for (int k = 0; k < 2; ++k) {
                const int row = 2 * contact + k;
                off[k] = law.force[k] - (get(g_.force, row) + share * (get(g_.next_force, row) - get(g_.force, row)));
                after += off[k] * change[k];
            }
            const double both = contact < SlipContacts::first_joint ? 1.0 : 2.0;
            const V give = both * widen(larger(coupling(2 * contact, 2 * contact), coupling(2 * contact + 1, 2 * contact + 1)));
            residual = larger<slip_lanes>(give * sqrt(off[0] * off[0] + off[1] * off[1]), residual);
        }
        collect(before, after, residual);
    }

private:
    static constexpr int local_end = SlipContacts::local_slips;
    static constexpr int max_joint_slips = 4 * (Points > 0 ? Points : max_joint_lanes);

    /// Contacts inside the links, and their slips: plates only where no tip touches.
    [[nodiscard]] static constexpr int locals() noexcept { return Touching ? SlipContacts::first_joint : SlipContacts::first_tip; }
    [[nodiscard]] static constexpr int local() noexcept { return 2 * locals(); }
    [[nodiscard]] static bool is_missing(int contact) noexcept { return contact >= locals() && contact < SlipContacts::first_joint; }
    /// Slips of both joints.
    [[nodiscard]] int joint_slips() const noexcept { return 4 * rows_.points(); }
    [[nodiscard]] F coupling(int row, int column) const noexcept { return get(g_.coupling, triangle(row, column)); }
    [[nodiscard]] F root(int contact, int row, int column) const noexcept { return get(g_.root, 4 * contact + 2 * row + column); }
    [[nodiscard]] F factor(int row, int column) const noexcept { return get(g_.factor, triangle(row, column)); }
    /// Column joint_slips(): the right-hand side.
    [[nodiscard]] F panel(int row, int column) const noexcept { return get(g_.panel, row * (joint_slips() + 1) + column); }

    /// R_aᵀ g W R_b of two contacts, a ≥ b. @param to takes row, column and value
    template <class Put>
    void block(int a, int b, const Put& to) const noexcept {
        const bool joints = b >= SlipContacts::first_joint;  // nothing beside the diagonal then
        const F r[4] = {root(a, 0, 0), root(a, 0, 1), root(a, 1, 0), root(a, 1, 1)},
                s[4] = {root(b, 0, 0), root(b, 0, 1), root(b, 1, 0), root(b, 1, 1)};
        const F w00 = coupling(2 * a, 2 * b), w11 = coupling(2 * a + 1, 2 * b + 1);
        F t[4] = {r[0] * w00, r[2] * w11, r[1] * w00, r[3] * w11};
        if (!joints) {
            const F w10 = coupling(2 * a + 1, 2 * b), w01 = a == b ? w10 : coupling(2 * a, 2 * b + 1);
            t[0] = t[0] + r[2] * w10;
            t[1] = t[1] + r[0] * w01;
            t[2] = t[2] + r[3] * w10;
            t[3] = t[3] + r[1] * w01;
        }
        for (int i = 0; i < 2; ++i) {
            for (int j = 0; j < 2; ++j) to(i, j, t[2 * i] * s[j] + t[2 * i + 1] * s[2 + j]);
        }
    }

    /// L D Lᵀ = 1 + Rᵀ g W R of plates and tips.
    void factorise() noexcept {
        F m[triangle(local_end, 0)];
        for (int a = 0; a < locals(); ++a) {
            for (int b = 0; b <= a; ++b) {
                block(a, b, [&](int i, int j, const F& value) {
                    if (a > b || i >= j) m[triangle(2 * a + i, 2 * b + j)] = value;
                });
            }
        }
        for (int row = 0; row < local(); ++row) m[triangle(row, row)] = 1.0f + m[triangle(row, row)];
        ldl<local()>(m);
        for (int k = 0; k < triangle(local(), 0); ++k) put(g_.factor, k, m[k]);
    }

    /// L⁻¹ [Rᵀ g W R of the joints' slips | Rᵀ (ŵ - g W φ - w)], all columns side by side.
    void panels() noexcept {
        constexpr int most = max_joint_slips + 1;
        F x[local_end * most];
        const int width = joint_slips() + 1;
        for (int a = 0; a < locals(); ++a) {
            for (int b = 0; b < 2 * rows_.points(); ++b) {
                block(SlipContacts::first_joint + b, a, [&](int i, int j, const F& value) { x[(2 * a + j) * width + 2 * b + i] = value; });
            }
            F d[2];
            for (int k = 0; k < 2; ++k) d[k] = narrow(get(g_.part, 2 * a + k) - get(g_.slip, 2 * a + k));
            for (int i = 0; i < 2; ++i) x[(2 * a + i) * width + width - 1] = root(a, 0, i) * d[0] + root(a, 1, i) * d[1];
        }
        for (int row = 0; row < local(); ++row) {
            F own[most];
            for (int column = 0; column < width; ++column) own[column] = x[row * width + column];
            for (int k = 0; k < row; ++k) {
                const F by = factor(row, k);
                for (int column = 0; column < width; ++column) own[column] = own[column] - by * x[k * width + column];
            }
            for (int column = 0; column < width; ++column) {
                x[row * width + column] = own[column];
                put(g_.panel, row * width + column, own[column]);
            }
        }
    }

    /// What is left for the joints: Rᵀ g W' R, and what plates and tips add to their right-hand sides.
    void joints() noexcept {
        const int size = joint_slips() / 2, width = joint_slips() + 1;
        const SlipElement element{size};
        float* entries = g_.element.at(0);
        for (int a = 0; a < size; ++a) {
            for (int b = 0; b <= a; ++b) {
                const int row = a < size / 2 ? 2 * a : 2 * a - size, column = b < size / 2 ? 2 * b : 2 * b - size;
                const int begin = a < size / 2 ? element.rear() : b < size / 2 ? element.across() : element.front();
                block(SlipContacts::first_joint + a, SlipContacts::first_joint + b,
                      [&](int i, int j, const F& value) { put(g_.element, begin + (row + i) * size + column + j, value); });
            }
        }
        alignas(64) float scaled[local_end * (max_joint_slips + 1) * slip_lanes];
        for (int k = 0; k < local(); ++k) {
            const F by = factor(k, k);
            for (int column = 0; column < width; ++column) (by * panel(k, column)).copy_to(scaled + (k * width + column) * slip_lanes);
        }
        const auto subtract = [&]<bool Lower>(int row, int column, int begin) {
            float* m = entries + begin * slip_lanes;
            subtract_products<local(), tile_rows<Points>, tile_columns<Points>, Lower>(
                g_.panel.at(row), width, scaled + column * slip_lanes, width, size, size, m, m);
        };
        subtract.template operator()<true>(0, 0, element.rear());
        subtract.template operator()<false>(size, 0, element.across());
        subtract.template operator()<true>(size, size, element.front());
        for (int row = 0; row < 2 * size; ++row) {
            F value(0.0f);
            for (int k = 0; k < local(); ++k) value = value - panel(k, row) * load(scaled + (k * width + 2 * size) * slip_lanes);
            put(g_.element, element.rear_side() + row, value);
        }
    }

    /// R x of one contact, and λ = φ + R x.
    void step(int contact, const F& x, const F& y) noexcept {
        for (int k = 0; k < 2; ++k) {
            const int row = 2 * contact + k;
            put(g_.next_force, row, get(g_.law_force, row) + widen(root(contact, k, 0) * x + root(contact, k, 1) * y));
        }
    }

    void collect(const V& before, const V& after, const V& residual) noexcept {
        g_.slope_before = g_.slope_after = g_.residual = 0.0;
        for (const SlipGroup::Link& link : g_.links) {
            const auto k = static_cast<std::size_t>(link.lane);
            g_.slope_before += before[k];
            g_.slope_after += after[k];
            if (!(residual[k] <= g_.residual)) g_.residual = residual[k];  // keeps what is not a number
        }
    }

    SlipRows<Points> rows_;
    SlipLaws<Points> laws_;
    SlipGroup& g_;
};

}  // namespace
}  // namespace cvtflow::model
