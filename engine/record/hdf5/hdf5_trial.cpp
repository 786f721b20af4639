#include "engine/record/hdf5/hdf5_trial.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <new>
#include <string>

#include "engine/base/number.hpp"
#include "engine/record/hdf5/hdf5_attribute.hpp"
#include "engine/record/hdf5/hdf5_series.hpp"

namespace cvtflow::engine {
namespace {

bool files_are_tried = false;  // set by a program's main(), before there are threads

/// Exit status of a child.
constexpr int out_of_memory = 3, has_a_message = 4;

[[nodiscard]] bool single_threaded() {
    std::error_code unknown;
    const std::filesystem::directory_iterator threads("/proc/self/task", unknown);
    return !unknown && std::distance(begin(threads), end(threads)) == 1;
}

void limit(decltype(RLIMIT_AS) what, rlim_t most) noexcept {
    rlimit now{};
    if (getrlimit(what, &now) != 0) return;
    now.rlim_cur = std::min(now.rlim_max, std::min(now.rlim_cur, most));
    setrlimit(what, &now);
}

void limit_child() {
    constexpr rlim_t gibibyte = rlim_t{1} << 30U;
    std::ifstream sizes("/proc/self/statm");
    std::string pages;
    sizes >> pages;
    limit(RLIMIT_AS, static_cast<rlim_t>(number_of(pages).value_or(0.0)) * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + gibibyte);
    limit(RLIMIT_CORE, 0);
    for (const int signal : {SIGPROF, SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGTERM}) std::signal(signal, SIG_DFL);
    const itimerval of_processor{{0, 0}, {1, 0}};
    setitimer(ITIMER_PROF, &of_processor, nullptr);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
}

/// What HDF5 refuses, the parent must not try: after an error in the middle of a list, HDF5 frees pointers that it has never set, which
/// ends one process and not the other.
[[noreturn]] void be_the_child(const std::function<void()>& inspect, int to_parent) {
    files_are_tried = false;
    int status = 0;
    try {
        limit_child();
        inspect();
    } catch (const std::bad_alloc&) {
        status = out_of_memory;
    } catch (const hdf5::Failure& failure) {
        const std::string_view text = failure.what();
        const ssize_t told = write(to_parent, text.data(), std::min<std::size_t>(text.size(), PIPE_BUF));
        status = told > 0 ? has_a_message : 0;
    } catch (...) {  // the parent reports the same error
    }
    _exit(status);
}

/// What was written into a pipe whose other end is closed.
[[nodiscard]] std::string text_in(int pipe) {
    std::string text(PIPE_BUF, '\0');
    const ssize_t size = read(pipe, text.data(), text.size());
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
    return text;
}

}  // namespace

void try_files_first() noexcept { files_are_tried = true; }

namespace hdf5 {
namespace {

void inspect_series(hid_t file, const std::string& path) {
    for (const Cells cells : {Cells::reals, Cells::bytes}) {
        try {
            const Series series(file, path, cells, 2);
            static_cast<void>(read_attributes(series.id()));
            std::vector<double> row(series.width());
            for (const std::size_t number : {std::size_t{0}, series.rows() - 1}) {
                if (series.rows() > 0) series.read(H5T_NATIVE_DOUBLE, number, 1, row.data(), row.size() * sizeof(double));
            }
        } catch (const Failure&) {}
    }
}

/// Rows of a table, as they lie in the file.
void inspect_table(hid_t file, const std::string& path) {
    try {
        const Series series(file, path, Cells::records);
        static_cast<void>(read_attributes(series.id()));
        const Handle type(H5Dget_type(series.id()), H5Tclose, "");
        std::vector<std::byte> row(H5Tget_size(type.id()));
        for (const std::size_t number : {std::size_t{0}, series.rows() - 1}) {
            if (series.rows() > 0) series.read(type.id(), number, 1, row.data(), row.size());
        }
    } catch (const Failure&) {}
}

}  // namespace

void inspect_everything(hid_t file) {
    try {
        static_cast<void>(read_attributes(file));
    } catch (const Failure&) {}
    for (const std::string& name : dataset_names(file, "/")) {
        inspect_series(file, "/" + name);
        inspect_table(file, "/" + name);
    }
}

void inspect_in_child(const std::function<void()>& inspect) {
    if (!files_are_tried || !single_threaded()) return;
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return;
    const pid_t child = fork();
    if (child == 0) be_the_child(inspect, ends[1]);
    close(ends[1]);
    int status = 0;
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) {}
    const std::string said = text_in(ends[0]);
    close(ends[0]);
    if (child < 0) return;  // no process available: as in a host
    if (WIFSIGNALED(status)) {
        if (WTERMSIG(status) == SIGPROF) throw OverLimit("HDF5 needs more than 1 s of processor time for it");
        throw Failure("HDF5 crashes on it");
    }
    if (WEXITSTATUS(status) == has_a_message) throw Failure(said);
    if (WEXITSTATUS(status) == out_of_memory) throw OverLimit("HDF5 needs more than 1 GiB for it");
}

}  // namespace hdf5
}  // namespace cvtflow::engine
