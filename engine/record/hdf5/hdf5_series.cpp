#include "engine/record/hdf5/hdf5_series.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

namespace cvtflow::engine::hdf5 {

namespace {

/// Rows of a dataset, in the file and as a block in memory.
struct RowSpaces {
    Handle file, memory;

    RowSpaces(hid_t dataset, int rank, std::size_t first, std::size_t rows, std::size_t width, std::string_view what)
        : file(H5Dget_space(dataset), H5Sclose, what) {
        const std::array<hsize_t, 2> begin{first, 0}, block{rows, width};
        check(H5Sselect_hyperslab(file.id(), H5S_SELECT_SET, begin.data(), nullptr, block.data(), nullptr), what);
        memory = {H5Screate_simple(rank, block.data(), nullptr), H5Sclose, what};
    }
};

/// H5Ovisit's callback: appends the paths of datasets to the std::vector<std::string> behind `names`.
herr_t note_dataset(hid_t, const char* name, const H5O_info_t* object, void* names) noexcept {
    return object->type == H5O_TYPE_DATASET ? note_name(name, names) : 0;
}

}  // namespace

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
    check(H5Pset_fletcher32(layout.id()), what);
    if (H5Tget_class(shape.type) == H5T_FLOAT) {
        const double missing = std::numeric_limits<double>::quiet_NaN();
        check(H5Pset_fill_value(layout.id(), H5T_NATIVE_DOUBLE, &missing), what);
    }
    return {H5Dcreate2(file, shape.path.c_str(), shape.type, space.id(), links.id(), layout.id(), H5P_DEFAULT), H5Dclose, what};
}

Handle open_series(hid_t file, const std::string& path) {
    return {H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, "cannot open '" + path + "'"};
}

Series::Series(hid_t file, std::string path, Cells cells, int max_rank) : path_(std::move(path)) {
    if (!has_object(file, path_)) fail("it does not exist");
    {
        const Handle object(H5Oopen(file, path_.c_str(), H5P_DEFAULT), H5Oclose, "cannot open '" + path_ + "'");
        if (H5Iget_type(object.id()) != H5I_DATASET) fail("it is not a dataset");
    }
    dataset_ = open_series(file, path_);
    require_type(cells);
    require_extent(max_rank);
}

void Series::fail(const std::string& reason) const { throw Failure("cannot read '" + path_ + "': " + reason); }

void Series::require_type(Cells cells) const {
    const Handle type(H5Dget_type(id()), H5Tclose, "cannot read the type of '" + path_ + "'");
    const H5T_class_t kind = H5Tget_class(type.id());
    const std::size_t size = H5Tget_size(type.id());
    if (cells == Cells::reals && (kind != H5T_FLOAT || (size != sizeof(double) && size != sizeof(float)))) fail("it is not of reals");
    if (cells == Cells::bytes && (kind != H5T_INTEGER || size != 1)) fail("it is not of uint8");
    if (cells == Cells::records) require_record_type(type.id(), "cannot read '" + path_ + "'");
}

void Series::require_extent(int max_rank) {
    const Handle space(H5Dget_space(id()), H5Sclose, "cannot read the shape of '" + path_ + "'");
    const int rank = H5Sget_simple_extent_type(space.id()) == H5S_SIMPLE ? H5Sget_simple_extent_ndims(space.id()) : 0;
    if (rank < 1 || rank > max_rank) fail("it has rank " + std::to_string(rank));
    std::array<hsize_t, 2> sizes{0, 1};
    check(H5Sget_simple_extent_dims(space.id(), sizes.data(), nullptr), "cannot read the shape of '" + path_ + "'");
    rank_ = rank;
    rows_ = sizes[0];
    width_ = sizes[1];
}

