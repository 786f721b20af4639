#pragma once
/// What a group of links knows of its contacts, in rows of lanes: gathered once per step, read by slips, forces and the coupling alike.

#include "model/contact/slip/slip_space.hpp"
#include "model/contact/slip/slip_tiles.hpp"

namespace cvtflow::model {
namespace {

using SlipV = Lanes<slip_lanes>;

[[nodiscard]] inline SlipV get(const LaneRows& rows, int row) noexcept { return load<slip_lanes>(rows.at(row)); }
inline void put(LaneRows& rows, int row, const SlipV& value) noexcept { value.copy_to(rows.at(row)); }

/// Whatever the order of the links, so that it is compiled once for all of them.
/// Points: of a joint, a constant for the compiler; 0: read from the space.
template <int Points>
class SlipRows {
public:
    using V = SlipV;
    using Tip = SlipGroup::Tip;
    using Point = SlipGroup::Point;

    SlipRows(const SlipSpace& space, SlipGroup& group) noexcept : space_(space), c_(space.chain().coefficients()), g_(group) {}

    [[nodiscard]] int points() const noexcept { return Points > 0 ? Points : space_.contacts().points; }
    [[nodiscard]] SlipContacts contacts() const noexcept { return {points()}; }
    [[nodiscard]] static int tip_row(int corner, int row) noexcept { return Tip::count * corner + row; }
    [[nodiscard]] int point_row(End end, int point, int row) const noexcept {
        return Point::count * ((end == End::rear ? 0 : points()) + point) + row;
    }
    [[nodiscard]] V point(End end, int number, int row) const noexcept { return get(g_.joints, point_row(end, number, row)); }
    [[nodiscard]] V tip_value(int corner, int row) const noexcept { return get(g_.tips, tip_row(corner, row)); }

    void gather(const ContactField& field, const Phase* phases) noexcept {
        const auto from = [&](int row, int shift) { return gathered(field, row, shift); };
        const V present = get(g_.present, 0);
        put(g_.frame, 0, from(ContactComponents::frame_x, 0));
        put(g_.frame, 1, from(ContactComponents::frame_y, 0));
        const V inverse_length = from(ContactComponents::inverse_length, 0);
        for (int point = 0; point < points(); ++point) {
            using Joint = ContactComponents::Joint;
            const int row = field.components.joint(point);
            for (const End end : {End::rear, End::front}) {
                const int shift = end == End::rear ? 0 : 1;
                put(g_.joints, point_row(end, point, Point::normal_x), from(row + Joint::normal_x, shift));
                put(g_.joints, point_row(end, point, Point::normal_y), from(row + Joint::normal_y, shift));
                put(g_.joints, point_row(end, point, Point::lever),
                    inverse_length * from(row + (end == End::rear ? Joint::lever_after : Joint::lever_before), shift));
                put(g_.joints, point_row(end, point, Point::friction_limit), present * from(row + Joint::friction_limit, shift));
            }
        }
        for (int plate = 0; plate < c_.plates.count; ++plate) put(g_.plates, plate, present * from(field.components.plate(plate), 0));
        g_.touching = false;
        for (const SlipGroup::Link& link : g_.links) {
            for (int corner = 0; corner < tips_per_link; ++corner)
                g_.touching = g_.touching || phases[tips_per_link * link.number + corner] != Phase::free;
        }
        if (!g_.touching) return;
        for (int corner = 0; corner < tips_per_link; ++corner) tip(field, corner, inverse_length);
    }

private:
    /// A component of the field at the links of the group, or so many links further.
    [[nodiscard]] V gathered(const ContactField& field, int row, int shift) const noexcept {
        alignas(64) double values[slip_lanes];
        const double* from = field.columns.at(row, shift);
        for (int lane = 0; lane < slip_lanes; ++lane) values[lane] = from[g_.column[static_cast<std::size_t>(lane)]];
        return load<slip_lanes>(values);
    }

    /// Two tangents of the sheave, whatever the direction of its normal. (Duff et al., J. Comput. Graph. Tech. 6, 2017)
    void tip(const ContactField& field, int corner, const V& inverse_length) noexcept {
        using From = ContactComponents::Tip;
        const int row = field.components.tip(corner);
        const auto from = [&](int number) { return gathered(field, row + number, 0); };
        V x = from(From::normal), y = from(From::normal + 1), z = from(From::normal + 2);
        const V scale = 1.0 / sqrt(larger<slip_lanes>(x * x + y * y + z * z, V(1e-300)));
        x = scale * x;
        y = scale * y;
        z = scale * z;
        const V sign = select_greater<slip_lanes>(z, V(0.0), V(1.0), V(-1.0));
        const V a = -1.0 / (sign + z);
        const V b = x * y * a;
        const V tangents[2][3] = {{1.0 + sign * x * x * a, sign * b, -(sign * x)}, {b, sign + y * y * a, -y}};
        for (int k = 0; k < 2; ++k) {
            const V* t = tangents[k];
            for (int axis = 0; axis < 3; ++axis) put(g_.tips, tip_row(corner, Tip::tangent + 3 * k + axis), t[axis]);
            put(g_.tips, tip_row(corner, Tip::lever + k), inverse_length * (t[1] * from(From::lever_x) - t[0] * from(From::lever_y)));
            put(g_.tips, tip_row(corner, Tip::sheave + k),
                t[0] * from(From::sheave) + t[1] * from(From::sheave + 1) + t[2] * from(From::sheave + 2));
            put(g_.tips, tip_row(corner, Tip::drift + k),
                t[0] * from(From::drift) + t[1] * from(From::drift + 1) + t[2] * from(From::drift + 2));
        }
        put(g_.tips, tip_row(corner, Tip::friction_limit), get(g_.present, 0) * from(From::friction_limit));
        put(g_.tips, tip_row(corner, Tip::sticks),
            space_.friction().by_phase() ? select_greater<slip_lanes>(from(From::most), V(1e100), V(0.0), V(1.0)) : V(0.0));
    }

    const SlipSpace& space_;
    const Coefficients& c_;
    SlipGroup& g_;
};

}  // namespace
}  // namespace cvtflow::model
