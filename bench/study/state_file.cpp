#include "bench/study/state_file.hpp"

#include <stdlib.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace cvtflow::bench {

StateFile::StateFile(const engine::SavedState& state) {
    std::string folder = (std::filesystem::temp_directory_path() / "cvtflow-XXXXXX").string();
    if (mkdtemp(folder.data()) == nullptr) throw engine::RecordError(folder + ": cannot create: " + std::strerror(errno));
    path_ = folder + "/state.h5";
    engine::write_state(engine::Permit(path_), state);
}

StateFile::~StateFile() {
    const std::filesystem::path file(path_);
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
    std::filesystem::remove(file.parent_path(), ignored);
}

}  // namespace cvtflow::bench
