#pragma once
/// Methods with steps, as written on the command line: METHOD@STEP, METHOD@auto, METHOD@LONGEST~TOLERANCE.

#include <string>
#include <vector>

namespace cvtflow::bench {

/// A time above 0 with or without its unit [s]. @throws tools::UsageError that begins with the option
[[nodiscard]] double read_time(const std::string& option, const std::string& text);

/// "dumka3-p5@2us", "leapfrog-rigid@auto", "dopri54@1us~1e-3" (a tolerance) as settings of a scene.
/// @throws tools::UsageError, tasks::SceneError
[[nodiscard]] std::vector<std::string> read_choice(const std::string& choice);

}  // namespace cvtflow::bench
