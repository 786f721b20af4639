#pragma once
/// A state as a file, for scenes that begin with it.

#include <string>

#include "engine/record/run/state_file.hpp"

namespace cvtflow::bench {

/// A state in a new private folder in the system's temporary folder; removed with this object.
class StateFile {
public:
    explicit StateFile(const engine::SavedState& state);
    ~StateFile();
    StateFile(const StateFile&) = delete;
    StateFile& operator=(const StateFile&) = delete;
    [[nodiscard]] const std::string& path() const noexcept { return path_; }

private:
    std::string path_;
};

}  // namespace cvtflow::bench
