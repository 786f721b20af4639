#pragma once
/// Internal to engine/record: owned HDF5 identifiers, their attributes, and HDF5's errors as exceptions. Not for public headers. Texts are
/// UTF-8 of fixed length, padded with zeros; h5py reads them as bytes.

#include <hdf5.h>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/record/run/schema.hpp"

namespace cvtflow::engine::hdf5 {

/// A failure without the file's name: "what was tried: reason". guarded() adds the name and makes a RecordError of it.
struct Failure : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Keeps HDF5 from printing error stacks in this thread while it lives, then restores the setting of the host program.
class QuietErrors {
public:
    QuietErrors() noexcept;
    ~QuietErrors();
    QuietErrors(const QuietErrors&) = delete;
    QuietErrors& operator=(const QuietErrors&) = delete;

private:
    H5E_auto2_t print_ = nullptr;
    void* client_ = nullptr;
};

/// The reason in HDF5's present error stack: the system's message if a system call failed, else the innermost description.
[[nodiscard]] std::string last_reason();

/// Throws Failure("what: reason") if an HDF5 call returned a negative number; otherwise hands that number back.
template <class Result>
Result check(Result result, std::string_view what) {
    if (result < 0) throw Failure(std::string(what) + ": " + last_reason());
    return result;
}

/// Owner of one identifier of HDF5.
class Handle {
public:
    using Close = herr_t (*)(hid_t);

    Handle() = default;
    /// Throws Failure("what: reason") if id is negative, as HDF5 reports a failed call.
    Handle(hid_t id, Close closer, std::string_view what) : id_(check(id, what)), close_(closer) {}
    Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
    Handle& operator=(Handle&& other) noexcept {
        std::swap(id_, other.id_);
        std::swap(close_, other.close_);
        return *this;
    }
    ~Handle() { release(); }

    [[nodiscard]] hid_t id() const noexcept { return id_; }
    [[nodiscard]] explicit operator bool() const noexcept { return id_ >= 0; }
    /// Closes and reports failure, which a destructor cannot.
    void close(std::string_view what);
    /// Closes; failure is ignored.
    void release() noexcept;

private:
    hid_t id_ = -1;
    Close close_ = nullptr;
};

/// Runs the body quietly and turns its Failure into RecordError("path: what was tried: reason").
template <class Body>
decltype(auto) guarded(const std::string& path, Body&& body) {
    const QuietErrors quiet;
    try {
        return body();
    } catch (const Failure& failure) {
        throw RecordError(path + ": " + failure.what());
    }
}

/// Descriptor of an open file. Throws Failure.
[[nodiscard]] int descriptor_of(hid_t file);

/// Appends, in iterations, a name to the std::vector<std::string> behind `names`. @return HDF5's convention: 0, or -1 without memory
[[nodiscard]] herr_t note_name(const char* name, void* names) noexcept;

/// Diverts further writes of a file to memory, so that closing succeeds and the file stays as it was at the first failed write. Otherwise
/// HDF5 1.10 repeats the write, fails to close, and crashes at the end of the program.
void divert_writes(hid_t file) noexcept;

/// Access properties for reading a file that may be open for writing: data without a valid checksum are read again, as they may be half
/// written, but not for ever. HDF5 waits 1 ns, 2 ns, 4 ns …: 22 times take 5 ms, its default of 100 times the age of the universe.
[[nodiscard]] Handle live_access();

/// Access properties of all our files: format of HDF5 1.10 (which single-writer-multiple-reader needs), and none of HDF5's file locks,
/// because with them a reader of a running simulation's file can end the simulation.
[[nodiscard]] Handle file_access();

/// Datatype of a text: UTF-8, as many bytes, at least one.
[[nodiscard]] Handle text_type(std::size_t width);

/// Creates or replaces an attribute. Throws Failure.
void write_attribute(hid_t object, const Attribute& attribute);
/// Same, for a list of texts. Throws Failure.
void write_texts(hid_t object, const std::string& name, const std::vector<std::string>& texts);
/// Same, for a text of each row.
template <class Row>
void write_texts(hid_t object, const std::string& name, const std::vector<Row>& rows, std::string Row::*text) {
    std::vector<std::string> texts;
    for (const Row& row : rows) texts.push_back(row.*text);
    write_texts(object, name, texts);
}

[[nodiscard]] bool has_attribute(hid_t object, const std::string& name);
/// All scalar attributes that are text of fixed length, integer or real, by name; others (such as those of dimension scales) are passed
/// over.
[[nodiscard]] std::vector<Attribute> read_attributes(hid_t object);
/// A scalar text, or "" if absent or of another kind.
[[nodiscard]] std::string read_text(hid_t object, const std::string& name);
/// A scalar number, or the fallback.
[[nodiscard]] std::int64_t read_integer(hid_t object, const std::string& name, std::int64_t fallback);
/// A list of texts, empty if absent or of another kind.
[[nodiscard]] std::vector<std::string> read_texts(hid_t object, const std::string& name);

}  // namespace cvtflow::engine::hdf5
