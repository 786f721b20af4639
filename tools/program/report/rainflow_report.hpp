#pragma once
/// Rainflow counts of recorded loads, for `cvtflow table RECORD --rainflow CHANNEL`.

#include <limits>
#include <string>
#include <vector>

namespace cvtflow::tools {

enum class RainflowForm { text, csv, json };

struct RainflowRequest {
    std::string record;
    std::vector<std::string> channels;  ///< "name", or an element "name[3]", or all of them "name[*]"
    double from = 0.0;                  ///< [s]
    double until = std::numeric_limits<double>::infinity();
    int classes = 16;       ///< of ranges, in the text
    double exponent = 5.0;  ///< of the Woehler line: life falls with this power of the range
    RainflowForm form = RainflowForm::text;
};

/// Text: cycles by classes of range. CSV: every cycle. JSON: both, with provenance.
/// @throws UsageError for a channel that is not there, engine::RecordError for a record that cannot be read
[[nodiscard]] std::string rainflow_report(const RainflowRequest& request);

}  // namespace cvtflow::tools
