#include "engine/record/hdf5_series.hpp"

#include <array>
#include <limits>

namespace cvtflow::engine::hdf5 {

Handle create_series(hid_t file, const SeriesShape& shape) {
    const std::string what = "cannot create dataset '" + shape.path + "'";
    const int rank = shape.flat ? 1 : 2;
    const std::array<hsize_t, 2> none{0, shape.width};
    const std::array<hsize_t, 2> unlimited{H5S_UNLIMITED, shape.width};
    const std::array<hsize_t, 2> chunk{shape.chunk, shape.width};
    const Handle space(H5Screate_simple(rank, none.data(), unlimited.data()), H5Sclose, what);
    const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose, what);
    check(H5Pset_create_intermediate_group(links.id(), 1), what);
    const Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, what);
    check(H5Pset_chunk(layout.id(), rank, chunk.data()), what);
    if (shape.deflate > 0) {
        check(H5Pset_shuffle(layout.id()), what);
        check(H5Pset_deflate(layout.id(), static_cast<unsigned>(shape.deflate)), what);
    }
    if (H5Tget_class(shape.type) == H5T_FLOAT) {
        const double missing = std::numeric_limits<double>::quiet_NaN();
        check(H5Pset_fill_value(layout.id(), H5T_NATIVE_DOUBLE, &missing), what);
    }
    return {H5Dcreate2(file, shape.path.c_str(), shape.type, space.id(), links.id(), layout.id(), H5P_DEFAULT), H5Dclose, what};
}

Handle open_series(hid_t file, const std::string& path) {
    return {H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, "cannot open '" + path + "'"};
}

bool has_series(hid_t file, const std::string& path) {
    for (std::size_t end = path.find('/', 1); end != std::string::npos; end = path.find('/', end + 1)) {
        if (H5Lexists(file, path.substr(0, end).c_str(), H5P_DEFAULT) <= 0) {
            return false;
        }
    }
    if (H5Lexists(file, path.c_str(), H5P_DEFAULT) <= 0) {
        return false;
    }
    const Handle object(H5Oopen(file, path.c_str(), H5P_DEFAULT), H5Oclose, "cannot open '" + path + "'");
    return H5Iget_type(object.id()) == H5I_DATASET;
}

std::vector<std::size_t> extent(hid_t dataset) {
    const Handle space(H5Dget_space(dataset), H5Sclose, "cannot read a dataset's shape");
    std::array<hsize_t, H5S_MAX_RANK> sizes{};
    const int rank = check(H5Sget_simple_extent_dims(space.id(), sizes.data(), nullptr), "cannot read a dataset's shape");
    return {sizes.begin(), sizes.begin() + rank};
}

void read_rows(hid_t dataset, hid_t type, std::size_t first, std::size_t count, void* memory) {
    constexpr std::string_view what = "cannot read";
    if (count == 0) {
        return;
    }
    const auto sizes = extent(dataset);
    std::vector<hsize_t> begin(sizes.size(), 0);
    std::vector<hsize_t> block(sizes.begin(), sizes.end());
    begin.at(0) = first;
    block.at(0) = count;
    const Handle file_rows(H5Dget_space(dataset), H5Sclose, what);
    check(H5Sselect_hyperslab(file_rows.id(), H5S_SELECT_SET, begin.data(), nullptr, block.data(), nullptr), what);
    const Handle memory_rows(H5Screate_simple(static_cast<int>(block.size()), block.data(), nullptr), H5Sclose, what);
    check(H5Dread(dataset, type, memory_rows.id(), file_rows.id(), H5P_DEFAULT, memory), what);
}

}  // namespace cvtflow::engine::hdf5
