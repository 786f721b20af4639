#pragma once
/// Internal to engine/record: datasets whose first dimension is time or number, and rows that are written to several of them together.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
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

/// Required type of elements.
enum class Cells { reals, bytes, records };  ///< float64 or float32; 8-bit integers; compounds of 8-byte numbers

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

/// Rows of several datasets of equal length and chunks. Memory for rows is taken at construction; put() and advance() never allocate.
///
/// The last dataset added (the time) is written after the others have been flushed, so its length never promises rows that a reader
/// of a killed run's file would not find.
///
/// Each chunk is written as a whole, with its Fletcher-32 checksum, which every program that uses HDF5 verifies. A chunk that is not full
/// yet has none, until complete(): a kill while it is written again leaves every byte old or new, and its rows readable.
class RowBlock {
public:
    RowBlock() = default;
    /// @param capacity rows in memory   @param chunk rows per chunk of every dataset of this block, at most `capacity`
    RowBlock(std::size_t capacity, std::size_t chunk) : capacity_(capacity), chunk_(chunk) {}

    /// Takes an open, empty dataset.
    void add(Handle dataset, const SeriesShape& shape);
    /// Copies one row of one dataset into memory.
    void put(std::size_t member, const void* row) noexcept;
    /// The same for reals, which are rounded where the dataset has floats.
    void put_reals(std::size_t member, std::span<double> row) noexcept;
    /// Completes the row of which every member has been put.
    void advance() noexcept { ++taken_; }
    /// Whether the memory is full: write() before the next put().
    [[nodiscard]] bool full() const noexcept { return taken_ - first_ == capacity_; }
    /// Hands all rows in memory to HDF5 and from there to the operating system. Throws Failure; the block is then unusable.
    void write();
    /// Writes the checksum of the last chunk. No row may follow. Throws Failure.
    void complete();

    [[nodiscard]] std::size_t buffered() const noexcept { return taken_ - written_; }
    [[nodiscard]] std::size_t written() const noexcept { return written_; }
    /// Largest growth of the file by write() [byte]; 0 if nothing is buffered.
    [[nodiscard]] std::size_t growth() const noexcept;

private:
    struct Member {
        Handle dataset;
        std::size_t width, row_bytes;
        std::unique_ptr<std::byte[]> rows;  ///< [capacity * row_bytes], and room for the checksum of a chunk
    };
    void write(bool complete);
    void write_member(const Member& member, bool complete);

    std::vector<Member> members_;
    std::vector<std::byte> image_;  ///< a chunk as it is in the file
    std::size_t capacity_ = 1, chunk_ = 1;
    std::size_t first_ = 0, written_ = 0, taken_ = 0;  ///< rows: the first in memory, which begins a chunk; in the file; all
};

/// Checksum of bytes as HDF5's filter "fletcher32" stores it behind them.
[[nodiscard]] std::uint32_t fletcher32(std::span<const std::byte> bytes) noexcept;

}  // namespace cvtflow::engine::hdf5
