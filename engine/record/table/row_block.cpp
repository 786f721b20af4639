#include "engine/record/table/row_block.hpp"

#include <array>
#include <cstring>

namespace cvtflow::engine::hdf5 {

void RowBlock::add(Handle dataset, const SeriesShape& shape) {
    const std::size_t row_bytes = H5Tget_size(shape.type) * shape.width;
    members_.push_back({std::move(dataset), shape.type, shape.width, shape.flat, row_bytes, std::vector<std::byte>(row_bytes * capacity_)});
}

void RowBlock::put(std::size_t member, const void* row) noexcept {
    Member& target = members_[member];
    std::memcpy(target.rows.data() + buffered_ * target.row_bytes, row, target.row_bytes);
}

void RowBlock::write() {
    if (buffered_ == 0) {
        return;
    }
    for (const Member& member : members_) {
        write_member(member);
    }
    written_ += buffered_;
    buffered_ = 0;
}

void RowBlock::write_member(const Member& member) const {
    constexpr std::string_view what = "cannot write";
    const int rank = member.flat ? 1 : 2;
    const std::array<hsize_t, 2> extent{written_ + buffered_, member.width};
    const std::array<hsize_t, 2> first{written_, 0};
    const std::array<hsize_t, 2> count{buffered_, member.width};
    check(H5Dset_extent(member.dataset.id(), extent.data()), what);
    const Handle file_rows(H5Dget_space(member.dataset.id()), H5Sclose, what);
    check(H5Sselect_hyperslab(file_rows.id(), H5S_SELECT_SET, first.data(), nullptr, count.data(), nullptr), what);
    const Handle memory_rows(H5Screate_simple(rank, count.data(), nullptr), H5Sclose, what);
    check(H5Dwrite(member.dataset.id(), member.type, memory_rows.id(), file_rows.id(), H5P_DEFAULT, member.rows.data()), what);
    check(H5Dflush(member.dataset.id()), what);
}

std::size_t RowBlock::growth() const noexcept {
    if (buffered_ == 0) {
        return 0;
    }
    // One chunk per dataset at most (rows in memory never straddle a chunk's end), and its share of the chunk index.
    constexpr std::size_t index_share = 8192;
    std::size_t bytes = 0;
    for (const Member& member : members_) {
        bytes += member.row_bytes * capacity_ + index_share;
    }
    return bytes;
}

}  // namespace cvtflow::engine::hdf5
