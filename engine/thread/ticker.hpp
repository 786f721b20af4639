#pragma once
/// A function that is called again and again beside other work.

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace cvtflow::engine {

/// Calls a function once every period, on a thread of its own, as long as this object lives. Where the system has no thread for it, never.
class Ticker {
public:
    Ticker(std::chrono::milliseconds period, std::function<void()> call);
    ~Ticker();
    Ticker(const Ticker&) = delete;
    Ticker& operator=(const Ticker&) = delete;

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    bool ending_ = false;
    std::thread thread_;
};

}  // namespace cvtflow::engine
