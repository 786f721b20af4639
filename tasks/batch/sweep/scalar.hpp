#pragma once
/// A number to which a case of a sweep is reduced: a channel and how its course becomes one number, or a quotient of two such. `slip mean`,
/// `sheaves/axial_force[2] max`, `tips/axial_force[*] max` (of all elements), `ratio at 1 ms`, `shaft_2/chain_torque mean /
/// shaft_1/chain_torque mean`.

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
    int element = 0;  ///< of a channel with several numbers, or every_element
    Reduction reduction = Reduction::mean;
    double time = 0.0;  ///< of `at`: the first output at or after it counts [s]
};

struct Scalar {
    std::string text;               ///< as written, white space tidied
    std::string column;             ///< name in the table: letters, digits and _
    std::vector<ScalarTerm> terms;  ///< one, or dividend and divisor

    /// Unit of the number; of a quotient "1" or "A/B".
    [[nodiscard]] std::string unit() const;
    [[nodiscard]] std::string description() const;
    /// Whether all terms are averages over time, whose errors batches of it show.
    [[nodiscard]] bool averages() const noexcept;
};

/// Appends a problem (with the nearest channel or reduction) and returns an empty scalar if the text is invalid.
[[nodiscard]] Scalar parse_scalar(const std::string& text, Position position, std::vector<Problem>& problems);

/// A term in the making. Sums run in the order of outputs and elements.
struct TermSum {
    long count = 0;
    double value = 0.0;       ///< sum, extreme or value found [unit of the channel]
    std::vector<double> all;  ///< of a median [outputs]

    void add(const ScalarTerm& term, double time, double number);  ///< time [s], number [unit of the channel]
    /// Adds what comes after.
    void add(const ScalarTerm& term, const TermSum& later);
    /// Not a number if no output counted.
    [[nodiscard]] double result(const ScalarTerm& term) const;
};

/// A scalar in the making.
struct Reducer {
    TermSum sums[2];

    /// @param numbers of the term's channel at an output
    void add(const Scalar& scalar, std::size_t term, double time, std::span<const double> numbers);
    /// Adds what comes after.
    void add(const Scalar& scalar, const Reducer& later);
    [[nodiscard]] double result(const Scalar& scalar) const;
    /// Ready for another case.
    void clear() noexcept;

    /// For checkpoints: load() returns the rest of the memory. @throws std::invalid_argument for a malformed memory
    void save(std::vector<double>& memory) const;
    [[nodiscard]] std::span<const double> load(std::span<const double> memory);  ///< @param memory from save()
};

}  // namespace cvtflow::tasks
