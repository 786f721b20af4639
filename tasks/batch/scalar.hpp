#pragma once
/// What a case of a sweep is reduced to: a channel and how its course becomes one number. `slip mean`, `sheaves/axial_force[2] max`,
/// `ratio at 1 ms`.

#include <string>
#include <vector>

#include "tasks/channels.hpp"
#include "tasks/scene/toml_tree.hpp"

namespace cvtflow::tasks {

enum class Reduction { mean, min, max, rms, final, at };

struct Scalar {
    std::string text;           ///< as written, white space tidied
    std::string column;         ///< name in the table: letters, digits and _
    const Channel* channel = nullptr;
    int element = 0;            ///< of a channel with several numbers
    Reduction reduction = Reduction::mean;
    double time = 0.0;          ///< of `at`: the first output at or after it counts [s]
};

/// Appends a problem (with the nearest channel or reduction) and returns an empty channel if the text is no scalar.
[[nodiscard]] Scalar parse_scalar(const std::string& text, Position position, std::vector<Problem>& problems);

/// A scalar in the making. Sums run in the order of outputs.
struct Reducer {
    long count = 0;
    double value = 0.0;   ///< sum, extreme or value found

    void add(const Scalar& scalar, double time, double number) noexcept;
    /// Not a number if no output counted.
    [[nodiscard]] double result(const Scalar& scalar) const noexcept;
};

}  // namespace cvtflow::tasks
