#pragma once
/// Ends of the cases of a strand, and the starts that they make for other cases. Internal to tasks/batch.

#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "model/force/pulley_inputs.hpp"
#include "tasks/batch/section_mean.hpp"
#include "tasks/batch/start_states.hpp"
#include "tasks/run/run_means.hpp"

namespace cvtflow::tasks {

/// A start that continues from an end; none: a start that the case has without continuation.
struct ContinuedStart {
    StartStates::State state{};
    std::optional<model::HeldSheave> sheave{};  ///< the driving sheave, held from the start on
    double cylinder = 0.0;                      ///< SteadyRule::cylinder of the end [W]
    bool extrapolated = false;                  ///< whether the state is made of several ends
};

/// A file per case that ended well, until its strand is done: what others start from does not depend on when a process was killed.
class StrandEnds {
public:
    StrandEnds(const Sweep& sweep, std::filesystem::path folder) : sweep_(sweep), folder_(std::move(folder)) {}

    /// Start by the last good case before in the same line, or by the same one in the line before. A case whose end is a mean state is
    /// extrapolated: by the step that the line before took here, by the last step of the line, or by the last step across the lines.
    /// Where the driving sheave is held, its ratio is moved to the target, and it is held at once.
    /// @param scene of the case   @throws engine::RecordError  an end is damaged
    [[nodiscard]] ContinuedStart start(long number, const Scene& scene);
    /// The end that the last start() came from, as it is.
    [[nodiscard]] ContinuedStart plain() const { return {plain_}; }
    /// Keeps the end of a case: the mean state, if there are sections, or the last one with shaft 1 turned back by the angle that the
    /// governor's reference has gone. @throws engine::RecordError
    void keep(long number, const Scene& scene, Simulation& simulation, const SectionMean& sections, const RunMeans& means);
    /// Whether the end of a case is there and whole: a power cut may have torn it.
    [[nodiscard]] bool exists(long number) const;

private:
    struct Step;
    /// Moves a start by a step, and to the ratio that is asked for.
    void take(const Step& step, long number, const Scene& scene, ContinuedStart& start);
    [[nodiscard]] std::string file(long number) const;
    [[nodiscard]] StartStates::State at(long number);
    /// Takes the ends of a strand away.
    void forget(long strand);

    const Sweep& sweep_;
    std::filesystem::path folder_;
    long strand_ = -1;
    StartStates::State plain_;
    std::map<long, StartStates::State> ends_;  ///< ends of the present strand, by case
};

}  // namespace cvtflow::tasks
