#pragma once
/// One step of Newton's method inside the links of a group, lanes over links. (model/friction/slip_space.hpp)

#include "model/friction/slip_law.hpp"

namespace cvtflow::model {
namespace {

/// Touching: whether a tip of the group touches; else its tips count for nothing.
template <int Points, bool Touching>
class SlipNewton : public SlipLaws<Points> {
public:
    using Base = SlipLaws<Points>;
    using V = SlipV;
    using Base::Base;

    /// λ = φ(w), all contacts.
    void forces() noexcept {
        for (int contact = 0; contact < this->contacts().count(); ++contact) {
            const V w[2] = {get(this->g_.slip, 2 * contact), get(this->g_.slip, 2 * contact + 1)};
            const SlipLaw law = this->law(contact, w);
            put(this->g_.force, 2 * contact, law.force[0]);
            put(this->g_.force, 2 * contact + 1, law.force[1]);
        }
    }

    /// Elements of the chain of joints at w.
    void eliminate() noexcept {
        linearise();
        factorise();
        panels();
        rests();
        joints();
        enter();
    }

    /// From the joints' unknowns: forces, slips of plates and tips, and this link's part of the joints' slips.
    void substitute() noexcept {
        const int points = this->points(), size = 2 * points, joints_slips = 2 * size;
        for (int contact = SlipContacts::first_joint; contact < this->contacts().count(); ++contact) {
            const int row = 2 * (contact - SlipContacts::first_joint);
            force(contact, get(this->g_.unknowns, row), get(this->g_.unknowns, row + 1));
        }
        for (int row = 0; row < joints_slips; ++row) {
            V slip = get(this->g_.joint_rest, row);
            for (int k = 0; k < joints_slips; ++k) slip = slip - symmetric(this->g_.joint_coupling, row, k) * get(this->g_.next_force, local_end + k);
            put(this->g_.own, local_end + row, slip);
        }
        substitute_local(joints_slips);
        for (int row = 0; row < local(); ++row) {
            V slip = get(this->g_.predicted, row);
            for (int k = 0; k < local(); ++k) slip = slip - coupling(row, k) * get(this->g_.next_force, k);
            for (int k = local_end; k < local_end + joints_slips; ++k) slip = slip - coupling(row, k) * get(this->g_.next_force, k);
            put(this->g_.next_slip, row, slip);
        }
    }

    /// Slope of the energy along the step at its start and at a share of it, and how far forces are off there. Joints count as rear ones.
    void look(double share) noexcept {
        V before(0.0), after(0.0), residual(0.0);
        for (int contact = 0; contact < SlipContacts::first_joint + this->points(); ++contact) {
            if (contact >= locals() && contact < SlipContacts::first_joint) continue;
            V w[2], off[2], change[2];
            for (int k = 0; k < 2; ++k) {
                const int row = 2 * contact + k;
                change[k] = get(this->g_.next_slip, row) - get(this->g_.slip, row);
                w[k] = get(this->g_.slip, row) + share * change[k];
                before += (get(this->g_.law_force, row) - get(this->g_.force, row)) * change[k];
            }
            const SlipLaw law = this->law(contact, w);
            for (int k = 0; k < 2; ++k) {
                const int row = 2 * contact + k;
                off[k] = law.force[k] - (get(this->g_.force, row) + share * (get(this->g_.next_force, row) - get(this->g_.force, row)));
                after += off[k] * change[k];
            }
            const double both = contact < SlipContacts::first_joint ? 1.0 : 2.0;
            const V give = both * larger<slip_lanes>(coupling(2 * contact, 2 * contact), coupling(2 * contact + 1, 2 * contact + 1));
            residual = larger<slip_lanes>(give * sqrt(off[0] * off[0] + off[1] * off[1]), residual);
        }
        collect(before, after, residual);
    }

private:
    static constexpr int local_end = SlipContacts::local_slips;
    static constexpr int most_joint_slips = 4 * (Points > 0 ? Points : most_joint_lanes);

    /// Contacts inside the links, and their slips: plates only where no tip touches.
    [[nodiscard]] static constexpr int locals() noexcept { return Touching ? SlipContacts::first_joint : SlipContacts::first_tip; }
    [[nodiscard]] static constexpr int local() noexcept { return 2 * locals(); }
    [[nodiscard]] static V symmetric(const LaneRows& rows, int row, int column) noexcept {
        return get(rows, row >= column ? triangle(row, column) : triangle(column, row));
    }
    [[nodiscard]] V coupling(int row, int column) const noexcept { return symmetric(this->g_.coupling, row, column); }
    [[nodiscard]] V root(int contact, int row, int column) const noexcept { return get(this->g_.root, 4 * contact + 2 * row + column); }

