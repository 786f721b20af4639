#include "tools/program/output/raster.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>

extern char** environ;

namespace cvtflow::tools {

namespace {

/// An anonymous temporary file that contains the text, positioned at its beginning.
std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_with(const std::string& text) {
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), std::fclose);
    if (!file || std::fwrite(text.data(), 1, text.size(), file.get()) != text.size() || std::fflush(file.get()) != 0)
        throw std::runtime_error(fmt::format("cannot write a temporary file: {}", std::strerror(errno)));
    std::rewind(file.get());
    return file;
}

}  // namespace

void write_png(const std::string& path, const std::string& svg) {
    const auto input = file_with(svg);
    std::string program = "rsvg-convert", format = "--format=png", zoom = "--zoom=2", output = "--output=" + path;
    char* words[] = {program.data(), format.data(), zoom.data(), output.data(), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, fileno(input.get()), STDIN_FILENO);
    pid_t child = -1;
    const int failed = posix_spawnp(&child, words[0], &actions, nullptr, words, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed == ENOENT)
        throw std::runtime_error(path +
                                 ": PNG requires the program rsvg-convert (Debian: apt-get install librsvg2-bin); SVG and CSV do not");
    if (failed != 0) throw std::runtime_error(fmt::format("{}: cannot run rsvg-convert: {}", path, std::strerror(failed)));
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    if (status != 0) throw std::runtime_error(path + ": rsvg-convert could not write it");
}

}  // namespace cvtflow::tools
