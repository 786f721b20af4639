#pragma once
/// A file or folder of this process in the system's folder for such things.

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

/// An empty folder that is removed with all that others write into it.
class TemporaryFolder {
public:
    explicit TemporaryFolder(const std::string& name)
        : path_(std::filesystem::temp_directory_path() / ("cvtflow_" + name + "_" + std::to_string(getpid()))) {
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() {
        std::error_code absent;
        std::filesystem::remove_all(path_, absent);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

private:
    std::filesystem::path path_;
};

}  // namespace cvtflow::tests
