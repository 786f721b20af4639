#include "tools/program/drawing.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "engine/base/text.hpp"
#include "tools/program/front.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::tools {

namespace fs = std::filesystem;

namespace {

constexpr const char* packages = "python3 python3-matplotlib python3-h5py python3-jinja2";

/// A file in memory without a name.
class MemoryFile {
public:
    explicit MemoryFile(std::string_view text = {}) : number_(memfd_create("cvtflow", MFD_CLOEXEC)) {
        for (std::size_t done = 0; number_ >= 0 && done < text.size();) {
            const ssize_t some = ::write(number_, text.data() + done, text.size() - done);
            if (some < 0) throw std::runtime_error(fmt::format("cannot write the request to Python: {}", std::strerror(errno)));
            done += static_cast<std::size_t>(some);
        }
        if (number_ < 0 || lseek(number_, 0, SEEK_SET) != 0)
            throw std::runtime_error(fmt::format("no file in memory for Python: {}", std::strerror(errno)));
    }
    ~MemoryFile() { ::close(number_); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    [[nodiscard]] int number() const noexcept { return number_; }
    [[nodiscard]] std::string contents() const {
        const off_t size = lseek(number_, 0, SEEK_END);
        std::string bytes(static_cast<std::size_t>(std::max<off_t>(size, 0)), '\0');
        std::size_t done = 0;
        for (ssize_t some = 1; some > 0 && done < bytes.size(); done += static_cast<std::size_t>(std::max<ssize_t>(some, 0)))
            some = pread(number_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
        bytes.resize(done);
        return bytes;
    }

private:
    int number_;
};

/// Variables that a child process gets: what libraries are searched by, where temporary files go.
std::vector<std::string> variables() {
    std::vector<std::string> settings{"PATH=/usr/bin:/bin", "LC_ALL=C.UTF-8", "HDF5_USE_FILE_LOCKING=FALSE", "OPENBLAS_NUM_THREADS=1"};
    for (const char* name : {"LD_LIBRARY_PATH", "TMPDIR", "CVTFLOW_TRACE"})
        if (const char* value = std::getenv(name)) settings.push_back(fmt::format("{}={}", name, value));
    return settings;
}

std::vector<char*> as_pointers(std::vector<std::string>& texts) {
    std::vector<char*> all;
    for (std::string& text : texts) all.push_back(text.data());
    all.push_back(nullptr);
    return all;
}

/// Exit status of the package, or 128 + signal. @throws std::runtime_error if it cannot be started
int run_package(const MemoryFile& input, const MemoryFile& output, const MemoryFile& messages, bool reports) {
    const std::string python = python_interpreter();
    std::vector<std::string> words{python, "-I", "-B", "-X", "utf8", python_package("_draw.py")}, settings = variables();
    const int progress = reports ? fcntl(STDERR_FILENO, F_DUPFD, 64) : -1;
    if (progress >= 0) settings.push_back(fmt::format("CVTFLOW_PROGRESS={}", progress));
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    int stream = 0;
    for (const MemoryFile* file : {&input, &output, &messages}) posix_spawn_file_actions_adddup2(&actions, file->number(), stream++);
    pid_t child = -1;
    const int failed = posix_spawn(&child, words[0].c_str(), &actions, nullptr, as_pointers(words).data(), as_pointers(settings).data());
    posix_spawn_file_actions_destroy(&actions);
    if (progress >= 0) ::close(progress);
    if (failed != 0)
        throw std::runtime_error(
            fmt::format("pictures, pages and load cycles require Python, and {} cannot be started: {} (Debian: apt-get install {}; "
                        "CVTFLOW_PYTHON names another interpreter)",
                        python.empty() ? "python3" : python, std::strerror(failed), packages));
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace

std::string path_for_python(const std::string& path) {
    std::string text;
    for (const char character : fs::absolute(path).string()) {
        const auto byte = static_cast<unsigned char>(character);
        if (byte < 0x80U) {
            text += character;
        } else {
            text += static_cast<char>(0xC0U | byte >> 6U);
            text += static_cast<char>(0x80U | (byte & 0x3FU));
        }
    }
    return text;
}

std::string drawn(const nlohmann::json& request, bool reports) {
    const MemoryFile input(request.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)), output, messages;
    const int status = run_package(input, output, messages, reports);
    std::string message = messages.contents();
    while (message.ends_with('\n')) message.pop_back();
    if (status == static_cast<int>(ExitStatus::usage)) throw UsageError(message);
    if (status != 0) throw std::runtime_error(message.empty() ? fmt::format("the Python package ended with status {}", status) : message);
    if (!message.empty()) print_error(message);
    std::string drawn = output.contents();
    if (drawn.empty()) throw std::runtime_error("the Python package returned nothing");
    return drawn;
}

}  // namespace cvtflow::tools
