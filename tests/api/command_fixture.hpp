#pragma once
/// Commands of the system and children of this process, without the library.

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <string>
#include <utility>

namespace cvtflow::host {

/// Exit status and output of a command on both streams.
inline std::pair<int, std::string> output_of(const std::string& command) {
    std::string text;
    FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    for (int letter = std::fgetc(pipe); letter != EOF; letter = std::fgetc(pipe)) text += static_cast<char>(letter);
    return {pclose(pipe), text};
}

/// Runs `action` in a child process; its exit status. A child that hangs ends with a signal.
template <class Action>
int in_child(const Action& action) {
    const pid_t child = fork();
    if (child == 0) {
        alarm(300);
        _exit(action());
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace cvtflow::host
