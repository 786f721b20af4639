#pragma once
/// Means of a run over its outputs, over all of it and over its first and last fifth, and what is odd about them. Memory does not grow with
/// the run.

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/observe/observation.hpp"
#include "tasks/step/control/energy_ledger.hpp"

namespace cvtflow::tasks {

/// Means over a span of time; zero where nothing was seen.
struct SpanMeans {
    double begin = 0.0, end = 0.0;        ///< [s]
    double ratio = 0.0, slip = 0.0;       ///< [1]
    double friction_slip = 0.0;           ///< [1]
    double loss_slip = 0.0;               ///< power lost by creep over the power of shafts that bring any; 0 where none does [1]
    double tight = 0.0, slack = 0.0;      ///< [N]
    double limited = 0.0;                 ///< share of outputs at which a controller had reached its authority
    double loose = 0.0;                   ///< share of outputs at which the slack strand carried no tension
    double beyond = 0.0;                  ///< share of outputs at which clamping was above its limit over the slip speed
    double efficiency = 0.0;              ///< 1 - losses/input; not a number without input or without load [1]
    double stored = 0.0;                  ///< change of the stored energy over the input; 0 without input [1]
    bool no_load = false;                 ///< no shaft took a hundredth of the input: there is no efficiency
    double periods = 0.0;                 ///< whole pin periods that efficiency is over; 0: less than one [1]
    double turning = 0.0;                 ///< speed of the shafts, whichever way, mean of both [rad/s]
    model::HydraulicEnergy hydraulics{};  ///< mean powers [W]; `stored` is the mean rate of what is stored
    double with_pump = 0.0;               ///< efficiency with the pump's power and losses; as efficiency where there is no pump [1]
    double carried = 0.0;                 ///< what drive and load have taken out of the machine over its losses, in the same time [1]
};

/// Something about results that a reader must know. They are right by themselves.
struct Note {
    std::string_view name;  ///< for tables: gross_slip, …
    std::string text;       ///< for people
};

class RunMeans {
public:
    void clear() noexcept;
    /// An output. @param sums of the energies so far   @param pin_period see Workspace [s]
    void add(const model::Observation& now, const EnergySums& sums, double pin_period);

    [[nodiscard]] SpanMeans all() const { return span(0.0, 1.0); }
    [[nodiscard]] SpanMeans first_fifth() const { return span(0.0, 0.2); }
    [[nodiscard]] SpanMeans last_fifth() const { return span(0.8, 1.0); }
    /// What is odd about them. @param balance of the run   @param pulleys whether there are any: else only its losses can be odd
    [[nodiscard]] std::vector<Note> notes(const EnergyBalance& balance, bool pulleys = true) const;
    /// Their names, blank between them, in `names`.
    void name_notes(const EnergyBalance& balance, std::string& names) const;

    /// For checkpoints: continues bitwise. load() returns the rest of the memory. @throws std::invalid_argument for a malformed memory
    void save(std::vector<double>& memory) const;
    [[nodiscard]] std::span<const double> load(std::span<const double> memory);  ///< memory [what save() wrote]

private:
    /// Sums over some outputs, and the energies at the last of them. Numbers only.
    struct Bin {
        double outputs = 0.0, time = 0.0;  ///< how many [1]; their span [s]
        double ratio = 0.0, slip = 0.0, tight = 0.0, slack = 0.0, limited = 0.0, loose = 0.0,
               beyond = 0.0;   ///< sums of ratio, slip, limited, loose, beyond [1] and of tensions [N]
        double turning = 0.0;  ///< sum of speeds [rad/s]
        double friction_slip = 0.0, creep = 0.0,
               brought = 0.0;  ///< sums of bench slip [1] and of powers: lost by creep, brought by shafts [W]
        EnergySums energy;
        model::HydraulicEnergy hydraulics;

        /// The sums of another one too; time and energies stay.
        void add(const Bin& other) noexcept;
    };
    static constexpr std::size_t max_bins = 2000;

    /// Which of note_kinds() there are.
    [[nodiscard]] std::array<bool, 9> odd(const EnergyBalance& balance) const;
    /// Why means are over a changing state.
    enum class Change { none, drift, brief, energy };
    [[nodiscard]] Change change() const;
    [[nodiscard]] std::string text_of(Change change) const;
    [[nodiscard]] SpanMeans span(double from, double to) const;  ///< from [s], to [s]
    [[nodiscard]] EnergySums energy_at(double time) const;       ///< time [s]
    void halve();

    std::vector<Bin> bins_;
    double per_bin_ = 1.0;     ///< outputs [1]
    double pin_period_ = 0.0;  ///< at the last output [s]
};

/// Names of all notes with their meanings, for `--help`, documents and tests.
struct NoteKind {
    std::string_view name, meaning;
};
[[nodiscard]] std::span<const NoteKind> note_kinds() noexcept;

}  // namespace cvtflow::tasks
