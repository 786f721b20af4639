#include "engine/record/hdf5/hdf5_open.hpp"

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
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <regex>
#include <string>

#include "engine/base/text.hpp"
#include "engine/record/hdf5/hdf5_handle.hpp"
#include "engine/record/hdf5/hdf5_series.hpp"
#include "engine/record/run/schema.hpp"

namespace cvtflow::engine::hdf5 {

namespace {

constexpr std::size_t memory_to_open = std::size_t{4} << 20U;  ///< HDF5 takes less than 2 MiB to open a file of ours and to read an array

/// HDF5 1.10 crashes where it gets no memory, so whether there is some is asked before. (A new expression may be optimised away.)
void require_memory() { ::operator delete(::operator new(memory_to_open)); }

/// HDF5's mark, and the version of its format: until version 1 nothing in a file has a checksum, and ours were never of these.
enum class Marked { no, old, yes };

Marked mark_of(const InputFile& file) {
    constexpr char mark[] = {'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
    std::byte head[9]{};
    const std::size_t found = file.read(0, head, sizeof head);
    if (found < sizeof mark || std::memcmp(head, mark, sizeof mark) != 0) return Marked::no;
    return found == sizeof head && head[8] < std::byte{2} ? Marked::old : Marked::yes;
}

/// A file that was not closed carries a mark that only readers of live files (SWMR) pass over; where its writer was killed while the file
/// grew, it is also shorter than its head states. Without the mark such a file is truncated.
Handle open_closed_or_live(const std::string& path) {
    const Handle access = file_access();
    const hid_t closed = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id());
    if (closed >= 0) return {closed, H5Fclose, ""};
    const std::string reason = last_reason();
    const auto has = [&](const char* words) { return reason.find(words) != std::string::npos; };
    if (!has("SWMR") && !has("already open for write") && !has("truncated file")) throw Failure(reason);
    const hid_t live = H5Fopen(path.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, live_access().id());
    if (live < 0 && has("truncated file")) throw Failure(reason);
    return {live, H5Fclose, "live"};
}

[[noreturn]] void throw_damaged(const std::string& path, const std::string& reason) {
    throw RecordError(path + ": damaged HDF5 file (" + reason + ")");
}

[[noreturn]] void throw_unreadable(const std::string& path, const std::string& reason) {
    static const std::regex truncated("truncated file: eof = ([0-9]+), .*stored_eof = ([0-9]+)");
    if (std::smatch sizes; std::regex_search(reason, sizes, truncated))
        throw RecordError(path + ": truncated HDF5 file: " + sizes[1].str() + " bytes of " + sizes[2].str());
    throw_damaged(path, reason);
}

/// Name of a file of that format in messages.
std::string name_of_kind(const std::string& format) {
    if (format == "cvtflow run") return "record of a run";
    if (format == "cvtflow state") return "state file";
    if (format == "cvtflow cases") return "table of a sweep's results";
    if (format == "cvtflow checkpoint") return "checkpoint";
    return "file of format '" + format + "'";
}

void require_kind(hid_t file, const std::string& path, const FileKind& kind) {
    if (kind.format == nullptr) return;
    const std::string found = read_text(file, "format");
    if (found != kind.format) {
        throw RecordError(path + ": an HDF5 file, but not a " + name_of_kind(kind.format) +
                          (found.empty() ? "" : " (it is a " + name_of_kind(found) + ")"));
    }
    if (const std::int64_t given = read_integer(file, "format_version", 0); given > kind.version) {
        throw RecordError(path + ": format version " + std::to_string(given) + " is newer than this program reads (" +
                          std::to_string(kind.version) + ")");
    }
}

/// The file that was checked; another one may have taken its name since.
Handle open_that(const std::string& path, const InputFile& checked) {
    Handle file = open_closed_or_live(path);
    if (!checked.same_as(descriptor_of(file.id()))) throw RecordError(path + ": another program has just replaced it; try again");
    return file;
}

OpenFile open_input(const std::string& path, const FileKind& kind) {
    const InputFile input(path);
    const Marked mark = mark_of(input);
    if (mark == Marked::no) throw RecordError(path + ": not an HDF5 file");
    if (mark == Marked::old && kind.format != nullptr) throw RecordError(path + ": an HDF5 file, but not a " + name_of_kind(kind.format));
    const Seal seal = inspect_seal(input);
    if (seal == Seal::broken) throw_damaged(path, "changed after it was finished: its checksum differs");
    OpenFile open{{}, seal == Seal::whole};
    try {
        inspect_in_child([&] { inspect_everything(open_that(path, input).id()); });
        open.file = open_that(path, input);
    } catch (const OverLimit& reason) {
        throw RecordError(path + ": cannot be read: " + reason.what() + "; it may be damaged");
    } catch (const Failure& failure) {
        throw_unreadable(path, failure.what());
    }
    guarded(path, [&] { require_kind(open.file.id(), path, kind); });
    if (kind.always_sealed && !open.sealed) throw_damaged(path, "no seal: changed after it was finished, or truncated");
    return open;
}

}  // namespace

OpenFile open_for_reading(const std::string& path, const FileKind& kind) {
    require_memory();  // before anything of HDF5, which initialises itself at its first call
    const QuietErrors quiet;
    try {
        return open_input(path, kind);
    } catch (const InputError& error) {
        throw RecordError(path + ": " + error.what());
    }
}

std::string format_of(const std::string& path) {
    const OpenFile open = open_for_reading(path, {nullptr, 0, false});
    return guarded(path, [&] { return read_text(open.file.id(), "format"); });
}

}  // namespace cvtflow::engine::hdf5

