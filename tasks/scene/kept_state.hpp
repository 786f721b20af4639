#pragma once
/// A scene's state, read once: simulations made from one scene, at once or one after the other, share it.

#include <memory>
#include <string>

#include "engine/record/run/state_file.hpp"

namespace cvtflow::tasks {

/// Any thread. Copies share what they have read.
class KeptState {
public:
    KeptState();

    /// The state in a file: as it was read, until the file is another one (by its identity, size and time of change). A file that has gone
    /// since is the one that was read.
    /// @throws engine::RecordError, std::bad_alloc
    [[nodiscard]] std::shared_ptr<const engine::SavedState> read(const std::string& path) const;

private:
    struct Kept;
    std::shared_ptr<Kept> kept_;
};

}  // namespace cvtflow::tasks
