#pragma once
/// Mean state of a run that repeats itself each pin period: a start for the next case that is free of what only rings.

#include <span>
#include <vector>

#include "engine/record/run/state_file.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// Mean over the latest sections: states at the instants at which a pin crosses the middle of the upper strand, the chain numbered from
/// that pin, shaft 1 turned back by what its governor's reference has gone.
class SectionMean {
public:
    /// @param repeats pin periods after which the machine repeats itself; 0: no section is taken
    void clear(int repeats) noexcept;
    /// Whether a section is to be taken. time [s]
    [[nodiscard]] bool due(double time) const noexcept { return time >= next_; }
    /// Takes a section, or finds the pin of the first one. time [s]
    void add(double time, const Workspace& workspace);
    /// Puts the mean in place of a state's motion; without sections nothing. @return whether there are any
    bool put(engine::SavedState& saved, const model::ChainLayout& at) const;

private:
    static constexpr std::size_t kept = 24;  ///< sections: means are over no fewer periods

    void find(double time, const Workspace& workspace) noexcept;
    void keep(double time, double back, const Workspace& workspace);

    int repeats_ = 1, pin_ = -1;  ///< pin of the next section; -1: not known
    double next_ = 0.0;           ///< time of the next section [s]
    std::size_t count_ = 0;
    std::vector<double> states_;        ///< states at the latest sections [kept x unknowns]
    std::vector<model::Phase> phases_;  ///< phases at the last section
};

}  // namespace cvtflow::tasks
