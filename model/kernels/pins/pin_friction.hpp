#pragma once
/// Friction of whole pins as a function of velocities, lanes over pins: two tips each, plates of the link behind which a pin lies. Every
/// lane does the same operations in the same order whatever its neighbours are. (model/EQUATIONS.md sections 4, 6, 7 and 10)

#include "model/contact/contact_field.hpp"
#include "model/contact/friction_sinks.hpp"
#include "model/force/tips.hpp"
#include "model/kernels/pins/pin_rows.hpp"
#include "model/law/sliding.hpp"

namespace cvtflow::model {
namespace {

/// W pins side by side. Column numbers count from the first pin of the range.
template <int P, int W, bool Steepest>
class PinFriction {
public:
    using V = Lanes<W>;
    using Tip = ContactComponents::Tip;
    static constexpr int n = P + 1;
    static constexpr const ChainLayout& at = pin_at<P>;
    /// Rows of scratch: forces of tips, their moment, what plates of the link behind do to z and e of the pin that follows.
    static constexpr int moment_row = at.link_size(), plates_row = moment_row + 1, scratch_rows = plates_row + 2;

    PinFriction(const FrictionOperator& friction, const ContactField& field, const FrictionRange& range) noexcept
        : friction_(friction),
          c_(friction.chain().coefficients()),
          field_(field),
          range_(range),
          stride_(FrictionOperator::joint_stride(range.last - range.first)) {}

    /// Tips and plates of pins first + own … + W - 1, own ≥ -1, to scratch.
    void forces(int own, const FrictionStage& stage) const noexcept {
        plates(own);
        V f[at.link_size() + 1];
        for (V& row : f) row = V(0.0);
        if (touching(own)) tips(own, f, stage);
        for (int row = 0; row <= at.link_size(); ++row) put(row, own, f[row]);
    }

    /// Slopes of pins first + own … + W - 1; forces of these and of their neighbours must be in scratch.
    void pins(int own, const FrictionStage& stage) const noexcept {
        V f[at.link_size()];
        for (int row = 0; row < at.link_size(); ++row) f[row] = scratch(row, own);
        for (int k = 0; k < 2; ++k) f[2 * n + k] += scratch(plates_row + k, own - 1) - scratch(plates_row + k, own);
        const Plane<V> couple_before = couple(own - 1), couple_behind = couple(own);
        f[at.x(End::rear, 0)] += couple_before.x - couple_behind.x;
        f[at.y(End::rear, 0)] += couple_before.y - couple_behind.y;
        accelerate_pins<P, W>(friction_.chain().inertia(), f);
        if (stage.next == nullptr) return give(f, SlopeSink<W>{stage.slope->at(0, column(own)), stage.slope->stride(), W});
        if (stage.next->terms <= 2) return give(f, RowSink<W, 2>(stage, *stage.next, column(own), W));
        give(f, RowSink<W, VelocityRow::most_terms>(stage, *stage.next, column(own), W));
    }

private:
    struct Slip {
        V x, y, z;
        [[nodiscard]] V square() const noexcept { return x * x + y * y + z * z; }
    };

    [[nodiscard]] int column(int own) const noexcept { return range_.first + own + range_.shift; }
    [[nodiscard]] V velocity(int row, int own) const noexcept { return load<W>(range_.velocity + row * range_.stride + own + 1); }
    [[nodiscard]] V contact(int row, int own) const noexcept { return load<W>(field_.columns.at(row, column(own))); }
    [[nodiscard]] V scratch(int row, int own) const noexcept { return load<W>(range_.scratch + row * stride_ + own + 1); }
    void put(int row, int own, const V& lanes) const noexcept { lanes.copy_to(range_.scratch + row * stride_ + own + 1); }

    /// Couple of the moment on the line from pin own to the one that follows, on the latter.
    [[nodiscard]] Plane<V> couple(int own) const noexcept {
        const V moment = 0.5 * (scratch(moment_row, own) + scratch(moment_row, own + 1));
        const V each = moment * contact(ContactComponents::inverse_length, own);
        return {-(each * contact(ContactComponents::frame_y, own)), each * contact(ContactComponents::frame_x, own)};
    }

    [[nodiscard]] V turning(int own) const noexcept {
        constexpr int x = at.x(End::rear, 0), y = at.y(End::rear, 0);
        return (contact(ContactComponents::frame_x, own) * (velocity(y, own + 1) - velocity(y, own)) -
                contact(ContactComponents::frame_y, own) * (velocity(x, own + 1) - velocity(x, own))) *
               contact(ContactComponents::inverse_length, own);
    }

    void plates(int own) const noexcept {
        constexpr int z = at.z(End::rear), e = at.e(End::rear);
        const V gap_z = velocity(z, own + 1) - velocity(z, own), gap_e = velocity(e, own + 1) - velocity(e, own);
        V fz(0.0), fe(0.0);
        for (int j = 0; j < field_.components.plates; ++j) {
            const double xi = c_.plates.position[static_cast<std::size_t>(j)];
            const V slide = contact(field_.components.plate(j), own) * sliding_share<W, Steepest>(c_.plate_friction, gap_z + xi * gap_e);
            fz += slide;
            fe += xi * slide;
        }
        put(plates_row, own, -fz);
        put(plates_row + 1, own, -fe);
    }

