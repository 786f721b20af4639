#pragma once
/// The record of a simulation while it is advanced. Records are HDF5 files, which any program reads (docs/formats.md).

#include <cvtflow/simulation.hpp>

#include <memory>
#include <string>
#include <utility>

namespace cvtflow {
inline namespace v0_4 {

/// Writes channels, states, transitions and file of `cvtflow run`, at the scene's run.output_interval from now on. Settling is not
/// recorded. Without `replace`, no existing file is replaced, and no rows of a killed run in `path`.part are discarded. One at a time for
/// each simulation.
class Recording {
public:
    /// @throws Error (record) for files that cannot be written, (state) if the simulation is being recorded already
    Recording(Simulation& simulation, const std::string& path, bool replace = false) : held_(simulation.held_) {
        detail::call(cvtflow_record_begin, held_->handle, path.c_str(), replace ? 1 : 0);
    }
    /// Leaves the rows in `path`.part if finish() was not called.
    ~Recording() { leave(); }
    Recording(Recording&& other) noexcept : held_(std::exchange(other.held_, nullptr)) {}
    Recording& operator=(Recording&& other) noexcept {
        leave();
        held_ = std::exchange(other.held_, nullptr);
        return *this;
    }

    /// Completes the record, which takes its final name. @param complete false: the status becomes "cancelled"
    /// @throws Error (record); (state) where it has ended
    void finish(bool complete = true) {
        const auto ending = std::exchange(held_, nullptr);
        if (!ending) throw Error(ErrorCode::state, "the recording has ended");
        detail::call(cvtflow_record_finish, ending->handle, complete ? 1 : 0);
    }

private:
    void leave() noexcept {
        if (held_ && held_->handle != nullptr) cvtflow_record_finish(held_->handle, -1, nullptr);
    }

    std::shared_ptr<Simulation::Held> held_;
};

}  // namespace v0_4
}  // namespace cvtflow
