#include "engine/record/hdf5/hdf5_handle.hpp"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>
#include <vector>

namespace cvtflow::engine::hdf5 {
namespace {

/// Keeps the first description of a walk that begins at the innermost function.
herr_t keep_innermost(unsigned, const H5E_error2_t* error, void* client) noexcept {
    auto& reason = *static_cast<std::string*>(client);
    if (reason.empty() && error->desc != nullptr) reason = error->desc;
    return 0;
}

}  // namespace

QuietErrors::QuietErrors() noexcept {
    H5Eget_auto2(H5E_DEFAULT, &print_, &client_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

QuietErrors::~QuietErrors() { H5Eset_auto2(H5E_DEFAULT, print_, client_); }

std::string last_reason() {
    std::string reason;
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &reason);
    constexpr std::string_view mark = "error message = '";
    if (const auto begin = reason.find(mark); begin != std::string::npos) {
        const auto first = begin + mark.size();
        return reason.substr(first, reason.find('\'', first) - first);
    }
    if (reason == "no appropriate function for conversion path") return "its type cannot be converted";
    return reason.empty() ? "HDF5 gives no reason" : reason;
}

void Handle::close(std::string_view what) {
    if (id_ >= 0) check(close_(std::exchange(id_, -1)), what);
}

void Handle::release() noexcept {
    if (id_ >= 0) close_(std::exchange(id_, -1));
}

Handle file_access() {
    Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "cannot make access properties");
    check(H5Pset_libver_bounds(access.id(), H5F_LIBVER_V110, H5F_LIBVER_V110), "cannot choose the format");
    check(H5Pset_file_locking(access.id(), 0, 1), "cannot disable file locks");
    return access;
}

int descriptor_of(hid_t file) {
    void* handle = nullptr;
    check(H5Fget_vfd_handle(file, H5P_DEFAULT, &handle), "cannot get the file's descriptor");
    return *static_cast<int*>(handle);
}

std::uint64_t bytes_on_disk(hid_t file) {
    struct stat status {};
    if (fstat(descriptor_of(file), &status) != 0) throw Failure(std::string("cannot get the file's size: ") + std::strerror(errno));
    return static_cast<std::uint64_t>(status.st_size);
}

Handle live_access() {
    Handle access = file_access();
    check(H5Pset_metadata_read_attempts(access.id(), 22), "cannot make access properties");
    return access;
}

herr_t note_name(const char* name, void* names) noexcept {
    try {
        static_cast<std::vector<std::string>*>(names)->emplace_back(name);
        return 0;
    } catch (const std::bad_alloc&) {
        return -1;
    }
}

void divert_writes(hid_t file) noexcept {
    void* handle = nullptr;
    const int memory = memfd_create("abandoned", MFD_CLOEXEC);
    if (memory >= 0 && H5Fget_vfd_handle(file, H5P_DEFAULT, &handle) >= 0) dup2(memory, *static_cast<int*>(handle));
    if (memory >= 0) close(memory);
}

}  // namespace cvtflow::engine::hdf5
