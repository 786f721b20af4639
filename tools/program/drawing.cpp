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
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "tools/program/front.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::tools {

namespace {

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

/// Exit status of the package, or 128 + signal. @throws std::runtime_error if it cannot be started
int run_package(const MemoryFile& input, const MemoryFile& output, const MemoryFile& messages) {
    const std::string words[] = {"draw"};
    PythonStart start = python_start(words);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    int stream = 0;
    for (const MemoryFile* file : {&input, &output, &messages}) posix_spawn_file_actions_adddup2(&actions, file->number(), stream++);
    pid_t child = -1;
    const int failed =
        posix_spawn(&child, start.words[0].c_str(), &actions, nullptr, pointers(start.words).data(), pointers(start.environment).data());
    posix_spawn_file_actions_destroy(&actions);
    if (failed != 0) throw std::runtime_error(start.failure(failed));
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace

std::string drawn(const nlohmann::json& request) {
    const MemoryFile input(request.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)), output, messages;
    const int status = run_package(input, output, messages);
    std::string message = messages.contents();
    while (message.ends_with('\n')) message.pop_back();
    if (constexpr std::string_view said = "cvtflow: "; message.starts_with(said)) message.erase(0, said.size());
    if (status == static_cast<int>(ExitStatus::usage)) throw UsageError(message);
    if (status != 0) throw std::runtime_error(message.empty() ? fmt::format("the Python package ended with status {}", status) : message);
    if (!message.empty()) print_error(message);
    std::string drawn = output.contents();
    if (drawn.empty()) throw std::runtime_error("the Python package returned nothing");
    return drawn;
}

}  // namespace cvtflow::tools
