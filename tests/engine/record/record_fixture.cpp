#include "tests/engine/record/record_fixture.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "engine/record/hdf5/file_seal.hpp"

namespace cvtflow::engine {

RecordTest::RecordTest() {
    std::string name = (std::filesystem::temp_directory_path() / "cvtflow-record-XXXXXX").string();
    folder_ = mkdtemp(name.data());
}

RecordTest::~RecordTest() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

std::string RecordTest::python(const std::string& program, const std::string& argument) {
    const std::string command = "/usr/bin/python3 -c '" + program + "' '" + argument + "' 2>&1";
    FILE* pipe = popen(command.c_str(), "r");
    std::string output;
    std::array<char, 4096> buffer{};
    for (std::size_t count = 0; (count = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
        output.append(buffer.data(), count);
    }
    pclose(pipe);
    return output;
}

RunContents example_contents() {
    return {.channels = {{"strand_tension", "N", "tension of the tight strand"},
                         {"ratio", "1", "speed ratio"},
                         {"links/tension", "N", "tension of every link", 3, "link"}},
            .state_size = 4,
            .phase_count = 2,
            .tables = {{"transitions",
                        "changes of phase",
                        {{"time", "s", "when", ColumnType::real}, {"pin", "1", "which pin", ColumnType::integer}}}},
            .attributes = {{"scene", std::string("baseline")}, {"pins", std::int64_t{84}}, {"pitch", 8.12e-3}}};
}

void append_example(RunFile& file, int i) {
    std::array row{1.0 * i, -1.0 * i, 10.0 * i, 10.0 * i + 1, 10.0 * i + 2};
    file.append(i / 1000.0, row);
}

void append_example_state(RunFile& file, int i) {
    file.append_state(i / 10.0, std::array{i + 0.25, i + 0.5, i + 0.75, i + 1.0},
                      std::array{static_cast<std::uint8_t>(i % 256), std::uint8_t{1}});
}

std::string error_of(const std::function<void()>& call) {
    try {
        call();
    } catch (const RecordError& error) {
        return error.what();
    }
    return "no error";
}

int start_child(const std::function<void()>& body) {
    const int child = fork();
    if (child == 0) {
        try {
            body();
        } catch (...) {
            _exit(1);
        }
        _exit(0);
    }
    return child;
}

int wait_for(int child) {
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void without_seal(const std::string& path) { std::filesystem::resize_file(path, std::filesystem::file_size(path) - seal_size); }

void seal_anew(const std::string& path) {
    const int descriptor = open(path.c_str(), O_RDWR | O_CLOEXEC);
    EXPECT_EQ(write_seal(descriptor, std::filesystem::file_size(path)), 0);
    close(descriptor);
}

std::string read_text_file(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

}  // namespace cvtflow::engine
