/// Any text is read as a scene, a sweep and points of an axis, or refused in words; a scene is written so that it is read back the same.
/// With clang's libFuzzer (preset fuzz, tools/check/fuzz) inputs are searched for; other builds read mutants of files that are given:
///     fuzz_text SEED COUNT FOLDER…

#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <regex>
#include <string>
#include <string_view>

#include "tasks/batch/sweep/axis.hpp"
#include "tasks/batch/sweep/sweep.hpp"
#include "tasks/scene/scene.hpp"

namespace {

using namespace cvtflow::tasks;

/// Ends the process where a message is one of the standard library, unless it quotes the text.
void expect_own_words(const std::string& message, const std::string& text) {
    static const std::regex foreign("std::|_M_|basic_string|vector::|bad_|filesystem error|\\bsto[di]\\b");
    for (auto word = std::sregex_iterator(message.begin(), message.end(), foreign); word != std::sregex_iterator(); ++word)
        if (text.find(word->str()) == std::string::npos) std::abort();
}

void read_as_scene(const std::string& text) {
    std::string written;
    try {
        written = write_scene(parse_scene(text, "scene.toml", StartState::ignored));
    } catch (const SceneError& error) {
        return expect_own_words(error.what(), text);
    }
    if (write_scene(parse_scene(written, "written.toml", StartState::ignored)) != written) std::abort();
}

void read_as_sweep_and_axis(const std::string& path, const std::string& text) {
    std::vector<Problem> problems;
    if (read_csv_axis(path, {}, {}, problems).keys.empty() == problems.empty()) std::abort();  // either, or
    try {
        static_cast<void>(read_sweep(path, [](const std::string&) { return std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml"; }));
    } catch (const SceneError& error) {
        expect_own_words(error.what(), text);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const std::string text(reinterpret_cast<const char*>(bytes), size);
    const int file = memfd_create("input", MFD_CLOEXEC);
    if (write(file, text.data(), size) != static_cast<ssize_t>(size)) std::abort();
    read_as_scene(text);
    read_as_sweep_and_axis("/proc/self/fd/" + std::to_string(file), text);
    close(file);
    return 0;
}

#ifndef CVTFLOW_LIBFUZZER

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

namespace {

constexpr std::string_view odd[] = {"\n",
                                    "\xef\xbb\xbf",
                                    "\xff",
                                    "[",
                                    "[[",
                                    "\"",
                                    "'''",
                                    "=",
                                    "{a={a={a=1}}}",
                                    "[[[[[1]]]]]",
                                    "\\u0000",
                                    ",",
                                    "#",
                                    "1e309",
                                    "nan",
                                    "-0",
                                    "9223372036854775808",
                                    "1e999999999",
                                    "\"1e300 m\"",
                                    "a.b.c.d=1",
                                    "true",
                                    "start.state"};

void change(std::string& text, std::mt19937_64& chance, const std::vector<std::string>& originals) {
    const std::size_t begin = chance() % (text.size() + 1), length = chance() % 60;
    const std::string& other = originals[chance() % originals.size()];
    switch (chance() % 5) {
        case 0: text.insert(begin, odd[chance() % std::size(odd)]); break;
        case 1: text.erase(begin, length); break;
        case 2: text.insert(chance() % (text.size() + 1), text.substr(begin, length)); break;
        case 3: text = text.substr(0, begin) + other.substr(chance() % (other.size() + 1)); break;
        default:
            if (begin < text.size()) text[begin] = static_cast<char>(text[begin] ^ (1 << (chance() % 8)));
    }
}

}  // namespace

int main(int count, char** arguments) {
    std::vector<std::string> originals;
    for (int i = 3; i < count; ++i) {
        for (const auto& entry : std::filesystem::directory_iterator(arguments[i])) {
            std::ifstream file(entry.path(), std::ios::binary);
            if (entry.is_regular_file()) originals.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
        }
    }
    std::ranges::sort(originals);  // folders have no order
    if (originals.empty()) return EXIT_FAILURE;
    const int mutants = std::atoi(arguments[2]);
    for (int i = 0; i < mutants; ++i) {
        std::mt19937_64 chance(static_cast<std::uint64_t>(i) + 1'000'003 * std::hash<std::string>{}(arguments[1]));
        std::string text = originals[chance() % originals.size()];
        for (std::size_t changes = chance() % 5; changes > 0; --changes) change(text, chance, originals);
        std::ofstream(std::string("fuzz_text.") + arguments[2], std::ios::binary) << text;  // what a crash leaves behind
        LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    }
    std::printf("%d mutants of %zu texts\n", mutants, originals.size());
}

#endif