    /// Whether a tip of the pins side by side touches.
    [[nodiscard]] bool touching(int own) const noexcept {
        std::uint32_t any = 0;
        for (int pin = 0; pin < W; ++pin)
            any |= phase_word(range_.phases + tips_per_link * friction_.chain().layout().wrapped(range_.first + own + pin));
        return any != 0;
    }

    /// @param f coordinates of the pin, and the moment on its bisector
    void tips(int own, V* f, const FrictionStage& stage) const noexcept {
        const V turn = 0.5 * (turning(own - 1) + turning(own));
        V even[2], odd[2];  // of x and y
        for (int axis = 0; axis < 2; ++axis) {
            even[axis] = velocity(n * axis, own);
            odd[axis] = V(0.0);
            for (int m = 1; m < n; ++m) (m % 2 == 0 ? even : odd)[axis] += velocity(n * axis + m, own);
        }
        const V z = velocity(at.z(End::rear), own), e = velocity(at.e(End::rear), own);
        const Slip low = slip(own, 0, {even[0] - odd[0], even[1] - odd[1], z - e}, turn),
                   high = slip(own, 1, {even[0] + odd[0], even[1] + odd[1], z + e}, turn);
        const auto [factor_low, factor_high] = factors(own, low.square(), high.square());
        V& moment = f[moment_row];
        const Slip below = force(own, 0, low, factor_low, moment, stage), above = force(own, 1, high, factor_high, moment, stage);
        for (int m = 0; m < n; ++m) {
            f[m] += m % 2 == 0 ? below.x + above.x : above.x - below.x;
            f[n + m] += m % 2 == 0 ? below.y + above.y : above.y - below.y;
        }
        f[at.z(End::rear)] += below.z + above.z;
        f[at.e(End::rear)] += above.z - below.z;
    }

    /// Velocity of a tip along its sheave's surface. @param v of the pin's end
    [[nodiscard]] Slip slip(int own, int corner, Slip v, const V& turn) const noexcept {
        const int row = field_.components.tip(corner);
        const V gx = contact(row + Tip::normal, own), gy = contact(row + Tip::normal + 1, own), gz = contact(row + Tip::normal + 2, own);
        v.x = v.x - turn * contact(row + Tip::lever_y, own);
        v.y = v.y + turn * contact(row + Tip::lever_x, own);
        if constexpr (!Steepest) {
            v.x = v.x - contact(row + Tip::sheave, own) - range_.time * contact(row + Tip::drift, own);
            v.y = v.y - contact(row + Tip::sheave + 1, own) - range_.time * contact(row + Tip::drift + 1, own);
            v.z = v.z - contact(row + Tip::sheave + 2, own) - range_.time * contact(row + Tip::drift + 2, own);
        }
        const V along = v.x * gx + v.y * gy + v.z * gz;
        return {v.x - along * gx, v.y - along * gy, v.z - along * gz};
    }

    [[nodiscard]] Slip force(int own, int corner, const Slip& slip, const V& factor, V& moment, const FrictionStage& stage) const noexcept {
        const int row = field_.components.tip(corner);
        const V grip = -contact(row + Tip::grip, own) * factor;
        const Slip force{grip * slip.x, grip * slip.y, grip * slip.z};
        moment += contact(row + Tip::lever_x, own) * force.y - contact(row + Tip::lever_y, own) * force.x;
        if (stage.impulses != nullptr) {
            add(own, stage.weight * force.x, stage.impulses->at(3 * corner, column(own)));
            add(own, stage.weight * force.y, stage.impulses->at(3 * corner + 1, column(own)));
            add(own, stage.weight * force.z, stage.impulses->at(3 * corner + 2, column(own)));
        }
        return force;
    }

    /// Adds the lanes of the range's own pins to what is there.
    void add(int own, const V& lanes, double* to) const noexcept {
        const int links = range_.last - range_.first;
        if (own >= 0 && own + W <= links) return V(load<W>(to) + lanes).copy_to(to);
        for (int lane = std::max(0, -own); lane < std::min(W, links - own); ++lane) to[lane] += lanes[static_cast<std::size_t>(lane)];
    }

    [[nodiscard]] std::pair<V, V> factors(int own, const V& first, const V& second) const noexcept {
        if (Steepest || !friction_.by_phase()) return sliding_factors<W, Steepest>(c_.tip.friction, first, second);
        const auto bounded = [&](int corner, const V& square) {
            const int row = field_.components.tip(corner);
            return larger<W>(smaller<W>(sqrt(square), contact(row + Tip::most, own)), contact(row + Tip::least, own));
        };
        return {1.0 / bounded(0, first), 1.0 / bounded(1, second)};
    }

    template <class Sink>
    static void give(const V* acceleration, const Sink& to) noexcept {
        for (int row = 0; row < at.link_size(); ++row) to.put(row, acceleration[row]);
    }

    const FrictionOperator& friction_;
    const Coefficients& c_;
    const ContactField& field_;
    const FrictionRange& range_;
    std::ptrdiff_t stride_;
};

}  // namespace
}  // namespace cvtflow::model
