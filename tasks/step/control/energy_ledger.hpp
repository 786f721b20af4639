#pragma once
/// Energy balance of an integration: works of the inputs, losses by kind, what is stored, and whether they agree.
///
/// Works are exact sums over all steps: mean input times displacement. Losses are powers of the contact and damping laws at the states that
/// the method produced, sampled at regular intervals of steps and integrated by the trapezoidal rule. They are computed independently of
/// the works. A method that creates or destroys energy therefore shows a residual. After a window of time whose residual could be noise of
/// sampling alone, samples are closer in the next one. (DECISIONS 74)

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/archive.hpp"
#include "model/force/account.hpp"
#include "model/force/pulley.hpp"

namespace cvtflow::model {
class Variator;
}

namespace cvtflow::tasks {

/// ΔE - W + L over a span of time, and its tolerance.
struct EnergyBalance {
    double span = 0.0;       ///< [s]
    double change = 0.0;     ///< change of the stored energy [J]
    double work = 0.0;       ///< work of the inputs [J]
    double loss = 0.0;       ///< dissipated [J]
    double energy_in = 0.0;  ///< works of the inputs, each interval's positive ones [J]
    double stored = 0.0;     ///< largest energy that the chain held [J]
    double deviation = 0.0;  ///< standard error of `loss` from sampling [J]
    double samples = 0.0;    ///< number of samples of the losses

    [[nodiscard]] double residual() const noexcept { return change - work + loss; }
    /// |residual| over the losses.
    [[nodiscard]] double relative() const noexcept;
    /// Residual that accurate steps may leave [J].
    [[nodiscard]] double expected_residual() const noexcept;
    /// |residual| over its tolerance, which is expected_residual() plus the error of sampling: more than 1 means wrong results. 0 for so
    /// few samples that their noise is not known; not a number is infinite. @param settling of a start, which begins with a shock
    [[nodiscard]] double balance_error_ratio(bool settling = false) const noexcept;
};

/// Energies that flow through a machine in a time: an efficiency is made of these, whatever the time. [J]
struct EnergyFlow {
    double lost = 0.0, clamping = 0.0;  ///< losses; work of the clamping, or of the pump in its place
    std::array<double, 2> shaft{};      ///< works of drive and load; negative: taken out

    /// Flow with the work and the losses of a pump that feeds the clamping [J]. Without work there is no pump.
    [[nodiscard]] EnergyFlow with_pump(double work, double loss) const noexcept;
    /// Sum of the positive works.
    [[nodiscard]] double input() const noexcept;
    /// Energy taken out by shafts, not by a cylinder.
    [[nodiscard]] double taken() const noexcept;
    /// Whether shafts take less than a hundredth of the input.
    [[nodiscard]] bool no_load() const noexcept;
    /// 1 - losses/input. Not a number where no energy flows: without input, without load, and where more is lost than comes in, since what
    /// moves gives it then.
    [[nodiscard]] double efficiency() const noexcept;
};

/// Energies since the integration began.
struct EnergySums {
    double time = 0.0;                             ///< [s]
    std::array<double, model::loss_kinds> loss{};  ///< losses by kind [J]
    model::WorkRates work{};                       ///< works by input [J]
    std::array<double, 2> drag{};                  ///< energies taken by seals, bearings and oil of the shafts before `work` [J]

    [[nodiscard]] double lost() const noexcept;
    /// Linear between two sums, at a time between theirs. time [s]
    [[nodiscard]] static EnergySums between(const EnergySums& from, const EnergySums& to, double time) noexcept;
    /// Energies through the variator since `before`.
    [[nodiscard]] EnergyFlow since(const EnergySums& before) const noexcept;
    /// Energies from outside to outside since `before`: with the works before the drag of the shafts, which is a loss.
    [[nodiscard]] EnergyFlow outside_since(const EnergySums& before) const noexcept;
};

/// Energies of the couplings of both shafts so far: work of their far ends, and their losses.
struct CouplingSums {
    std::array<double, 2> work{}, dissipated{};  ///< [J]
};

/// Energies that seals, bearings and oil have taken from both shafts so far.
struct DragSums {
    std::array<double, 2> energy{};   ///< [J]
    std::array<double, 2> impulse{};  ///< impulse of the torque [N·m·s]
};

/// Work of the inputs since the integration began.
struct InputWorks {
    model::WorkRates work{};          ///< works by input [J]
    std::array<double, 2> impulse{};  ///< impulse of the torques of drive and load on both shafts [N·m·s]
    DragSums drag;
    CouplingSums couplings;

