#pragma once
/// Options shared by commands that tune.

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

/// @throws UsageError for an accuracy outside (0, 50 %] or an invalid time   @throws tasks::SceneError for an unknown method
[[nodiscard]] tasks::TuneSettings tune_settings(const TuningArguments& arguments, bool quiet);

}  // namespace cvtflow::tools
