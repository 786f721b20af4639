#pragma once
/// A lock for folders that know no threads.

#include <mutex>

namespace cvtflow::engine {

/// Mutual exclusion.
class Mutex {
public:
    template <class Body>
    decltype(auto) guard(Body&& body) {
        const std::lock_guard hold(mutex_);
        return body();
    }

private:
    std::mutex mutex_;
};

}  // namespace cvtflow::engine
