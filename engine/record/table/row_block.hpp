#pragma once
/// Internal to engine/record: rows gathered in memory and written to extendible datasets together.

#include <cstddef>
#include <vector>

#include "engine/record/hdf5/hdf5_series.hpp"

namespace cvtflow::engine::hdf5 {

/// Rows of several datasets of equal length. Memory for one chunk of rows is taken at construction; put() and advance() never allocate.
///
/// The last dataset added (the time) is written after the others have been flushed, so its length never promises rows that a reader
/// of a killed run's file would not find.
class RowBlock {
public:
    RowBlock() = default;
    /// @param capacity rows per chunk of every dataset of this block
    explicit RowBlock(std::size_t capacity) : capacity_(capacity) {}

    /// Takes an open, empty dataset. Throws Failure.
    void add(Handle dataset, const SeriesShape& shape);
    /// Copies one row of one dataset into memory.
    void put(std::size_t member, const void* row) noexcept;
    /// Completes the row of which every member has been put.
    void advance() noexcept { ++buffered_; }
    /// Whether the memory reaches the end of the file's present chunk: write() before the next put().
    [[nodiscard]] bool full() const noexcept { return (written_ + buffered_) % capacity_ == 0 && buffered_ > 0; }
    /// Hands all rows in memory to HDF5 and from there to the operating system. Throws Failure; the block is then unusable.
    void write();

    [[nodiscard]] std::size_t buffered() const noexcept { return buffered_; }
    [[nodiscard]] std::size_t written() const noexcept { return written_; }
    /// How much write() may make the file grow [byte]; 0 if nothing is buffered.
    [[nodiscard]] std::size_t growth() const noexcept;

private:
    struct Member {
        Handle dataset;
        hid_t type;
        std::size_t width;
        bool flat;
        std::size_t row_bytes;
        std::vector<std::byte> rows;
    };
    void write_member(const Member& member) const;

    std::vector<Member> members_;
    std::size_t capacity_ = 1;
    std::size_t buffered_ = 0;
    std::size_t written_ = 0;
};

}  // namespace cvtflow::engine::hdf5
