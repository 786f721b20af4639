#pragma once
/// A file of this process in the system's folder for such things.

#include <unistd.h>

#include <filesystem>
#include <string>

namespace cvtflow::tests {

/// Name of a file that others write and that is removed with this object. A file that a killed process of the same number left is removed
/// first.
class TemporaryFile {
public:
    explicit TemporaryFile(const std::string& name)
        : path_((std::filesystem::temp_directory_path() / ("cvtflow_" + name + "_" + std::to_string(getpid()) + ".h5")).string()) {
        remove();
    }
    ~TemporaryFile() { remove(); }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    [[nodiscard]] const std::string& path() const noexcept { return path_; }

private:
    void remove() const noexcept {
        std::error_code absent;
        std::filesystem::remove(path_, absent);
    }

    std::string path_;
};

}  // namespace cvtflow::tests
