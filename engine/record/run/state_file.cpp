#include "engine/record/run/state_file.hpp"

#include <algorithm>
#include <array>

#include "engine/record/hdf5/file_seal.hpp"
#include "engine/record/hdf5/hdf5_handle.hpp"
#include "engine/record/hdf5/hdf5_open.hpp"
#include "engine/record/hdf5/hdf5_series.hpp"
#include "engine/record/run/part_file.hpp"

namespace cvtflow::engine {
namespace {

constexpr const char* state_format = "cvtflow state";
constexpr std::int64_t state_format_version = 2;
constexpr std::array own_attributes{"format", "format_version", "time", "fingerprint", "state_hash"};

bool is_own(const Attribute& attribute) {
    return std::find(own_attributes.begin(), own_attributes.end(), attribute.name) != own_attributes.end();
}

void write_array(hid_t file, const char* name, hid_t type, std::size_t count, const void* values) {
    const std::string what = std::string("cannot write '") + name + "'";
    const hsize_t size = count;
    const hdf5::Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, what);
    const hdf5::Handle dataset(H5Dcreate2(file, name, type, space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose, what);
    if (count > 0) hdf5::check(H5Dwrite(dataset.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), what);
}

void write_more(hid_t file, const std::vector<NamedArray>& arrays) {
    if (arrays.empty()) return;
    const hdf5::Handle group(H5Gcreate2(file, "more", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "cannot write 'more'");
    for (const NamedArray& array : arrays)
        write_array(group.id(), array.name.c_str(), H5T_NATIVE_DOUBLE, array.values.size(), array.values.data());
}

/// Format of HDF5 1.8: everything has a checksum, and texts may be long.
void create_state(const std::string& path, const SavedState& saved) {
    constexpr std::string_view what = "cannot write";
    const hdf5::Handle access = hdf5::file_access();
    hdf5::check(H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V18), what);
    hdf5::Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose, what);
    try {
        for (const Attribute& attribute : saved.attributes) {
            if (attribute.name.empty() || is_own(attribute))
                throw hdf5::Failure("the name '" + attribute.name + "' is reserved (attribute)");
            hdf5::write_attribute(file.id(), attribute);
        }
        hdf5::write_attribute(file.id(), {"format", state_format});
        hdf5::write_attribute(file.id(), {"format_version", state_format_version});
        hdf5::write_attribute(file.id(), {"time", saved.time});
        hdf5::write_attribute(file.id(), {"fingerprint", saved.fingerprint});
        write_array(file.id(), "y", H5T_NATIVE_DOUBLE, saved.state.size(), saved.state.data());
        write_array(file.id(), "phases", H5T_NATIVE_UINT8, saved.phases.size(), saved.phases.data());
        write_more(file.id(), saved.more);
        hdf5::check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), what);
    } catch (const hdf5::Failure&) {
        hdf5::divert_writes(file.id());
        throw;
    }
    file.close(what);
}

/// Bytes that the file will have at most: so much is reserved, since HDF5 cannot give up half-way on a full disk.
std::size_t most_bytes(const SavedState& saved) {
    constexpr std::size_t spare = 65536, of_name = 4096;
    std::size_t bytes = spare + sizeof(double) * saved.state.size() + saved.phases.size();
    for (const Attribute& each : saved.attributes) {
        const auto* text = std::get_if<std::string>(&each.value);
        bytes += of_name + each.name.size() + (text != nullptr ? text->size() : sizeof(double));
    }
    for (const NamedArray& each : saved.more) bytes += of_name + each.name.size() + sizeof(double) * each.values.size();
    return bytes;
}

std::vector<double> read_reals(hid_t file, const std::string& path) {
    const hdf5::Series series(file, path, hdf5::Cells::reals);
    return series.reals(0, series.rows());
}

SavedState read_contents(hid_t file) {
    SavedState saved;
    for (std::string& name : hdf5::dataset_names(file, "/more")) {
        auto values = read_reals(file, "/more/" + name);
        saved.more.push_back({std::move(name), std::move(values)});
    }
    saved.state = read_reals(file, "/y");
    const hdf5::Series phases(file, "/phases", hdf5::Cells::bytes);
    saved.phases.resize(phases.rows());
    phases.read(H5T_NATIVE_UINT8, 0, saved.phases.size(), saved.phases.data(), saved.phases.size());
    saved.fingerprint = hdf5::read_text(file, "fingerprint");
    saved.attributes = hdf5::read_attributes(file);
    if (const auto* time = attribute_value<double>(saved.attributes, "time")) saved.time = *time;
    std::erase_if(saved.attributes, is_own);
    return saved;
}

}  // namespace

void write_state(const std::string& path, const SavedState& saved) { write_state(OutputFile(path, is_state_file), saved); }

void write_state(const OutputFile& target, const SavedState& unsorted, bool durable) {
    const std::string& path = target.path;
    SavedState saved = unsorted;
    const auto by_name = [](const auto& a, const auto& b) { return a.name < b.name; };
    std::sort(saved.more.begin(), saved.more.end(), by_name);
    std::sort(saved.attributes.begin(), saved.attributes.end(), by_name);
    PartFile part(target);
    part.require(part.reserve(most_bytes(saved)));
    try {
        hdf5::guarded(path, [&] { create_state(part.path(), saved); });
    } catch (const RecordError&) {
        part.discard();
        throw;
    }
    part.trim();
    part.require(part.seal());
    part.publish(durable);
}

bool is_state_file(const std::string& file) {
    const std::string head = head_of(file);
    if (head.find_first_not_of('\0') == std::string::npos) return true;
    if (!head.starts_with("\x89HDF\r\n\x1a\n\x02")) return false;  // records begin with version 3
    try {
        return hdf5::format_of(file) == state_format;
    } catch (const RecordError&) {
        return true;
    }
}

SavedState read_state(const std::string& path) {
    const hdf5::OpenFile open = hdf5::open_for_reading(path, {state_format, state_format_version, true});
    return hdf5::guarded(path, [&] { return read_contents(open.file.id()); });
}

}  // namespace cvtflow::engine
