#include "engine/thread/ticker.hpp"

#include <system_error>
#include <utility>

namespace cvtflow::engine {

Ticker::Ticker(std::chrono::milliseconds period, std::function<void()> call) {
    try {
        thread_ = std::thread([this, period, work = std::move(call)] {
            std::unique_lock hold(mutex_);
            while (!changed_.wait_for(hold, period, [this] { return ending_; })) {
                hold.unlock();
                work();
                hold.lock();
            }
        });
    } catch (const std::system_error&) {
        return;  // too many threads
    }
}

Ticker::~Ticker() {
    {
        const std::lock_guard hold(mutex_);
        ending_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
}

}  // namespace cvtflow::engine