namespace cvtflow::engine {

namespace {

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

/// Inspects the file. The parent must not open a file that HDF5 rejects here: after an error in the middle of a list, HDF5 frees pointers
/// that it has never set, which ends one process and not the other.
[[noreturn]] void be_the_child(const std::function<void()>& inspect, int to_parent) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // it holds the locks of its parent's files, too
    try_files_first(false);
    int status = 0;
    try {
        limit_child();
        inspect();
    } catch (const std::bad_alloc&) {
        status = out_of_memory;
    } catch (const hdf5::Failure& failure) {
        const std::string_view text = failure.what();
        const ssize_t written = write(to_parent, text.data(), std::min<std::size_t>(text.size(), PIPE_BUF));
        status = written > 0 ? has_a_message : 0;
    } catch (...) {  // the parent reports the same error
    }
    _exit(status);
}

/// Text that was written into a pipe whose other end is closed.
[[nodiscard]] std::string text_in(int pipe) {
    std::string text(PIPE_BUF, '\0');
    const ssize_t size = read(pipe, text.data(), text.size());
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
    return text;
}

}  // namespace

namespace hdf5 {
namespace {

/// Reads the attributes and the first and last row of a dataset; rows of a table unconverted.
void inspect_dataset(hid_t file, const std::string& path) {
    for (const Cells cells : {Cells::reals, Cells::bytes, Cells::records}) {
        try {
            const Series series(file, path, cells, cells == Cells::records ? 1 : 2);
            static_cast<void>(read_attributes(series.id()));
            const Handle stored_type(H5Dget_type(series.id()), H5Tclose, "");
            const hid_t type = cells == Cells::records ? stored_type.id() : H5T_NATIVE_DOUBLE;
            std::vector<std::byte> row(series.width() * H5Tget_size(type));
            for (const std::size_t number : {std::size_t{0}, series.rows() - 1})
                if (series.rows() > 0) series.read(type, number, 1, row.data(), row.size());
        } catch (const Failure&) {}
    }
}

}  // namespace

void inspect_everything(hid_t file) {
    try {
        static_cast<void>(read_attributes(file));
    } catch (const Failure&) {}
    for (const std::string& name : dataset_names(file, "/")) inspect_dataset(file, "/" + name);
}

void inspect_in_child(const std::function<void()>& inspect) {
    if (!files_are_tried() || !single_threaded()) return;
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
        const int signal = WTERMSIG(status);  // one that was sent to the whole process group is no fault of the file
        if (signal == SIGTERM || signal == SIGINT || signal == SIGHUP) return inspect_in_child(inspect);
        if (signal == SIGPROF) throw OverLimit("HDF5 needs more than 1 s of processor time for it");
        throw Failure("HDF5 crashes on it");
    }
    if (WEXITSTATUS(status) == has_a_message) throw Failure(said);
    if (WEXITSTATUS(status) == out_of_memory) throw OverLimit("HDF5 needs more than 1 GiB for it");
}

}  // namespace hdf5

}  // namespace cvtflow::engine
