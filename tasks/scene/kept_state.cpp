#include "tasks/scene/kept_state.hpp"

#include "engine/base/input_file.hpp"
#include "engine/thread/guards.hpp"

namespace cvtflow::tasks {

struct KeptState::Kept {
    engine::Mutex mutex;
    std::string path;
    engine::FileIdentity identity;
    std::shared_ptr<const engine::SavedState> state;
};

KeptState::KeptState() : kept_(std::make_shared<Kept>()) {}

std::shared_ptr<const engine::SavedState> KeptState::read(const std::string& path) const {
    Kept& kept = *kept_;
    return kept.mutex.guard([&] {
        const engine::FileIdentity now = engine::identity_of(path);
        const bool known = kept.state != nullptr && kept.path == path && (now == kept.identity || now == engine::FileIdentity{});
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
