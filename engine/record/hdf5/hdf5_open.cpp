#include "engine/record/hdf5/hdf5_open.hpp"

#include <cstring>
#include <new>
#include <regex>
#include <string>

#include "engine/record/hdf5/hdf5_handle.hpp"
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
    if (format == "cvtflow state") return "state of version 0.4: settle or run again";
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
    if (mark == Marked::no) throw RecordError(path + (path.ends_with(".toml") ? ": a scene or a sweep, not a result" : ": not an HDF5 file"));
    if (mark == Marked::old && kind.format != nullptr) throw RecordError(path + ": an HDF5 file, but not a " + name_of_kind(kind.format));
    const Seal seal = inspect_seal(input);
    if (seal == Seal::broken) throw_damaged(path, "changed after it was finished: its checksum differs");
    OpenFile open{{}, seal == Seal::whole};
    try {
        open.file = open_that(path, input);
    } catch (const Failure& failure) {
        throw_unreadable(path, failure.what());
    }
    guarded(path, [&] { require_kind(open.file.id(), path, kind); });
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
    const OpenFile open = open_for_reading(path, {nullptr, 0});
    return guarded(path, [&] { return read_text(open.file.id(), "format"); });
}

}  // namespace cvtflow::engine::hdf5
