#pragma once
/// Locks that keep two writers from one file.

#include <unistd.h>

#include <string>
#include <utility>

namespace cvtflow::engine {

/// Closed when the scope ends, unless it is given away.
class Descriptor {
public:
    explicit Descriptor(int number) noexcept : number_(number) {}
    ~Descriptor() {
        if (number_ >= 0) ::close(number_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    [[nodiscard]] int number() const noexcept { return number_; }
    [[nodiscard]] int give_away() noexcept { return std::exchange(number_, -1); }

private:
    int number_;
};

/// Locks a whole file against other writers (not against readers) until `descriptor` is closed.
/// @param path for messages   @return false if it is locked already, here or in another process
/// @throws RecordError where the system cannot lock: going on would let two runs write into one file
[[nodiscard]] bool try_lock(int descriptor, const std::string& path);

}  // namespace cvtflow::engine