    /// Impulse of the torques on the shafts behind the drag [N·m·s].
    [[nodiscard]] std::array<double, 2> net_impulse() const noexcept {
        return {impulse[0] - drag.impulse[0], impulse[1] - drag.impulse[1]};
    }

    /// Adds a step. @param begin, end of the step [s]   @param from, to states behind the links there   @param mean inputs of the step
    void add(const model::PulleyModel& pulleys, double begin, const double* from, double end, const double* to,
             const model::Inputs& mean) noexcept;
};

/// Energies that a method counts itself, in every step: sums since the integration began, and what is stored now.
struct EnergyAccount : InputWorks {
    std::array<double, model::loss_kinds> lost{};  ///< [J]
    double stored = 0.0;                           ///< [J]
};

/// Ring buffer of the sums at the outputs of the last pin period.
class PastSums {
public:
    /// Forgets what lies more than a pin period back, but for the last such output, and keeps this one. pin_period [s]
    void remember(const EnergySums& now, double pin_period) noexcept;
    /// Sums one pin period before `time` [s], or at the first output kept; none before the first output. pin_period [s]
    [[nodiscard]] std::optional<EnergySums> before(double time, double pin_period) const noexcept;
    void visit(engine::Archive& archive);

private:
    static constexpr std::size_t max_count = 80, per_period = 64;

    [[nodiscard]] std::size_t place(double number) const noexcept;    ///< index of output `number`, counted from the oldest
    [[nodiscard]] double outputs_before(double time) const noexcept;  ///< time [s]
    [[nodiscard]] double period_begin(double time, double pin_period) const noexcept;  ///< last output a period or more before `time` [s]

    std::array<EnergySums, max_count> sums_;
    double begin_, count_;  ///< index and number of what is kept [1]
};

/// Sums of a ledger at one of its samples, from which later balances may count. Numbers only.
struct EnergyMark {
    double begin = 0.0, loss = 0.0, work = 0.0, stored = 0.0, energy_in = 0.0, noise = 0.0, samples = 0.0;  ///< [s], [J], samples [1]
};

/// A balance that was judged. Numbers only.
struct JudgedBalance {
    double ratio = 0.0;                                         ///< |residual| over its tolerance [1]
    double begin = 0.0, end = 0.0, relative = 0.0, loss = 0.0;  ///< [s]; residual over loss [1], [J]
};

class EnergyLedger {
public:
    /// Least time after which a balance is judged by itself [s]: what went wrong once is not forgotten in what follows. Where energies are
    /// counted it is a pin period, if that is longer, as pins that strike their sheaves store energy, and `longest_window` at most. Sampled
    /// losses are judged sooner: a residual that noise can explain makes the next window's samples lie closer.
    static constexpr double window = 2e-3, longest_window = 0.1;
    /// Time after a jump, the beginning among them, in which samples lie closer [s].
    static constexpr double dense_time = 5e-4;
    static constexpr double closer = 8.0;  ///< factor by which samples lie closer in dense sampling

    /// A new integration begins. @param stride steps between samples of the losses (StepMethod::observation_stride)
    void restart(long stride) noexcept;
    /// false: nothing is kept from the next restart on, to measure what keeping costs.
    void keep(bool on) noexcept { on_ = on; }
    /// Inputs may be others than at the end of the last step. @param densely  they have been changed from outside at `time`: losses are
    /// sampled densely for a while, unless that has just been so
    void inputs_changed(double time, bool densely) noexcept;
    /// A method counts works and losses itself, from its restart() on and in every step. @return where
    [[nodiscard]] EnergyAccount& count() noexcept {
        counted_ = true;
        return account_;
    }
    /// Whether one does: no losses need to be sampled, and they have no noise.
    [[nodiscard]] bool counted() const noexcept { return counted_; }
    /// Adds a step. @param begin, end of the step [s]   @param from, to states behind the links there, which begin at pulley_begin()
    void step(const model::Variator& variator, double begin, const double* from, double end, const double* to) noexcept;
    /// Whether losses should be sampled before the next step. Samples and outputs that are near each other are at one instant, since one
    /// evaluation of the chain then serves both. time [s]   @param to_output steps to the next output, 0 at one [1]
    [[nodiscard]] bool due(double time, double to_output) const noexcept;
    /// Steps between two samples [1].
    [[nodiscard]] double stride() const noexcept { return m_.dense_sampling != 0.0 ? std::max(1.0, stride_ / closer) : stride_; }
    /// Adds the sample of an observe cycle. @param links, pulleys their losses and energies, kinetic energy included
    /// @param pin_period time that a pin takes to the place of the next one; 0: none [s]
    void sample(double time, const model::Account& links, const model::Account& pulleys, double pin_period) noexcept;
    /// Adds a sample from the account that a method counts. time [s], pin_period [s]
    void sample_counted(double time, double pin_period) noexcept;
    /// An output is due: closes the interval since the last one. @param momentum of the shafts [N·m·s]
    void output(double time, const std::array<double, 2>& momentum) noexcept;