    void linearise() noexcept {
        for (int contact = 0; contact < this->contacts().count(); ++contact) {
            if (contact >= locals() && contact < SlipContacts::first_joint) continue;
            const V w[2] = {get(this->g_.slip, 2 * contact), get(this->g_.slip, 2 * contact + 1)};
            const SlipLaw law = this->law(contact, w);
            const V* r = law.root;
            const V x = r[0] * w[0] + r[2] * w[1], y = r[1] * w[0] + r[3] * w[1];
            for (int k = 0; k < 4; ++k) put(this->g_.root, 4 * contact + k, r[k]);
            for (int k = 0; k < 2; ++k) {
                put(this->g_.law_force, 2 * contact + k, law.force[k]);
                put(this->g_.intercept, 2 * contact + k, law.force[k] - (r[2 * k] * x + r[2 * k + 1] * y));
            }
        }
    }

    /// L Lᵀ = 1 + Rᵀ g W R of plates and tips.
    void factorise() noexcept {
        const int size = local();
        V m[triangle(local_end, 0)];
        for (int a = 0; a < locals(); ++a) {
            for (int b = 0; b <= a; ++b) {
                for (int i = 0; i < 2; ++i) {
                    const V left[2] = {rooted(a, i, 2 * b), rooted(a, i, 2 * b + 1)};
                    for (int j = 0; j < (a == b ? i + 1 : 2); ++j) m[triangle(2 * a + i, 2 * b + j)] = left[0] * root(b, 0, j) + left[1] * root(b, 1, j);
                }
            }
        }
        for (int row = 0; row < size; ++row) {
            for (int column = 0; column < row; ++column) {
                V value = m[triangle(row, column)];
                for (int k = 0; k < column; ++k) value = value - m[triangle(row, k)] * m[triangle(column, k)];
                m[triangle(row, column)] = value * m[triangle(column, column)];
            }
            V value = 1.0 + m[triangle(row, row)];
            for (int k = 0; k < row; ++k) value = value - m[triangle(row, k)] * m[triangle(row, k)];
            m[triangle(row, row)] = 1.0 / sqrt(value);   // the diagonal holds inverses
        }
        for (int k = 0; k < triangle(size, 0); ++k) put(this->g_.factor, k, m[k]);
    }
    /// Row i of R_aᵀ, times a column of g W.
    [[nodiscard]] V rooted(int contact, int i, int column) const noexcept {
        return root(contact, 0, i) * coupling(2 * contact, column) + root(contact, 1, i) * coupling(2 * contact + 1, column);
    }

    /// L⁻¹ x in place.
    void forward(V* x) const noexcept {
        for (int row = 0; row < local(); ++row) {
            V value = x[row];
            for (int k = 0; k < row; ++k) value = value - get(this->g_.factor, triangle(row, k)) * x[k];
            x[row] = value * get(this->g_.factor, triangle(row, row));
        }
    }

    /// L⁻¹ Rᵀ g W of the joints' slips, all columns side by side.
    void panels() noexcept {
        const int joints_slips = 4 * this->points();
        for (int row = 0; row < local(); ++row) {
            V x[most_joint_slips];
            for (int column = 0; column < joints_slips; ++column) x[column] = rooted(row / 2, row % 2, local_end + column);
            for (int k = 0; k < row; ++k) {
                const V factor = get(this->g_.factor, triangle(row, k));
                for (int column = 0; column < joints_slips; ++column) x[column] = x[column] - factor * get(this->g_.panel, k * joints_slips + column);
            }
            const V scale = get(this->g_.factor, triangle(row, row));
            for (int column = 0; column < joints_slips; ++column) put(this->g_.panel, row * joints_slips + column, x[column] * scale);
        }
    }

    /// L⁻¹ Rᵀ (ŵ - g W c) of plates and tips.
    void rests() noexcept {
        V t[local_end], x[local_end];
        for (int row = 0; row < local(); ++row) {
            t[row] = get(this->g_.predicted, row);
            for (int k = 0; k < local(); ++k) t[row] = t[row] - coupling(row, k) * get(this->g_.intercept, k);
        }
        for (int contact = 0; contact < locals(); ++contact) {
            for (int i = 0; i < 2; ++i) x[2 * contact + i] = root(contact, 0, i) * t[2 * contact] + root(contact, 1, i) * t[2 * contact + 1];
        }
        forward(x);
        for (int row = 0; row < local(); ++row) put(this->g_.rest, row, x[row]);
    }

    /// What is left for the joints: g W', and ŵ'.
    void joints() noexcept {
        const int joints_slips = 4 * this->points();
        const auto panel = [&](int k, int column) { return get(this->g_.panel, k * joints_slips + column); };
        for (int row = 0; row < joints_slips; ++row) {
            V value[most_joint_slips];
            for (int column = 0; column <= row; ++column) value[column] = coupling(local_end + row, local_end + column);
            V rest = get(this->g_.predicted, local_end + row);
            for (int k = 0; k < local(); ++k) {
                const V factor = panel(k, row);
                for (int column = 0; column <= row; ++column) value[column] = value[column] - factor * panel(k, column);
                rest = rest - coupling(local_end + row, k) * get(this->g_.intercept, k) - factor * get(this->g_.rest, k);
            }
            for (int column = 0; column <= row; ++column) put(this->g_.joint_coupling, triangle(row, column), value[column]);
            put(this->g_.joint_rest, row, rest);
        }
    }

