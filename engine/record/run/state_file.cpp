#include "engine/record/run/state_file.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "engine/base/hash.hpp"
#include "engine/record/hdf5/file_seal.hpp"
#include "engine/record/hdf5/hdf5_handle.hpp"
#include "engine/record/hdf5/hdf5_open.hpp"
#include "engine/record/hdf5/hdf5_series.hpp"

namespace cvtflow::engine {
namespace {

constexpr const char* state_format = "cvtflow state";
constexpr std::int64_t state_format_version = 2;
constexpr std::array own_attributes{"format", "format_version", "time", "fingerprint", "state_hash"};

bool is_own(const Attribute& attribute) {
    return std::find(own_attributes.begin(), own_attributes.end(), attribute.name) != own_attributes.end();
}

/// Hash of all contents of a state. Lengths are hashed too, so that no character can move from one text to the next.
std::string hash_of(const SavedState& saved) {
    Hash hash;
    const auto add_text = [&hash](std::string_view text) { hash.add(static_cast<std::uint64_t>(text.size())).add(text); };
    const auto add_reals = [&hash](std::span<const double> values) { hash.add(static_cast<std::uint64_t>(values.size())).add(values); };
    add_reals({&saved.time, 1});
    add_reals(saved.state);
    hash.add(static_cast<std::uint64_t>(saved.phases.size())).add(std::span<const std::uint8_t>(saved.phases));
    add_text(saved.fingerprint);
    for (const Attribute& attribute : saved.attributes) {
        add_text(attribute.name);
        hash.add(static_cast<std::uint64_t>(attribute.value.index()));
        if (const auto* text = std::get_if<std::string>(&attribute.value))
            add_text(*text);
        else if (const auto* real = std::get_if<double>(&attribute.value))
            add_reals({real, 1});
        else
            hash.add(static_cast<std::uint64_t>(std::get<std::int64_t>(attribute.value)));
    }
    for (const NamedArray& array : saved.more) {
        add_text(array.name);
        add_reals(array.values);
    }
    return hash.hex();
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

/// The bytes of the file. Made in memory: HDF5 cannot give up half-way on a full disk without trouble, write(2) can.
/// @param name of the file in memory: HDF5 takes two of one name for the same file, whichever thread made them
std::vector<std::byte> image_of(const SavedState& saved, const std::string& name) {
    constexpr std::string_view what = "cannot build the file in memory";
    // Format of HDF5 1.8: everything has a checksum, and texts may be long.
    const hdf5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, what);
    hdf5::check(H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V18), what);
    hdf5::check(H5Pset_fapl_core(access.id(), std::size_t{1} << 16U, 0), what);
    const hdf5::Handle file(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose, what);
    for (const Attribute& attribute : saved.attributes) {
        if (attribute.name.empty() || is_own(attribute)) throw hdf5::Failure("the name '" + attribute.name + "' is reserved (attribute)");
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
    hdf5::check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), what);
    const auto size = static_cast<std::size_t>(hdf5::check(H5Fget_file_image(file.id(), nullptr, 0), what));
    std::vector<std::byte> image(size);
    hdf5::check(H5Fget_file_image(file.id(), image.data(), size), what);
    hdf5::renew_superblock(image);  // whose flags H5Fget_file_image (1.10.8) clears without renewing its checksum
    return image;
}

std::vector<double> read_reals(hid_t file, const std::string& path) {
    const hdf5::Series series(file, path, hdf5::Cells::reals);
    return series.reals(0, series.rows());
}

std::vector<std::uint8_t> read_bytes(hid_t file, const std::string& path) {
    const hdf5::Series series(file, path, hdf5::Cells::bytes);
    std::vector<std::uint8_t> values(series.rows());
    series.read(H5T_NATIVE_UINT8, 0, values.size(), values.data(), values.size());
    return values;
}

std::vector<NamedArray> read_more(hid_t file) {
    std::vector<NamedArray> arrays;
    for (std::string& name : hdf5::dataset_names(file, "/more")) {
        auto values = read_reals(file, "/more/" + name);
        arrays.push_back({std::move(name), std::move(values)});
    }
    return arrays;
}

SavedState read_contents(hid_t file) {
    SavedState saved;
    saved.more = read_more(file);
    saved.state = read_reals(file, "/y");
    saved.phases = read_bytes(file, "/phases");
    saved.fingerprint = hdf5::read_text(file, "fingerprint");
    saved.attributes = hdf5::read_attributes(file);
    if (const auto* time = attribute_value<double>(saved.attributes, "time")) saved.time = *time;
    std::erase_if(saved.attributes, is_own);
    if (hdf5::read_text(file, "state_hash") != hash_of(saved)) throw hdf5::Failure("damaged: the hash of the state differs");
    return saved;
}

}  // namespace

void write_state(const std::string& path, const SavedState& saved) {
    write_state(Permit(path, {.what = "state", .own = is_state_file, .repeats = true}), saved);
}

void write_state(const Permit& permit, const SavedState& unsorted, bool durable) {
    const std::string& path = permit.path();
    SavedState saved = unsorted;
    const auto by_name = [](const auto& a, const auto& b) { return a.name < b.name; };
    std::sort(saved.more.begin(), saved.more.end(), by_name);
    std::sort(saved.attributes.begin(), saved.attributes.end(), by_name);
    std::vector<std::byte> image = hdf5::guarded(path, [&] { return image_of(saved, path); });
    const auto seal = seal_of(image.size(), Checksum().add(image));
    image.insert(image.end(), seal.begin(), seal.end());
    write_whole(permit, {reinterpret_cast<const char*>(image.data()), image.size()}, durable);
}

SavedState read_state(const std::string& path) {
    const hdf5::OpenFile open = hdf5::open_for_reading(path, {state_format, state_format_version, true});
    return hdf5::guarded(path, [&] { return read_contents(open.file.id()); });
}

}  // namespace cvtflow::engine
