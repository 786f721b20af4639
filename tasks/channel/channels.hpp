#pragma once
/// The catalogue of recorded quantities: a row per channel, from which the record, `list channels` and tests are made.

#include <array>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "model/observe/observation.hpp"
#include "tasks/step/control/step_controller.hpp"

namespace cvtflow::tasks {

/// Data that a channel may read at an output time.
struct Instant {
    const model::Observation& observation;
    const Workspace& workspace;
    const Counters& counters;
    int followed_pin;
    model::Observer& observer;  ///< evaluates forces where a channel needs them

    /// Torque of the chain on the sheaves of shaft 0 or 1: mean since the last output, of the instant where there is none before [N·m].
    [[nodiscard]] double chain_torque(std::size_t shaft) const noexcept;
};

struct Channel {
    using Width = std::function<int(const model::ChainModel&)>;

    /// Reads the values of an instant: a function that returns one, or writes all, and what else it takes, such as the number of a shaft.
    class Read {
    public:
        template <class... Of>
        Read(double (*value)(const Instant&, Of...), std::type_identity_t<Of>... of)
            : read_([=](const Instant& now, double* values) { *values = value(now, of...); }) {}
        template <class... Of>
        Read(void (*write)(const Instant&, double*, Of...), std::type_identity_t<Of>... of)
            : read_([=](const Instant& now, double* values) { write(now, values, of...); }) {}
        void operator()(const Instant& now, double* values) const { read_(now, values); }

    private:
        std::function<void(const Instant&, double*)> read_;
    };

    /// Differences to a usual channel, which every run of a machine with pulleys records; combined by |.
    enum Trait : unsigned {
        usual = 0,
        any_machine = 1,       ///< recorded for a ring of links without pulleys too
        on_demand = 2,         ///< recorded where record.channels names it
        may_be_undefined = 8,  ///< a quotient that is NaN where its divisor is zero; means and extremes leave such outputs out
        without_chain = 16,    ///< see needs_chain()
        of_hydraulics = 4 | on_demand | without_chain,  ///< recorded in every run with hydraulics also
        of_control = 64 | on_demand | without_chain,    ///< recorded in every run with a controller also
        of_drag = 32 | on_demand | without_chain,       ///< recorded in every run whose shafts have drag also
        of_guide = 128 | on_demand,                     ///< recorded in every run with guides also
        unaveraged =
            256,  ///< record.means leaves it as it is: a sum so far, what is stored, a mean since the last output, an angle or a place
        so_far = without_chain | unaveraged,
    };

    std::string_view name;  ///< name in the record; '/' groups
    std::string_view unit;
    std::string_view description;
    Read read;  ///< values [unit of the channel]
    unsigned traits = usual;
    std::string_view axis = {};  ///< label of the second dimension, empty for a plain channel
    Width width = always(1);     ///< numbers of an instant

    [[nodiscard]] bool is(Trait trait) const noexcept { return (traits & trait) == trait; }
    /// Whether reading it takes an observation of the chain; else Workspace::shafts_observed_by() is enough. At its first instant a run
    /// knows no means yet.
    [[nodiscard]] bool needs_chain(const Counters& counters) const noexcept { return !is(without_chain) || counters.steps == 0; }

    /// The channel whose change over a time is this one's integral over it; nullptr: there is none.
    [[nodiscard]] const Channel* integral() const;
    /// The channel from whose changes the mean of a quotient follows, by quotient_of(); nullptr: this is none.
    [[nodiscard]] const Channel* sums() const;

    /// A width that does not depend on the machine.
    [[nodiscard]] static Width always(int numbers) {
        return [numbers](const model::ChainModel&) { return numbers; };
    }
};

/// A quotient whose mean is that of sums, and the channels so far of which each sum is made: of an efficiency five energies [J] (losses, a
/// pump, what presses, drive and load), of the speed ratio the angles of both shafts [rad]. A machine or a record that has not one of them
/// counts it as zero.
struct QuotientChannels {
    std::string_view name;
    std::vector<std::vector<std::string_view>> sums;
};
[[nodiscard]] std::span<const QuotientChannels> quotient_channels();
/// Sums of one channel; nullptr: its mean is that of its values.
[[nodiscard]] const QuotientChannels* quotient_channels_of(std::string_view name);
/// Mean of a quotient over a time: of five energies an efficiency, of two angles their quotient. @param changes of its sums in that time
[[nodiscard]] double quotient_of(std::span<const double> changes) noexcept;

[[nodiscard]] std::span<const Channel> channels();

/// Channels of a record: the usual ones and those in `names`, where the machine has them.
/// @param names of channels, or of groups such as "tips/*"
[[nodiscard]] std::vector<const Channel*> chosen_channels(std::span<const std::string> names, const model::Parameters& machine);

/// Unknown names of record.channels, in order.
[[nodiscard]] std::vector<std::string> unknown_channels(std::span<const std::string> names);
/// ` (did you mean "slip"?)`, or what became of a channel of an earlier version; empty where no name is near.
[[nodiscard]] std::string channel_hint(std::string_view unknown);

/// The part of the catalogue in further_channels.cpp.
[[nodiscard]] std::span<const Channel> further_channels();

/// Short names of loss, work and energy kinds, in the order of their enumerators.
[[nodiscard]] std::string_view loss_name(int kind) noexcept;
[[nodiscard]] std::string_view work_name(int kind) noexcept;
[[nodiscard]] std::string_view energy_name(int kind) noexcept;

}  // namespace cvtflow::tasks
