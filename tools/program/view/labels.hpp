#pragma once
/// How quantities are shown in pictures and pages: names without underscores, slip and efficiency in per cent, units beside them. Files of
/// numbers (records, tables, CSV) contain SI units, and so shares of 1.

#include <string>

namespace cvtflow::tools {

struct Shown {
    std::string label;    ///< "slip [%]", "tight tension [N]"
    double factor = 1.0;  ///< from the unit of the record to that of the label
    std::string unit;     ///< of the label: "%", "N"; empty: none
};

/// A channel or a column of a sweep. @param unit SI unit; "1" or empty: none
[[nodiscard]] Shown shown(const std::string& name, const std::string& unit);

/// The common label of several quantities of one unit: "force [N]".
[[nodiscard]] std::string label_of_unit(const std::string& unit);

}  // namespace cvtflow::tools
