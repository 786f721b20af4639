#include "tools/program/output/png_file.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>

extern char** environ;

namespace cvtflow::tools {

namespace {

using TemporaryFile = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// An anonymous temporary file that contains the text, positioned at its beginning.
TemporaryFile file_with(const std::string& text) {
    TemporaryFile file(std::tmpfile(), std::fclose);
    if (!file || std::fwrite(text.data(), 1, text.size(), file.get()) != text.size() || std::fflush(file.get()) != 0)
        throw std::runtime_error(fmt::format("cannot write a temporary file: {}", std::strerror(errno)));
    std::rewind(file.get());
    return file;
}

std::string contents_of(std::FILE* file) {
    std::rewind(file);
    std::string bytes;
    char block[65536];
    for (std::size_t count = 0; (count = std::fread(block, 1, sizeof block, file)) > 0;) bytes.append(block, count);
    return bytes;
}

std::string big_endian(std::uint32_t number) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 0xFFU);
    return bytes;
}

/// Of the format: CRC-32.
std::uint32_t sum_of(const std::string& bytes) {
    std::uint32_t sum = 0xFFFFFFFFU;
    for (const char byte : bytes) {
        sum ^= static_cast<unsigned char>(byte);
        for (int bit = 0; bit < 8; ++bit) sum = sum >> 1U ^ (0xEDB88320U & (0U - (sum & 1U)));
    }
    return ~sum;
}

/// A text behind the first chunk, which the format fixes at 33 bytes.
std::string with_text(std::string png, const std::string& text) {
    constexpr std::size_t behind_header = 33;
    if (png.size() < behind_header) return png;
    const std::string chunk = "tEXtSoftware" + std::string(1, '\0') + text;
    png.insert(behind_header, big_endian(static_cast<std::uint32_t>(chunk.size() - 4)) + chunk + big_endian(sum_of(chunk)));
    return png;
}

}  // namespace

std::string png_of(const std::string& path, const std::string& svg, const std::string& mark) {
    const TemporaryFile input = file_with(svg), output = file_with("");
    std::string program = "rsvg-convert", format = "--format=png", zoom = "--zoom=2";
    char* words[] = {program.data(), format.data(), zoom.data(), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, fileno(input.get()), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, fileno(output.get()), STDOUT_FILENO);
    pid_t child = -1;
    const int failed = posix_spawnp(&child, words[0], &actions, nullptr, words, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed == ENOENT)
        throw std::runtime_error(path +
                                 ": PNG requires the program rsvg-convert (Debian: apt-get install librsvg2-bin); SVG and CSV do not");
    if (failed != 0) throw std::runtime_error(fmt::format("{}: cannot run rsvg-convert: {}", path, std::strerror(failed)));
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    std::string png = contents_of(output.get());
    if (status != 0 || png.empty()) throw std::runtime_error(path + ": rsvg-convert could not make it");
    return with_text(std::move(png), mark);
}

}  // namespace cvtflow::tools
