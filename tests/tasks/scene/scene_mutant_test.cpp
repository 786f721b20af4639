/// Any text is a scene or a SceneError: mutants of the ready scenes, read in a child process that may neither crash, nor take over 5 s
/// of processor time for one or 1 GB, nor say what only the standard library would say.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <random>
#include <regex>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "tasks/scene/scene.hpp"
#include "tests/engine/record/reader_limits_fixture.hpp"

namespace cvtflow::tasks {
namespace {

enum class TextMutation { bits, bytes, cut, doubled, token, number, line, spliced };
constexpr std::array<const char*, 8> text_mutations{"bits", "bytes", "cut", "doubled", "token", "number", "line", "spliced"};
enum class Reading { none, scene, refused, memory, raw };
constexpr std::size_t readings = 5;

/// Results of a child, for its parent to read after its death.
struct Tally {
    long next = 0;
    TextMutation mutation{};
    long of[text_mutations.size()][readings]{};
};

class SceneMutant : public testing::Test {
protected:
    SceneMutant() : tally_(new (mmap(nullptr, sizeof(Tally), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) Tally) {
        for (const auto& entry : std::filesystem::directory_iterator(CVTFLOW_SOURCE_DIR "/scenes")) {
            if (entry.path().extension() != ".toml") continue;
            std::ifstream file(entry.path());
            originals_.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
        }
        std::ranges::sort(originals_);  // folders have no order
    }
    ~SceneMutant() override { munmap(tally_, sizeof(Tally)); }

    using Chance = std::mt19937_64;
    [[nodiscard]] static std::size_t below(Chance& chance, std::size_t end) { return end == 0 ? 0 : chance() % end; }

    [[nodiscard]] std::string mutant(std::uint64_t seed, TextMutation& what) const;
    static void change(std::string& text, TextMutation what, Chance& chance);
    static void replace_number(std::string& text, Chance& chance);
    [[nodiscard]] static Reading read(const std::string& text);
    void work(std::uint64_t seed, long count) const;
    void expect_all_read_or_refused(std::uint64_t seed, long count);

    std::vector<std::string> originals_;
    Tally* tally_;
};

std::vector<std::string> odd_tokens() {
    std::vector<std::string> tokens{"\n", "\r", "\t", "\xef\xbb\xbf", "\xff", "\xc3", "\"1 kN\""};
    std::istringstream words(
        R"([ ] [[ " ''' """ = { } , . # \ \u0000 \U0010ffff true 1979-05-27 a.b.c.d=1 [chain] {a={a={a=1}}} [[[[[[1]]]]]]
                                "µm" inf start.state)");
    tokens.insert(tokens.end(), std::istream_iterator<std::string>(words), {});
    return tokens;
}
constexpr std::string_view odd_numbers[] = {
    "0",   "-1",  "1e309", "-1e309", "nan",   "inf", "1e-320",      "9223372036854775807", "9223372036854775808",
    "0x1", "1_0", "0b1",   "1e",     "1.2.3", "-0",  "1e999999999", "\"1e300 m\"",         "99999999999999999999999"};

void SceneMutant::replace_number(std::string& text, Chance& chance) {
    static const std::regex number("[0-9][0-9.e+-]*");
    std::vector<std::pair<std::size_t, std::size_t>> found;
    for (auto at = std::sregex_iterator(text.begin(), text.end(), number); at != std::sregex_iterator(); ++at)
        found.emplace_back(static_cast<std::size_t>(at->position()), static_cast<std::size_t>(at->length()));
    if (found.empty()) return;
    const auto [begin, length] = found[below(chance, found.size())];
    text.replace(begin, length, odd_numbers[below(chance, std::size(odd_numbers))]);
}

void SceneMutant::change(std::string& text, TextMutation what, Chance& chance) {
    if (text.empty()) return;
    const std::size_t begin = below(chance, text.size()), length = std::min(text.size() - begin, 1 + below(chance, 60));
    switch (what) {
        case TextMutation::bits: text[begin] = static_cast<char>(text[begin] ^ (1 << below(chance, 8))); break;
        case TextMutation::bytes:
            for (std::size_t i = begin; i < begin + length; ++i) text[i] = static_cast<char>(chance());
            break;
        case TextMutation::cut: text.erase(begin, length); break;
        case TextMutation::doubled: text.insert(below(chance, text.size()), text.substr(begin, length)); break;
        case TextMutation::token: {
            static const std::vector<std::string> tokens = odd_tokens();
            text.insert(begin, tokens[below(chance, tokens.size())]);
            break;
        }
        case TextMutation::number: replace_number(text, chance); break;
        case TextMutation::line: {
            const std::size_t from = text.rfind('\n', begin) + 1, to = std::min(text.find('\n', begin), text.size());
            const std::string line = from < to ? text.substr(from, to - from) + "\n" : "";
            text.insert(text.rfind('\n', below(chance, text.size())) + 1, line);
            break;
        }
        case TextMutation::spliced: break;  // needs two texts
    }
}

std::string SceneMutant::mutant(std::uint64_t seed, TextMutation& what) const {
    Chance chance(seed);
    std::string text = originals_[below(chance, originals_.size())];
    what = static_cast<TextMutation>(below(chance, text_mutations.size()));
    if (what == TextMutation::spliced) {
        const std::string& other = originals_[below(chance, originals_.size())];
        return text.substr(0, below(chance, text.size())) + other.substr(below(chance, other.size()));
    }
    for (std::size_t i = 0, count = 1 + below(chance, 4); i < count; ++i) change(text, what, chance);
    return text;
}

Reading SceneMutant::read(const std::string& text) {
    static const std::regex of_the_library("std::|_M_|basic_string|vector::|bad_|filesystem error|\\bsto[di]\\b");
    try {
        (void)parse_scene(text, "mutant.toml", StartState::ignored);
        return Reading::scene;
    } catch (const SceneError& error) {
        const std::string message = error.what();
        for (auto word = std::sregex_iterator(message.begin(), message.end(), of_the_library); word != std::sregex_iterator(); ++word)
            if (text.find(word->str()) == std::string::npos) return Reading::raw;  // a word of the mutant may be quoted
        return Reading::refused;
    } catch (const std::bad_alloc&) {
        return Reading::memory;
    } catch (const std::exception&) {
        return Reading::raw;
    }
}

void SceneMutant::work(std::uint64_t seed, long count) const {
    [[maybe_unused]] const rlimit gigabyte{rlim_t{1} << 30U, RLIM_INFINITY}, none{0, 0};
#if !defined(__SANITIZE_ADDRESS__)  // its shadow takes terabytes of addresses
    setrlimit(RLIMIT_AS, &gigabyte);
#endif
    setrlimit(RLIMIT_CORE, &none);
    for (; tally_->next < count; ++tally_->next) {
        engine::end_after(engine::reader_limits);
        const std::string text = mutant(seed * 1'000'003 + static_cast<std::uint64_t>(tally_->next), tally_->mutation);
        const Reading reading = read(text);
        ++tally_->of[static_cast<std::size_t>(tally_->mutation)][static_cast<std::size_t>(reading)];
        if (reading != Reading::raw) continue;
        const std::string kept = fmt::format("cvtflow_mutant_{}_{}.toml", seed, tally_->next);
        std::ofstream(std::filesystem::temp_directory_path() / kept, std::ios::binary) << text;
        ADD_FAILURE() << "mutant kept as " << kept;
    }
}

void SceneMutant::expect_all_read_or_refused(std::uint64_t seed, long count) {
    *tally_ = {};
    (void)read("[run]\nmethod = \"r\"");  // the catalogue of methods is made once
    long ended = 0;
    while (tally_->next < count) {
        const pid_t child = fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            work(seed, count);
            _exit(0);
        }
        int status = 0;
        waitpid(child, &status, 0);
        if (WIFEXITED(status) && WEXITSTATUS(status) == 0) break;
        ++ended;
        ADD_FAILURE() << "mutant " << tally_->next++ << " of seed " << seed << ", "
                      << text_mutations[static_cast<std::size_t>(tally_->mutation)] << ", ended its reader with status " << status;
    }
    std::printf("%-10s %8s %8s %10s %16s\n", "mutants", "scenes", "refused", "over 1 GB", "unfit message");
    long read = 0, refused = 0;
    for (std::size_t i = 0; i < text_mutations.size(); ++i) {
        const long* of = tally_->of[i];
        std::printf("%-10s %8ld %8ld %10ld %16ld\n", text_mutations[i], of[1], of[2], of[3], of[4]);
        EXPECT_EQ(of[3] + of[4], 0) << text_mutations[i];
        read += of[1];
        refused += of[2];
    }
    EXPECT_EQ(read + refused + ended, count);
    EXPECT_GT(refused, count / 10);  // the mutants are some
    EXPECT_GT(read, count / 100);    // and not only noise
}

TEST_F(SceneMutant, IsAlwaysASceneOrRefusedInWords) { expect_all_read_or_refused(1, 5'000); }

/// A million.
class NightlySceneMutant : public SceneMutant, public testing::WithParamInterface<std::uint64_t> {};

TEST_P(NightlySceneMutant, FiftyThousandAreScenesOrRefusedInWords) { expect_all_read_or_refused(GetParam(), 50'000); }

INSTANTIATE_TEST_SUITE_P(Seeds, NightlySceneMutant, testing::Range<std::uint64_t>(2, 22));

}  // namespace
}  // namespace cvtflow::tasks
