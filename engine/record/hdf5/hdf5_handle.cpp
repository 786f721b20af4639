#include "engine/record/hdf5/hdf5_handle.hpp"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <optional>
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
    const QuietErrors quiet;
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

namespace {

void write(hid_t object, const std::string& name, hid_t type, hid_t space, const void* data) {
    const std::string what = "cannot write attribute '" + name + "'";
    if (has_attribute(object, name)) check(H5Adelete(object, name.c_str()), what);
    Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, what);
    check(H5Awrite(attribute.id(), type, data), what);
    attribute.close(what);
}

Handle scalar() { return {H5Screate(H5S_SCALAR), H5Sclose, "cannot make a scalar"}; }

Handle open_attribute(hid_t object, const std::string& name) {
    return {H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, "cannot read attribute '" + name + "'"};
}

constexpr std::size_t max_text_bytes = std::size_t{64} << 20U;  ///< longest attribute: a scene, a sweep

constexpr std::size_t max_texts = 65'536;  ///< longest list in an attribute: columns of a table

/// Texts of an attribute of fixed length; nullopt if it is no text. HDF5 keeps texts of variable length where no checksum guards them, and
/// its release 1.10.8 crashes on damaged ones.
std::optional<std::vector<std::string>> texts_of(hid_t attribute, const std::string& what) {
    const Handle type(H5Aget_type(attribute), H5Tclose, what);
    const Handle space(H5Aget_space(attribute), H5Sclose, what);
    if (H5Tget_class(type.id()) != H5T_STRING || check(H5Tis_variable_str(type.id()), what) > 0) return std::nullopt;
    const std::size_t width = H5Tget_size(type.id());
    const auto count = static_cast<std::size_t>(check(H5Sget_simple_extent_npoints(space.id()), what));
    if (width == 0 || count > max_texts || count > max_text_bytes / width) throw Failure(what + ": it is too large");
    std::string all(width * count, '\0');
    check(H5Aread(attribute, type.id(), all.data()), what);
    if (count == 1) {
        all.resize(std::min(all.find('\0'), all.size()));
        return std::vector<std::string>{std::move(all)};
    }
    std::vector<std::string> texts(count);
    for (std::size_t i = 0; i < count; ++i) texts[i] = all.substr(i * width, width).c_str();
    return texts;
}

std::optional<Attribute> read(hid_t object, const std::string& name) {
    const std::string what = "cannot read attribute '" + name + "'";
    const Handle attribute = open_attribute(object, name);
    const Handle type(H5Aget_type(attribute.id()), H5Tclose, what);
    const Handle space(H5Aget_space(attribute.id()), H5Sclose, what);
    if (H5Sget_simple_extent_type(space.id()) != H5S_SCALAR) return std::nullopt;
    const H5T_class_t kind = H5Tget_class(type.id());
    if (kind != H5T_STRING && H5Tget_size(type.id()) > sizeof(std::int64_t)) return std::nullopt;
    if (kind == H5T_INTEGER) {
        std::int64_t value = 0;
        check(H5Aread(attribute.id(), H5T_NATIVE_INT64, &value), what);
        return Attribute{name, value};
    } else if (kind == H5T_FLOAT) {
        double value = 0.0;
        check(H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, &value), what);
        return Attribute{name, value};
    }
    auto texts = texts_of(attribute.id(), what);
    return texts && !texts->empty() ? std::optional(Attribute{name, texts->front()}) : std::nullopt;
}

}  // namespace

Handle text_type(std::size_t width) {
    Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "cannot make a text type");
    check(H5Tset_size(type.id(), std::max<std::size_t>(width, 1)), "cannot make a text type");
    check(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), "cannot make a text type");
    check(H5Tset_cset(type.id(), H5T_CSET_UTF8), "cannot make a text type");
    return type;
}

void write_attribute(hid_t object, const Attribute& attribute) {
    const Handle space = scalar();
    if (const auto* text = std::get_if<std::string>(&attribute.value))
        write(object, attribute.name, text_type(text->size()).id(), space.id(), text->c_str());
    else if (const auto* real = std::get_if<double>(&attribute.value))
        write(object, attribute.name, H5T_NATIVE_DOUBLE, space.id(), real);
    else
        write(object, attribute.name, H5T_NATIVE_INT64, space.id(), &std::get<std::int64_t>(attribute.value));
}

void write_texts(hid_t object, const std::string& name, const std::vector<std::string>& texts) {
    std::size_t width = 1;
    for (const std::string& text : texts) width = std::max(width, text.size());
    std::string all;
    for (const std::string& text : texts) {
        all += text;
        all.resize(all.size() + width - text.size(), '\0');
    }
    const hsize_t count = texts.size();
    const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose, "cannot make a list");
    write(object, name, text_type(width).id(), space.id(), all.data());
}

bool has_attribute(hid_t object, const std::string& name) {
    return check(H5Aexists(object, name.c_str()), "cannot check attribute '" + name + "'") > 0;
}

std::vector<Attribute> read_attributes(hid_t object) {
    std::vector<std::string> names;
    const auto collect = [](hid_t, const char* name, const H5A_info_t*, void* client) -> herr_t { return note_name(name, client); };
    check(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, collect, &names), "cannot list attributes");
    std::sort(names.begin(), names.end());  // as links are (hdf5_series.cpp)
    std::vector<Attribute> attributes;
    for (const std::string& name : names)
        if (auto attribute = read(object, name)) attributes.push_back(std::move(*attribute));
    return attributes;
}

std::string read_text(hid_t object, const std::string& name) {
    const auto texts = read_texts(object, name);
    return texts.empty() ? "" : texts.front();
}

std::int64_t read_integer(hid_t object, const std::string& name, std::int64_t fallback) {
    if (!has_attribute(object, name)) return fallback;
    const auto attribute = read(object, name);
    const auto* value = attribute ? std::get_if<std::int64_t>(&attribute->value) : nullptr;
    return value == nullptr ? fallback : *value;
}

std::vector<std::string> read_texts(hid_t object, const std::string& name) {
    if (!has_attribute(object, name)) return {};
    return texts_of(open_attribute(object, name).id(), "cannot read attribute '" + name + "'").value_or(std::vector<std::string>{});
}

}  // namespace cvtflow::engine::hdf5