    /// Sums at `time` ≥ the last sample; losses continue at their last rate. time [s]
    [[nodiscard]] EnergySums sums(double time) const noexcept;
    /// Mark at the last sample.
    [[nodiscard]] EnergyMark mark() const noexcept { return m_.here(); }
    /// Balance from a mark of this ledger, or the beginning, to the last sample.
    [[nodiscard]] EnergyBalance balance(const std::optional<EnergyMark>& from = {}) const noexcept {
        return m_.balance_since(from.value_or(m_.all));
    }
    /// The balance that is farthest from closing: of all windows, of the present one and of the whole since a mark, or the beginning.
    [[nodiscard]] JudgedBalance judged(const std::optional<EnergyMark>& from = {}) const noexcept;
    /// Its ratio; > 1: the results are wrong.
    [[nodiscard]] double balance_error_ratio(const std::optional<EnergyMark>& from = {}) const noexcept { return judged(from).ratio; }

    /// Mean torque of the chain on the sheaves of each shaft since the output before `time`, which is now: their change of momentum less
    /// the outside's impulse [N·m]. Not a number at the first output and before. Does not change the ledger: results do not depend on when
    /// a host calls it.
    /// @param time [s]   @param momentum of the shafts now [N·m·s]
    [[nodiscard]] std::array<double, 2> chain_torque(double time, const std::array<double, 2>& momentum) const noexcept;
    /// Sums a whole pin period before now, less where a run has not lasted so long; none at the first output and before. time: now [s]
    [[nodiscard]] std::optional<EnergySums> sums_before(double time) const noexcept { return m_.past.before(time, m_.pin_period); }

    [[nodiscard]] const InputWorks& input_works() const noexcept { return m_.inputs; }

    /// All that a state has to keep. Reading follows restart().
    void visit(engine::Archive& archive);

private:
    /// Numbers only.
    struct Memory {
        double samples, sampled, steps;                     ///< number of samples; time of the last one [s]; steps since
        double jumped;                                      ///< time of the last jump of inputs or state, or of the beginning [s]
        std::array<double, model::loss_kinds> power, loss;  ///< [W], [J]
        std::array<double, 4> powers;                       ///< powers of the last samples, latest first, for the noise of sampling [W]
        double stored, max_stored, noise, energy_in, pin_period;  ///< [J], pin_period in s
        InputWorks inputs;
        model::WorkRates work_sampled;
        std::array<double, 2> impulse_output, momentum_output;  ///< [N·m·s]
        std::array<double, 2> chain_torque;                     ///< [N·m]
        double outputs, output_time;                            ///< [1, s]
        EnergyMark all, part;                                   ///< begins of the judged spans: all, and the present window
        JudgedBalance worst;                                    ///< of the windows that are closed
        double dense_sampling;                                  ///< 1 while samples lie close [1]
        double judged_from;  ///< windows that begin earlier do not count: the start of settling (t < 0) [s]
        PastSums past;       ///< sums at outputs

        void add_noise(double power, double spacing) noexcept;
        [[nodiscard]] std::array<double, 2> torque_since_output(double time, const std::array<double, 2>& momentum) const noexcept;
        [[nodiscard]] EnergyMark here() const noexcept;
        [[nodiscard]] EnergyBalance balance_since(const EnergyMark& span) const noexcept;
        [[nodiscard]] JudgedBalance judge(const EnergyMark& span) const noexcept;
        /// Everything about a sample is known but for its consequences. time [s]; length of a window [s]
        void close_sample(double time, double length) noexcept;
        void close_window() noexcept;
    };

    Memory m_{};
    model::Inputs inputs_;  ///< inputs at the end of the last step
    bool known_ = false;
    bool on_ = true, counted_ = false;
    EnergyAccount account_;
    double stride_ = 24.0;  ///< steps between samples [1]
};

}  // namespace cvtflow::tasks