void Series::read(hid_t type, std::size_t first, std::size_t count, void* memory, std::size_t bytes) const {
    if (first > rows_ || count > rows_ - first) fail("it has " + std::to_string(rows_) + " rows, not " + std::to_string(first + count));
    if (bytes != count * width_ * H5Tget_size(type)) fail("its rows have another size");
    if (count == 0) return;
    const std::string what = "cannot read '" + path_ + "'";
    const RowSpaces spaces(id(), rank_, first, count, width_, what);
    check(H5Dread(id(), type, spaces.memory.id(), spaces.file.id(), H5P_DEFAULT, memory), what);
}

std::vector<double> Series::reals(std::size_t first, std::size_t count) const {
    if (first > rows_ || count > rows_ - first)  // before memory is taken
        fail("it has " + std::to_string(rows_) + " rows, not " + std::to_string(first) + " and " + std::to_string(count));
    std::vector<double> values(count * width_);
    read(H5T_NATIVE_DOUBLE, first, count, values.data(), values.size() * sizeof(double));
    return values;
}

bool has_object(hid_t file, const std::string& path) {
    for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
        if (H5Lexists(file, path.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
        if (end == std::string::npos) return true;
    }
}

std::vector<std::string> dataset_names(hid_t file, const std::string& group) {
    std::vector<std::string> names;
    if (group != "/" && !has_object(file, group)) return names;
    const std::string what = "cannot list '" + group + "'";
    const Handle handle(H5Gopen2(file, group.c_str(), H5P_DEFAULT), H5Gclose, what);
    check(H5Ovisit2(handle.id(), H5_INDEX_NAME, H5_ITER_NATIVE, note_dataset, &names, H5O_INFO_BASIC), what);
    std::sort(names.begin(), names.end());
    return names;
}

int require_record_type(hid_t type, const std::string& what) {
    if (H5Tget_class(type) != H5T_COMPOUND) throw Failure(what + ": not a table");
    const int members = check(H5Tget_nmembers(type), what);
    for (unsigned i = 0; i < static_cast<unsigned>(members); ++i) {
        const Handle member(H5Tget_member_type(type, i), H5Tclose, what);
        const H5T_class_t kind = H5Tget_class(member.id());
        if ((kind != H5T_INTEGER && kind != H5T_FLOAT) || H5Tget_size(member.id()) != 8)
            throw Failure(what + ": its column " + std::to_string(i + 1) + " is no 8-byte number");
    }
    return members;
}

void RowBlock::add(Handle dataset, const SeriesShape& shape) {
    const std::size_t row_bytes = H5Tget_size(shape.type) * shape.width;
    members_.push_back({std::move(dataset), shape.width, row_bytes, std::make_unique_for_overwrite<std::byte[]>(row_bytes * capacity_)});
    image_.resize(std::max(image_.size(), row_bytes * chunk_ + sizeof(std::uint32_t)));
}

void RowBlock::put(std::size_t member, const void* row) noexcept {
    Member& target = members_[member];
    std::memcpy(target.rows.get() + (taken_ - first_) * target.row_bytes, row, target.row_bytes);
}

void RowBlock::put_reals(std::size_t member, std::span<double> row) noexcept {
    Member& target = members_[member];
    if (target.row_bytes == row.size_bytes()) return put(member, row.data());
    std::byte* const rounded = target.rows.get() + (taken_ - first_) * target.row_bytes;
    for (std::size_t k = 0; k < row.size(); ++k) {
        const auto value = static_cast<float>(row[k]);
        std::memcpy(rounded + k * sizeof value, &value, sizeof value);
        row[k] = value;
    }
}

void RowBlock::write() {
    if (buffered() > 0) write(false);
}

void RowBlock::complete() {
    if (taken_ > first_) write(true);
}

void RowBlock::write(bool complete) {
    for (const Member& member : members_) {
        if (&member == &members_.back() && members_.size() > 1) check(H5Fflush(member.dataset.id(), H5F_SCOPE_LOCAL), "cannot write");
        write_member(member, complete);
    }
    check(H5Dflush(members_.back().dataset.id()), "cannot write");
    const std::size_t begun = taken_ - taken_ % chunk_ - first_;  // what lies before the chunk that is not full
    for (const Member& member : members_)
        std::memmove(member.rows.get(), member.rows.get() + begun * member.row_bytes, (taken_ - first_ - begun) * member.row_bytes);
    first_ += begun;
    written_ = taken_;
}

/// Chunks go past HDF5's cache, which would take memory for each of them and copy it.
void RowBlock::write_member(const Member& member, bool complete) {
    constexpr std::uint32_t without_checksum = 1;  // mask of filters that are left out
    const hid_t dataset = member.dataset.id();
    const std::array<hsize_t, 2> extent{taken_, member.width};
    check(H5Dset_extent(dataset, extent.data()), "cannot write");
    const std::size_t size = chunk_ * member.row_bytes;
    for (std::size_t row = first_; row < taken_; row += chunk_) {
        const std::size_t rows = std::min(chunk_, taken_ - row);
        std::memcpy(image_.data(), member.rows.get() + (row - first_) * member.row_bytes, rows * member.row_bytes);
        std::memset(image_.data() + rows * member.row_bytes, 0, size - rows * member.row_bytes);
        const bool summed = complete || rows == chunk_;
        const std::uint32_t sum = summed ? fletcher32(std::span(image_).first(size)) : 0;
        std::memcpy(image_.data() + size, &sum, sizeof sum);  // little-endian, as all processors of this program
        const std::array<hsize_t, 2> first{row, 0};
        check(H5Dwrite_chunk(dataset, H5P_DEFAULT, summed ? 0 : without_checksum, first.data(), size + (summed ? sizeof sum : 0),
                             image_.data()),
              "cannot write");
    }
}

std::size_t RowBlock::growth() const noexcept {
    if (buffered() == 0) return 0;
    // A chunk per dataset more than the memory has, as the last one may get another place, and their share of the chunk index.
    constexpr std::size_t index_share = 8192;
    std::size_t bytes = 0;
    for (const Member& member : members_) bytes += member.row_bytes * (capacity_ + chunk_) + index_share;
    return bytes;
}

using EightWords [[gnu::vector_size(16)]] = std::uint16_t;
using EightSums [[gnu::vector_size(32)]] = std::uint32_t;

std::uint32_t fletcher32(std::span<const std::byte> bytes) noexcept {
    std::uint32_t low = 0, high = 0;
    const auto fold = [](std::uint32_t sum) { return (sum & 0xffffU) + (sum >> 16U); };
    constexpr std::size_t longest = 720;  // of which sums of 32 bits do not overflow [byte]
    for (; !bytes.empty(); bytes = bytes.subspan(std::min(longest, bytes.size()))) {
        const auto part = bytes.first(std::min(longest, bytes.size()));
        std::size_t k = 0;
        EightSums sums{}, sums_of_sums{};  // of every eighth word
        for (EightWords words; k + sizeof words <= part.size(); k += sizeof words) {
            std::memcpy(&words, part.data() + k, sizeof words);
            sums += __builtin_convertvector((words << 8U) | (words >> 8U), EightSums);  // of a little-endian processor
            sums_of_sums += sums;
        }
        high += static_cast<std::uint32_t>(k / 2) * low;
        for (std::uint32_t lane = 0; lane < 8; ++lane) {
            high += 8 * sums_of_sums[lane] - lane * sums[lane];
            low += sums[lane];
        }
        for (; k < part.size(); k += 2) {
            low += std::to_integer<std::uint32_t>(part[k]) << 8U;
            if (k + 1 < part.size()) low += std::to_integer<std::uint32_t>(part[k + 1]);
            high += low;
        }
        low = fold(low);
        high = fold(high);
    }
    return (fold(high) << 16U) | fold(low);
}

}  // namespace cvtflow::engine::hdf5
