#pragma once
/// Temperatures of pulleys with chain, and of the oil around them, by a lumped heat balance of the losses. (model/EQUATIONS.md section 12)

#include <array>
#include <span>
#include <vector>

#include "model/parameters/chain_layout.hpp"
#include "model/parameters/parameters.hpp"

namespace cvtflow::model {

class HeatBalance {
public:
    /// Sets all temperatures to the oil's, as in a settled machine.
    /// @param steady  searches the steady temperatures, which do not depend on capacities: these become small
    void restart(const Parameters& parameters, bool steady = false) noexcept;
    /// Adds the heat of the losses since the last call. Before t = 0 temperatures are constant.
    /// time [s], lost: losses so far, by kind [J]
    void advance(double time, const std::array<double, loss_kinds>& lost) noexcept;

    [[nodiscard]] bool enabled() const noexcept { return heat_.enabled; }
    [[nodiscard]] double pulleys() const noexcept { return m_.pulleys; }  ///< [K]
    [[nodiscard]] double oil() const noexcept { return m_.oil; }          ///< [K]
    /// Temperature of the film between tips and sheaves: mean of both [K].
    [[nodiscard]] double film() const noexcept { return 0.5 * (m_.pulleys + m_.oil); }
    [[nodiscard]] double given() const noexcept { return m_.given; }  ///< heat of the losses since t = 0 [J]
    [[nodiscard]] double taken() const noexcept { return m_.taken; }  ///< heat that ambient has received since t = 0 [J]
    [[nodiscard]] double stored() const noexcept;                     ///< heat stored since t = 0 [J]

    /// Writes the memory of saved states; empty if the balance is off.
    void save(std::vector<double>& memory) const;
    /// @return false for a malformed memory
    [[nodiscard]] bool load(std::span<const double> memory) noexcept;

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
