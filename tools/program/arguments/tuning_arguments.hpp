#pragma once
/// What commands that tune have in common.

#include <optional>
#include <string>

#include "tasks/tuning/tuner.hpp"

namespace CLI {
class App;
}

namespace cvtflow::tools {

struct TuningArguments {
    std::optional<std::string> accuracy;
    std::string outputs;  ///< separated by commas; empty: the usual figures
    std::string methods;  ///< separated by commas; empty: the default method and the cheapest
    std::optional<std::string> budget, settle, average;
};

/// Declares --accuracy, --outputs, --methods, --budget, --settling and --average.
void declare_tuning(CLI::App& app, TuningArguments& arguments);

/// @throws UsageError for an accuracy outside (0, 50 %], or a time that is none   @throws tasks::SceneError for a method that there is not
[[nodiscard]] tasks::TuneSettings tune_settings(const TuningArguments& arguments, bool quiet);

}  // namespace cvtflow::tools
