#include "engine/record/hdf5_open.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <regex>

#include "engine/record/hdf5_attribute.hpp"

namespace cvtflow::engine::hdf5 {
namespace {

/// HDF5 tells a missing file from a foreign one only in prose, so the operating system is asked first.
void require_file(const std::string& path) {
    if (std::error_code ignored; std::filesystem::is_directory(path, ignored)) {
        throw RecordError(path + ": a folder, not a file");
    }
    if (std::error_code ignored; std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored)) {
        throw RecordError(path + ": a device, pipe or socket, not a file");   // would be read without end, or waited for
    }
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) {
        throw RecordError(path + ": " + std::strerror(errno));
    }
    ::close(descriptor);
    if (H5Fis_hdf5(path.c_str()) <= 0) {
        throw RecordError(path + ": not an HDF5 file");
    }
}

/// A file that was not closed carries a mark that only readers of live files (SWMR) pass over.
Handle open_closed_or_live(const std::string& path) {
    const Handle access = file_access();
    const hid_t closed = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id());
    if (closed >= 0) {
        return {closed, H5Fclose, ""};
    }
    const std::string reason = last_reason();
    if (reason.find("SWMR") != std::string::npos || reason.find("already open for write") != std::string::npos) {
        return {H5Fopen(path.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, access.id()), H5Fclose, "live"};
    }
    throw Failure(reason);
}

[[noreturn]] void throw_unreadable(const std::string& path, const std::string& reason) {
    static const std::regex truncated("truncated file: eof = ([0-9]+), .*stored_eof = ([0-9]+)");
    if (std::smatch sizes; std::regex_search(reason, sizes, truncated)) {
        throw RecordError(path + ": truncated HDF5 file: " + sizes[1].str() + " bytes of " + sizes[2].str());
    }
    throw RecordError(path + ": damaged HDF5 file (" + reason + ")");
}

void require_kind(hid_t file, const std::string& path, const std::string& format, std::int64_t version) {
    const std::string found = read_text(file, "format");
    if (found != format) {
        throw RecordError(path + ": an HDF5 file, but not a " + format + (found.empty() ? "" : " (format: '" + found + "')"));
    }
    if (const std::int64_t given = read_integer(file, "format_version", 0); given > version) {
        throw RecordError(path + ": format version " + std::to_string(given) + " is newer than this program reads (" +
                          std::to_string(version) + ")");
    }
}

}  // namespace

Handle open_for_reading(const std::string& path, const std::string& format, std::int64_t version) {
    const QuietErrors quiet;
    require_file(path);
    Handle file;
    try {
        file = open_closed_or_live(path);
    } catch (const Failure& failure) {
        throw_unreadable(path, failure.what());
    }
    guarded(path, [&] { require_kind(file.id(), path, format, version); });
    return file;
}

}  // namespace cvtflow::engine::hdf5