    /// Rᵀ g W' R and Rᵀ (ŵ' - g W' c), link by link into the chain's elements.
    void enter() noexcept {
        const int contacts = 2 * this->points(), joints_slips = 2 * contacts, size = contacts, first = SlipContacts::first_joint;
        const int width = 2 * SlipElement::block(size);
        const auto column = [&](int slip) { return slip < size ? slip : SlipElement::block(size) + slip - size; };
        for (int a = 0; a < contacts; ++a) {
            V t[2];
            for (int k = 0; k < 2; ++k) {
                t[k] = get(this->g_.joint_rest, 2 * a + k);
                for (int l = 0; l < joints_slips; ++l) t[k] = t[k] - symmetric(this->g_.joint_coupling, 2 * a + k, l) * get(this->g_.intercept, local_end + l);
            }
            for (int i = 0; i < 2; ++i) {
                put(this->g_.entries, (2 * a + i) * width + size, root(first + a, 0, i) * t[0] + root(first + a, 1, i) * t[1]);
                for (int b = 0; b <= a; ++b) {
                    V left[2];
                    for (int l = 0; l < 2; ++l)
                        left[l] = root(first + a, 0, i) * symmetric(this->g_.joint_coupling, 2 * a, 2 * b + l) + root(first + a, 1, i) * symmetric(this->g_.joint_coupling, 2 * a + 1, 2 * b + l);
                    for (int j = 0; j < 2; ++j) {
                        const V value = left[0] * root(first + b, 0, j) + left[1] * root(first + b, 1, j);
                        put(this->g_.entries, (2 * a + i) * width + column(2 * b + j), value);
                        if (b < a) put(this->g_.entries, (2 * b + j) * width + column(2 * a + i), value);
                    }
                }
            }
        }
        for (int row = 0; row < joints_slips; ++row) {
            for (int begin = 0; begin < width; begin += slip_lanes) scatter(row, begin, row * width + begin);
        }
    }

    /// Columns [begin, begin + 8) of a row to each link's element. @param entry of the first
    template <int W = slip_lanes>
    void scatter(int row, int begin, int entry) noexcept {
        const int links = this->g_.last - this->g_.first;
        if constexpr (W <= native_lanes) {
            Lanes<W> values[W];
            for (int k = 0; k < W; ++k) values[k] = get(this->g_.entries, entry + k);
            transpose<W>(values);
            for (int lane = 0; lane < links; ++lane) values[lane].copy_to(this->g_.chain.elements[static_cast<std::size_t>(lane)].row(row) + begin);
        } else {
            for (int lane = 0; lane < links; ++lane) {
                double* to = this->g_.chain.elements[static_cast<std::size_t>(lane)].row(row) + begin;
                for (int k = 0; k < W; ++k) to[k] = this->g_.entries.at(entry + k)[lane];
            }
        }
    }

    /// λ = R x + c of one contact.
    void force(int contact, const V& x, const V& y) noexcept {
        for (int k = 0; k < 2; ++k) put(this->g_.next_force, 2 * contact + k, root(contact, k, 0) * x + root(contact, k, 1) * y + get(this->g_.intercept, 2 * contact + k));
    }

    void substitute_local(int joints_slips) noexcept {
        V y[local_end];
        for (int row = local() - 1; row >= 0; --row) {
            y[row] = get(this->g_.rest, row);
            for (int k = 0; k < joints_slips; ++k) y[row] = y[row] - get(this->g_.panel, row * joints_slips + k) * get(this->g_.next_force, local_end + k);
            for (int k = row + 1; k < local(); ++k) y[row] = y[row] - get(this->g_.factor, triangle(k, row)) * y[k];
            y[row] = y[row] * get(this->g_.factor, triangle(row, row));
        }
        for (int contact = 0; contact < locals(); ++contact) force(contact, y[2 * contact], y[2 * contact + 1]);
    }

    void collect(const V& before, const V& after, const V& residual) noexcept {
        this->g_.slope_before = this->g_.slope_after = this->g_.residual = 0.0;
        for (int lane = 0; lane < this->g_.last - this->g_.first; ++lane) {
            const auto k = static_cast<std::size_t>(lane);
            this->g_.slope_before += before[k];
            this->g_.slope_after += after[k];
            if (!(residual[k] <= this->g_.residual)) this->g_.residual = residual[k];   // keeps what is not a number
        }
    }
};

}  // namespace
}  // namespace cvtflow::model
