#pragma once
/// Temperatures of pulleys with chain, and of the oil around them, by a lumped heat balance of the losses. (model/EQUATIONS.md section 12)

#include <array>

#include "model/parameters/chain_layout.hpp"
#include "model/parameters/parameters.hpp"

namespace cvtflow::model {

class HeatBalance {
public:
    /// Sets all temperatures to the oil's, as in a settled machine.
    /// @param steady  searches the steady temperatures, which do not depend on capacities: these become small
    void restart(const Parameters& parameters, bool steady = false) noexcept;
    /// Adds the heat of the losses since the last call. Before t = 0 temperatures are constant. time [s], lost: losses so far, by kind [J]
    void advance(double time, const std::array<double, loss_kinds>& lost) noexcept;

    [[nodiscard]] bool enabled() const noexcept { return heat_.enabled; }
    [[nodiscard]] double pulleys() const noexcept { return m_.pulleys; }  ///< [K]
    [[nodiscard]] double oil() const noexcept { return m_.oil; }          ///< [K]
    /// Temperature of the film between tips and sheaves: mean of both [K].
    [[nodiscard]] double film() const noexcept { return 0.5 * (m_.pulleys + m_.oil); }
    [[nodiscard]] double given() const noexcept { return m_.given; }  ///< heat of the losses since t = 0 [J]
    [[nodiscard]] double taken() const noexcept { return m_.taken; }  ///< heat that ambient has received since t = 0 [J]
    [[nodiscard]] double stored() const noexcept;                     ///< heat stored since t = 0 [J]

    /// Calls field(name, number) for all that a state has to keep; none if the balance is off.
    template <class Field>
    void visit(Field& field) {
        if (!heat_.enabled) return;
        field("heat_time", m_.time), field("temperature_pulleys", m_.pulleys), field("temperature_oil", m_.oil);
        field("heat_lost_by_tips", m_.lost_by_tips), field("heat_lost_else", m_.lost_else);
        field("heat_given", m_.given), field("heat_taken", m_.taken);
    }
    /// Whether temperatures, which come from a state, are possible.
    [[nodiscard]] bool valid() const noexcept;

private:
    struct Memory {
        double time, pulleys, oil;       ///< [s], [K], [K]
        double lost_by_tips, lost_else;  ///< losses at that time [J]
        double given, taken;             ///< [J]
    };
    Heat heat_;
    double start_ = 0.0;  ///< temperature at t = 0 [K]
    Memory m_{};
};

}  // namespace cvtflow::model
