#pragma once
/// A number to which a case of a sweep is reduced: a channel and how its course becomes one number, or a quotient of two such. `slip mean`,
/// `sheaves/axial_force[2] max`, `tips/axial_force[*] max` (of all elements), `ratio at 1 ms`, `shaft_2/chain_torque mean /
/// shaft_1/chain_torque mean`.

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "tasks/channel/channels.hpp"
#include "tasks/scene/toml_tree.hpp"

namespace cvtflow::tasks {

enum class Reduction { mean, min, max, rms, final, at, median };

/// Element of a ScalarTerm that denotes all elements.
inline constexpr int every_element = -1;

/// A channel and how its course becomes one number.
struct ScalarTerm {
    const Channel* channel = nullptr;
    int element = 0;  ///< number of an element of a wide channel, or every_element
    Reduction reduction = Reduction::mean;
    double time = 0.0;                  ///< time of `at`: the first output at or after it counts [s]
    const Channel* integral = nullptr;  ///< channel whose change gives a mean: Channel::sums() or Channel::integral()
    bool quotient = false;              ///< `integral` is Channel::sums()

    /// Whether it is an integral over the time between samples, over that time; others are of outputs.
    [[nodiscard]] bool over_time() const noexcept { return reduction == Reduction::mean || reduction == Reduction::rms; }
    /// The channel that is read.
    [[nodiscard]] const Channel& source() const noexcept { return integral != nullptr ? *integral : *channel; }
};

/// Samples per pin pitch that integrals over time take, wherever outputs lie: slip of a run is then within a thousandth of itself.
inline constexpr double samples_per_pitch = 16.0;

/// Role of an instant of a run for its scalars.
struct Occasion {
    bool sample = false;  ///< integrals over time take it
    bool output = false;
    bool last = false;  ///< output
};

struct Scalar {
    std::string text;               ///< text of the user, white space tidied
    std::string column;             ///< name in the table: letters, digits and _
    std::vector<ScalarTerm> terms;  ///< one, or dividend and divisor

    /// Unit of the number; of a quotient "1" or "A/B".
    [[nodiscard]] std::string unit() const;
    [[nodiscard]] std::string description() const;
    /// Whether all terms are averages over time, whose errors batches of it show.
    [[nodiscard]] bool averages() const noexcept;
    /// Whether it is undefined where no energy flows or shaft 2 is at rest, which is no fault of a case.
    [[nodiscard]] bool may_be_undefined() const noexcept { return std::ranges::any_of(terms, &ScalarTerm::quotient); }
    /// Whether it is one term, of the channel of that name.
    [[nodiscard]] bool is(std::string_view channel) const noexcept;
    /// Scale of the error of its mean, as of run.steady: the value, or the losses' share of the input for an efficiency.
    [[nodiscard]] double error_scale(double value) const noexcept;
};

/// Name of a column in a table: letters and digits, every run of others one underscore: load.torque, "slip mean", tips/axial_force[*].
[[nodiscard]] std::string column_name(std::string_view text);

/// Appends a problem (with the nearest channel or reduction) and returns an empty scalar if the text is invalid.
[[nodiscard]] Scalar parse_scalar(const std::string& text, Position position, std::vector<Problem>& problems);

/// A term in the making. Sums run in the order of instants and elements.
struct TermSum {
    long count = 0;
    double value = 0.0;       ///< integral over time, extreme or value found [unit of the channel, times s for an integral]
    double span = 0.0;        ///< length of an integral over time [s]
    double time = 0.0;        ///< time of the last sample [s]
    double last = 0.0;        ///< number at the last sample
    std::vector<double> all;  ///< outputs of a median; for a quotient, changes of its sums and their last values [2 x sums]

    /// Whether the term takes an instant. time [s]
    [[nodiscard]] bool takes(const ScalarTerm& term, double instant, const Occasion& when) const noexcept;
    void add(const ScalarTerm& term, double instant, double number);  ///< instant [s], number [unit of the channel that is read]
    void integrate(const ScalarTerm& term, double instant, double number) noexcept;
    void add_sums(double instant, std::span<const double> sums);  ///< sums of a quotient
    /// Adds what continued() has become.
    void add(const ScalarTerm& term, const TermSum& later);
    /// A sum over the time after it: an integral continues from its last sample.
    [[nodiscard]] TermSum continued(const ScalarTerm& term) const;
    /// Lets an integral over time begin later, linear between two states that it had. begin [s]
    void begin_at(const ScalarTerm& term, double begin, const TermSum& before, const TermSum& after) noexcept;
    /// Value of the term; not a number if no output counted.
    [[nodiscard]] double result(const ScalarTerm& term) const;
};

/// A scalar in the making.
struct Reducer {
    std::array<TermSum, 2> sums;

    /// Whether the terms that take an instant need the chain.
    [[nodiscard]] bool needs_chain(const Scalar& scalar, double time, const Occasion& when, const Counters& counters) const noexcept;
    /// Reads and adds the terms that take an instant. @param memory of one channel, grows as needed
    /// @throws SimulationError if a channel has not the term's element
    void read(const Scalar& scalar, const Instant& now, const Occasion& when, std::vector<double>& memory);
    /// @param numbers of the channel that the term reads at an instant that it takes
    void add(const Scalar& scalar, std::size_t term, double time, std::span<const double> numbers);
    /// Adds what continued() has become.
    void add(const Scalar& scalar, const Reducer& later);
    /// A scalar over the time after it: integrals continue from their last samples.
    [[nodiscard]] Reducer continued(const Scalar& scalar) const;
    /// Lets integrals over time begin later, between two states that they had. begin [s]
    void begin_at(const Scalar& scalar, double begin, const Reducer& before, const Reducer& after) noexcept;
    [[nodiscard]] double result(const Scalar& scalar) const;
    /// Ready for another case.
    void clear() noexcept;
};

}  // namespace cvtflow::tasks
