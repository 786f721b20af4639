#include "tasks/scene/kept_state.hpp"

#include <sys/stat.h>

#include "engine/executor/tbb/job_pool.hpp"

namespace cvtflow::tasks {

/// What tells a file from one that took its place.
struct FileIdentity {
    std::uint64_t device = 0, number = 0;
    long size = 0, seconds = 0, nanoseconds = 0;
    bool operator==(const FileIdentity&) const = default;
};

namespace {

[[nodiscard]] FileIdentity identity_of(const std::string& path) noexcept {
    struct stat file {};
    if (stat(path.c_str(), &file) != 0) return {};
    return {file.st_dev, file.st_ino, file.st_size, file.st_mtim.tv_sec, file.st_mtim.tv_nsec};
}

}  // namespace

struct KeptState::Kept {
    engine::Mutex mutex;
    std::string path;
    FileIdentity identity;
    std::shared_ptr<const engine::SavedState> state;
};

KeptState::KeptState() : kept_(std::make_shared<Kept>()) {}

std::shared_ptr<const engine::SavedState> KeptState::read(const std::string& path) const {
    Kept& kept = *kept_;
    return kept.mutex.guard([&] {
        const FileIdentity now = identity_of(path);
        const bool known = kept.state != nullptr && kept.path == path && (now == kept.identity || now == FileIdentity{});
        if (!known) {
            kept.state = nullptr;
            kept.state = std::make_shared<const engine::SavedState>(engine::read_state(path));
            kept.path = path;
            kept.identity = now;
        }
        return kept.state;
    });
}

}  // namespace cvtflow::tasks
