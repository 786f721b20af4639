#include "tests/tools/program_fixture.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "engine/executor/catalogue.hpp"
#include "tasks/method/method.hpp"

namespace cvtflow::tools {

namespace fs = std::filesystem;

namespace {

std::string contents(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

/// Names that no other child of any test process has.
std::string unique_name(const std::string& what) {
    static std::atomic<int> number{0};
    return "cvtflow_" + what + "_" + std::to_string(getpid()) + "_" + std::to_string(number++);
}

void redirect(const fs::path& file, int descriptor) {
    const int target = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (target < 0 || dup2(target, descriptor) < 0) _exit(126);
}

}  // namespace

Words commands_of(const std::string& program) {
    std::FILE* pipe = popen(("'" + program + "' --help").c_str(), "r");
    if (pipe == nullptr) throw std::runtime_error("popen");
    std::string help;
    char buffer[4096];
    while (const std::size_t size = std::fread(buffer, 1, sizeof buffer, pipe)) help.append(buffer, size);
    pclose(pipe);
    Words names;
    bool listed = false;
    std::istringstream lines(help);
    for (std::string line; std::getline(lines, line);) {
        if (listed && line.starts_with("  ") && line[2] != ' ') names.push_back(line.substr(2, line.find(' ', 2) - 2));
        listed = line.starts_with("Commands ") || (listed && line.starts_with("  "));
    }
    return names;
}

#ifdef CVTFLOW_LAB
std::string program_of(const Words& words) {
    static const Words product = commands_of(CVTFLOW_PROGRAM), lab = commands_of(CVTFLOW_LAB);
    const auto has = [&](const Words& commands) {
        return !words.empty() && std::find(commands.begin(), commands.end(), words[0]) != commands.end();
    };
    if (!words.empty() && words[0] == laboratory) return CVTFLOW_LAB;
    const bool asks_for_lab = std::any_of(words.begin(), words.end(), [](const std::string& word) {
        const std::string value = word.substr(word.find('=') + 1);
        return tasks::belongs_to_laboratory(value) || engine::executor_of_laboratory(value);
    });
    return has(lab) && (asks_for_lab || !has(product)) ? CVTFLOW_LAB : CVTFLOW_PROGRAM;
}
#else
std::string program_of(const Words&) { return CVTFLOW_PROGRAM; }
#endif

namespace {

/// The program, and its arguments without the name that may have stood before them.
Words command_line(Words words) {
    const std::string program = program_of(words);
    if (!words.empty() && words[0] == laboratory) words.erase(words.begin());
    words.insert(words.begin(), program);
    return words;
}

}  // namespace

Child::Child(std::vector<std::string> arguments, const fs::path& folder, const std::vector<std::string>& environment, unsigned seconds)
    : out_(fs::temp_directory_path() / unique_name("out")), err_(fs::temp_directory_path() / unique_name("err")) {
    arguments = command_line(std::move(arguments));
    std::vector<char*> words;
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    std::vector<std::string> settings = environment;
    process_ = fork();
    if (process_ < 0) throw std::runtime_error("fork");
    if (process_ > 0) return;
    for (std::string& setting : settings) putenv(setting.data());
    alarm(seconds);  // outlives exec
    redirect(out_, STDOUT_FILENO);
    redirect(err_, STDERR_FILENO);
    if (chdir(folder.c_str()) == 0) execv(words[0], words.data());
    _exit(127);
}

Child::~Child() {
    if (process_ > 0) {
        kill(process_, SIGKILL);
        waitpid(process_, nullptr, 0);
    }
    std::error_code ignored;
    fs::remove(out_, ignored);
    fs::remove(err_, ignored);
}

Outcome Child::wait() {
    int status = 0;
    waitpid(process_, &status, 0);
    process_ = -1;
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), contents(out_), contents(err_)};
}

Words set_all(const Words& settings) {
    Words words;
    for (const std::string& setting : settings) words.insert(words.end(), {"--set", setting});
    return words;
}

Program::Program() : folder_(fs::temp_directory_path() / ("cvtflow_test_" + std::to_string(getpid()))) {
    fs::remove_all(folder_);  // of a test with the same process number that was killed
    fs::create_directory(folder_);
}

Program::~Program() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

Outcome Program::run(const std::vector<std::string>& arguments, const std::vector<std::string>& environment) const {
    return Child(arguments, folder_, environment).wait();
}

void Program::write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name, std::ios::binary) << text; }

std::string Program::read(const std::string& name) const { return contents(folder_ / name); }

bool Program::exists(const std::string& name) const { return fs::exists(folder_ / name); }

}  // namespace cvtflow::tools
