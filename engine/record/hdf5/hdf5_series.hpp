#pragma once
/// Internal to engine/record: datasets whose first dimension is time or number, and rows that are written to several of them together.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/record/hdf5/hdf5_handle.hpp"

namespace cvtflow::engine::hdf5 {

/// Properties of an extendible dataset.
struct SeriesShape {
    std::string path;       ///< "/channels/links/tension"
    hid_t type = -1;        ///< type of one element, in memory and in the file
    std::size_t width = 1;  ///< elements per row
    bool flat = true;       ///< shape [rows], else [rows, width]
    std::size_t chunk = 1;  ///< rows per chunk
};

/// Creates an empty dataset [0…unlimited(, width)] and the groups it is in. Reals that were never written read as NaN. Throws Failure.
[[nodiscard]] Handle create_series(hid_t file, const SeriesShape& shape);

/// Opens a dataset without checks, to append to it. Throws Failure("cannot open '<path>': reason").
[[nodiscard]] Handle open_series(hid_t file, const std::string& path);

/// Writes rows of a dataset that is long enough. @param width  elements per row of [rows, width]; 0: [rows]   @param before  rows before
/// them. Throws Failure.
void write_rows(hid_t dataset, hid_t type, std::size_t width, std::size_t before, std::size_t rows, const void* data);

/// Required type of elements.
enum class Cells { reals, bytes, records };  ///< float64; 8-bit integers; compounds of 8-byte numbers

/// A dataset that is read.
class Series {
public:
    /// Throws Failure("cannot read '<path>': reason") for what is no dataset, or has another type or rank.
    /// @param max_rank 1: [rows] only; 2: [rows, width] as well
    Series(hid_t file, std::string path, Cells cells, int max_rank = 1);

    [[nodiscard]] hid_t id() const noexcept { return dataset_.id(); }
    [[nodiscard]] std::size_t rows() const noexcept { return rows_; }
    /// Elements per row; 1 if the rank is 1.
    [[nodiscard]] std::size_t width() const noexcept { return width_; }
    [[nodiscard]] int rank() const noexcept { return rank_; }

    /// Copies rows first … first + count - 1, converted to `type`. Throws Failure if they are not all there, or damaged.
    /// @param bytes that `memory` has; must be count * width elements of `type`
    void read(hid_t type, std::size_t first, std::size_t count, void* memory, std::size_t bytes) const;
    [[nodiscard]] std::vector<double> reals(std::size_t first, std::size_t count) const;

private:
    [[noreturn]] void fail(const std::string& reason) const;
    void require_type(Cells cells) const;
    void require_extent(int max_rank);

    std::string path_;
    Handle dataset_;
    std::size_t rows_ = 0;
    std::size_t width_ = 1;
    int rank_ = 1;
};

/// Whether there is an object of that path.
[[nodiscard]] bool has_object(hid_t file, const std::string& path);
/// Paths of all datasets of a group and of the groups in it, relative to it, sorted; empty if it is not there. Throws Failure.
[[nodiscard]] std::vector<std::string> dataset_names(hid_t file, const std::string& group);

/// Throws Failure for a compound that is made of anything but 8-byte numbers. @return its members
int require_record_type(hid_t type, const std::string& what);

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
    /// Largest growth of the file by write() [byte]; 0 if nothing is buffered.
    [[nodiscard]] std::size_t growth() const noexcept;

private:
    struct Member {
        Handle dataset;
        hid_t type;
        std::size_t width;  ///< 0: [rows]
        std::size_t chunk;  ///< rows of a chunk
        std::size_t row_bytes;
        std::unique_ptr<std::byte[]> rows;
    };
    void write_member(const Member& member) const;

    std::vector<Member> members_;
    std::size_t capacity_ = 1;
    std::size_t buffered_ = 0;
    std::size_t written_ = 0;
};

}  // namespace cvtflow::engine::hdf5
