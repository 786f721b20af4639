#include "tools/program/front.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "tools/program/guard.hpp"

namespace cvtflow::tools {

namespace fs = std::filesystem;

namespace {

/// Whether others may change a file or folder: it is absent, everyone may write it, or its owner is neither root nor this user nor the
/// program's owner.
bool is_open_to_others(const fs::path& path, uid_t owner_of_program) {
    struct stat found {};
    if (::stat(path.c_str(), &found) != 0 || (found.st_mode & S_IWOTH) != 0) return true;
    return found.st_uid != 0 && found.st_uid != geteuid() && found.st_uid != owner_of_program;
}

/// Variables that the command gets: those of cvtflow, what libraries are searched by, where temporary and cached files go, the terminal's
/// width.
std::vector<std::string> environment(const fs::path& program) {
    std::vector<std::string> settings{"PATH=/usr/bin:/bin", "LC_ALL=C.UTF-8", "HDF5_USE_FILE_LOCKING=FALSE", "OPENBLAS_NUM_THREADS=1",
                                      "CVTFLOW_PROGRAM=" + program.string()};
    constexpr std::string_view kept[] = {"LD_LIBRARY_PATH",   "LD_PRELOAD", "TMPDIR",        "COLUMNS",
                                         "SOURCE_DATE_EPOCH", "HOME",       "XDG_CACHE_HOME"};
    for (char** each = environ; *each != nullptr; ++each) {
        const std::string_view setting = *each, name = setting.substr(0, setting.find('='));
        const bool own = name.starts_with("CVTFLOW_") && name != "CVTFLOW_PROGRAM";
        if (own || std::ranges::find(kept, name) != std::end(kept)) settings.emplace_back(setting);
    }
    return settings;
}

std::string interpreter() {
    const char* named = std::getenv("CVTFLOW_PYTHON");
    if (named == nullptr || *named == '\0') return CVTFLOW_PYTHON_FOUND;
    if (!fs::path(named).is_absolute()) throw UsageError(fmt::format("CVTFLOW_PYTHON={}: expected an absolute path", named));
    return named;
}

/// The package's file that is executed: of this build folder, or of the installation or wheel that contains this program.
std::string package_file(const fs::path& program, const std::string& name) {
    const fs::path build = CVTFLOW_BUILD_FOLDER;
    const bool built = std::mismatch(build.begin(), build.end(), program.begin(), program.end()).first == build.end();
    const fs::path place = (built ? build / "prefix/cvtflow" : program.parent_path().parent_path()) / CVTFLOW_PYTHON_DIR;
    const fs::path around = program.parent_path().parent_path();  // of a wheel, which has the program inside the package
    const fs::path file = (fs::exists(around / "__main__.py") ? around : place / "cvtflow") / name;
    struct stat of_program {};
    if (::stat(program.c_str(), &of_program) == 0 && !is_open_to_others(file, of_program.st_uid) &&
        !is_open_to_others(file.parent_path(), of_program.st_uid))
        return file.string();
    throw std::runtime_error(
        fmt::format("the Python package that this command needs is not in {}, or others may change it there: install cvtflow completely",
                    place.string()));
}

}  // namespace

std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> all;
    for (std::string& text : texts) all.push_back(text.data());
    all.push_back(nullptr);
    return all;
}

void become_python(std::span<const std::string> words, const std::string& script) {
    const fs::path program = fs::canonical("/proc/self/exe");
    std::vector<std::string> command{interpreter(), "-I", "-B", "-X", "utf8", package_file(program, script)},
        settings = environment(program);
    command.insert(command.end(), words.begin(), words.end());
    std::fflush(nullptr);
    execve(command[0].c_str(), pointers(command).data(), pointers(settings).data());
    throw std::runtime_error(
        fmt::format("{} requires Python, and {} cannot be started: {} (Debian: apt-get install python3 python3-matplotlib python3-h5py "
                    "python3-jinja2; CVTFLOW_PYTHON names another interpreter)",
                    words[0], command[0].empty() ? "python3" : command[0], std::strerror(errno)));
}

}  // namespace cvtflow::tools
