#pragma once
/// The cases of a sweep as pieces that processes share. Internal to tasks/batch.

#include <functional>
#include <string>
#include <vector>

#include "tasks/batch/results/results.hpp"

namespace cvtflow::tasks {

/// A case that a process is to run.
struct CaseToRun {
    long number = 0;
    bool is_new = true;  ///< false: it has a row, but its end is needed by others
};

/// Hands out strands of cases; without continuation, single cases. Neighbouring strands are claimed together, about a thousand times in a
/// sweep. One thread at a time.
class SharedWork {
public:
    /// Whether the end of a case is there to start from.
    using HasEnd = std::function<bool(long number)>;

    /// @param rows  of the folder; rows of other processes are read while waiting   @param notice  receives whom is waited for; may be
    /// empty
    SharedWork(const Sweep& sweep, SweepRows& rows, engine::Claims& claims, HasEnd has_end, std::function<void(const std::string&)> notice);

    /// Cases of the next strand, in order. None: all are done or being done here, or `stop` says so. Waits while other processes are at
    /// work, whose cases it hands out where such a process is lost. @throws engine::RecordError
    [[nodiscard]] std::vector<CaseToRun> next(const std::function<bool()>& stop);
    /// The only case to hand out, whoever has claimed it.
    void restrict_to(long number);

private:
    [[nodiscard]] long strands() const noexcept { return sweep_.cases() / sweep_.strand(); }
    [[nodiscard]] bool is_open(long strand) const noexcept;
    [[nodiscard]] bool claim_new();
    [[nodiscard]] bool claim_lost(bool& others);
    [[nodiscard]] bool take(long piece);
    [[nodiscard]] std::vector<CaseToRun> cases_of(long strand) const;
    void wait(double& waited);

    const Sweep& sweep_;
    SweepRows& rows_;
    engine::Claims& claims_;
    HasEnd has_end_;
    std::function<void(const std::string&)> notice_;
    long length_;               ///< strands of a piece
    std::vector<char> taken_;   ///< whether this process has a piece
    long cursor_ = 0;           ///< next piece that was not tried yet
    long begin_ = 0, end_ = 0;  ///< strands that are to be handed out
};

}  // namespace cvtflow::tasks
