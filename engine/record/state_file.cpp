#include "engine/record/state_file.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "engine/base/hash.hpp"
#include "engine/record/hdf5_attribute.hpp"
#include "engine/record/hdf5_open.hpp"
#include "engine/record/hdf5_series.hpp"
#include "engine/record/part_file.hpp"

namespace cvtflow::engine {
namespace {

constexpr const char* state_format = "cvtflow state";
constexpr std::int64_t state_format_version = 1;
constexpr std::array own_attributes{"format", "format_version", "time", "fingerprint", "state_hash"};

bool is_own(const Attribute& attribute) {
    return std::find(own_attributes.begin(), own_attributes.end(), attribute.name) != own_attributes.end();
}

std::string hash_of(const SavedState& saved) {
    Hash hash;
    hash.add(std::span<const double>(saved.state)).add(std::span<const std::uint8_t>(saved.phases));
    for (const NamedArray& array : saved.more) hash.add(std::string_view(array.name)).add(std::span<const double>(array.values));
    return hash.hex();
}

void write_array(hid_t file, const char* name, hid_t type, std::size_t count, const void* values) {
    const std::string what = std::string("cannot write '") + name + "'";
    const hsize_t size = count;
    const hdf5::Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, what);
    const hdf5::Handle dataset(H5Dcreate2(file, name, type, space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose, what);
    if (count > 0) {
        hdf5::check(H5Dwrite(dataset.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), what);
    }
}

void write_more(hid_t file, const std::vector<NamedArray>& arrays) {
    if (arrays.empty()) {
        return;
    }
    const hdf5::Handle group(H5Gcreate2(file, "more", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "cannot write 'more'");
    for (const NamedArray& array : arrays) {
        write_array(group.id(), array.name.c_str(), H5T_NATIVE_DOUBLE, array.values.size(), array.values.data());
    }
}

/// The bytes of the file. Made in memory: HDF5 cannot give up half-way on a full disk without trouble, write(2) can.
/// @param name of the file in memory: HDF5 takes two of one name for the same file, whichever thread made them
std::vector<std::byte> image_of(const SavedState& saved, const std::string& name) {
    // Oldest format on purpose: H5Fget_file_image (1.10.8) clears flags in newer superblocks without renewing their checksum.
    const hdf5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "cannot build the file in memory");
    hdf5::check(H5Pset_fapl_core(access.id(), std::size_t{1} << 16U, 0), "cannot build the file in memory");
    const hdf5::Handle file(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose, "cannot build the file in memory");
    for (const Attribute& attribute : saved.attributes) {
        if (attribute.name.empty() || is_own(attribute)) {
            throw hdf5::Failure("the name '" + attribute.name + "' is reserved (attribute)");
        }
        hdf5::write_attribute(file.id(), attribute);
    }
    hdf5::write_attribute(file.id(), {"format", state_format});
    hdf5::write_attribute(file.id(), {"format_version", state_format_version});
    hdf5::write_attribute(file.id(), {"time", saved.time});
    hdf5::write_attribute(file.id(), {"fingerprint", saved.fingerprint});
    hdf5::write_attribute(file.id(), {"state_hash", hash_of(saved)});
    write_array(file.id(), "y", H5T_NATIVE_DOUBLE, saved.state.size(), saved.state.data());
    write_array(file.id(), "phases", H5T_NATIVE_UINT8, saved.phases.size(), saved.phases.data());
    write_more(file.id(), saved.more);
    hdf5::check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "cannot build the file in memory");
    const auto size = static_cast<std::size_t>(hdf5::check(H5Fget_file_image(file.id(), nullptr, 0), "cannot build the file in memory"));
    std::vector<std::byte> image(size);
    hdf5::check(H5Fget_file_image(file.id(), image.data(), size), "cannot build the file in memory");
    return image;
}

template <class Value>
std::vector<Value> read_array(hid_t file, const char* name, hid_t type) {
    const hdf5::Handle dataset = hdf5::open_series(file, std::string("/") + name);
    const std::size_t count = hdf5::extent(dataset.id()).at(0);
    std::vector<Value> values(count);
    hdf5::read_rows(dataset.id(), type, 0, count, values.data());
    return values;
}

herr_t note_name(hid_t /*group*/, const char* name, const H5L_info_t* /*info*/, void* names) {
    static_cast<std::vector<std::string>*>(names)->emplace_back(name);
    return 0;
}

std::vector<NamedArray> read_more(hid_t file) {
    std::vector<NamedArray> arrays;
    if (H5Lexists(file, "more", H5P_DEFAULT) <= 0) {
        return arrays;
    }
    std::vector<std::string> names;
    const hdf5::Handle group(H5Gopen2(file, "more", H5P_DEFAULT), H5Gclose, "cannot open 'more'");
    hdf5::check(H5Literate(group.id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, note_name, &names), "cannot read 'more'");
    for (std::string& name : names) {
        auto values = read_array<double>(file, ("more/" + name).c_str(), H5T_NATIVE_DOUBLE);
        arrays.push_back({std::move(name), std::move(values)});
    }
    return arrays;
}

SavedState read_contents(hid_t file) {
    SavedState saved;
    saved.more = read_more(file);
    saved.state = read_array<double>(file, "y", H5T_NATIVE_DOUBLE);
    saved.phases = read_array<std::uint8_t>(file, "phases", H5T_NATIVE_UINT8);
    saved.fingerprint = hdf5::read_text(file, "fingerprint");
    saved.attributes = hdf5::read_attributes(file);
    for (const Attribute& attribute : saved.attributes) {
        if (const auto* time = std::get_if<double>(&attribute.value); time != nullptr && attribute.name == "time") {
            saved.time = *time;
        }
    }
    std::erase_if(saved.attributes, is_own);
    if (hdf5::read_text(file, "state_hash") != hash_of(saved)) {
        throw hdf5::Failure("damaged: the state does not have the hash it was saved with");
    }
    return saved;
}

}  // namespace

void write_state(const std::string& path, const SavedState& unsorted) {
    SavedState saved = unsorted;
    std::sort(saved.more.begin(), saved.more.end(), [](const NamedArray& a, const NamedArray& b) { return a.name < b.name; });
    const std::vector<std::byte> image = hdf5::guarded(path, [&] { return image_of(saved, path); });
    PartFile part(path, true);
    if (const int reason = part.write(image.data(), image.size()); reason != 0) {
        part.discard();
        throw RecordError(path + ": cannot write: " + std::strerror(reason));
    }
    part.publish();
}

SavedState read_state(const std::string& path) {
    const hdf5::Handle file = hdf5::open_for_reading(path, state_format, state_format_version);
    return hdf5::guarded(path, [&] { return read_contents(file.id()); });
}

}  // namespace cvtflow::engine
