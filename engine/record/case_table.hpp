#pragma once
/// A table of cases that grows while a sweep runs, in one HDF5 file:
///
///     /         attributes: format "cvtflow cases", format_version, status, and those given
///     /cases    [n] compound of float64, int64 and texts of fixed length; the last column, `check`, is a hash of the row's other bytes
///               attributes: columns[], units[], descriptions[]
///
/// While it grows it is open as single writer with multiple readers (SWMR); every row reaches the operating system when it is added, so a
/// killed process loses none. A file that was left open is safe to read but not to write: going on begins with a copy, which takes the
/// file's place at once. Where HDF5 cannot read it any more (a power cut that lost some of its pages), whole rows are found without HDF5:
/// they lie in the file as in memory, each with its check.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/input_file.hpp"
#include "engine/record/run/output_rule.hpp"
#include "engine/record/run/schema.hpp"

namespace cvtflow::engine {

/// Offsets of columns in a row of bytes.
class RowLayout {
public:
    RowLayout() = default;
    explicit RowLayout(std::vector<TableColumn> columns);

    [[nodiscard]] const std::vector<TableColumn>& columns() const noexcept { return columns_; }
    /// Number of a column. @throws std::out_of_range
    [[nodiscard]] std::size_t column(std::string_view name) const;
    [[nodiscard]] bool has(std::string_view name) const noexcept;
    /// Bytes of a row, check included.
    [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }
    [[nodiscard]] std::size_t offset(std::size_t column) const noexcept { return offsets_[column]; }

    void put(std::span<std::byte> row, std::size_t column, double value) const noexcept;  ///< value [unit of the column]
    void put(std::span<std::byte> row, std::size_t column, std::int64_t value) const noexcept;
    /// A text that is too long is cut.
    void put(std::span<std::byte> row, std::size_t column, std::string_view text) const noexcept;
    [[nodiscard]] double real(std::span<const std::byte> row, std::size_t column) const noexcept;
    [[nodiscard]] std::int64_t integer(std::span<const std::byte> row, std::size_t column) const noexcept;
    [[nodiscard]] std::string text(std::span<const std::byte> row, std::size_t column) const;
    /// Any cell as text: numbers so that they read back as the same double.
    [[nodiscard]] std::string cell(std::span<const std::byte> row, std::size_t column) const;

    /// Completes a row / whether nothing has changed since.
    void seal(std::span<std::byte> row) const noexcept;
    [[nodiscard]] bool sound(std::span<const std::byte> row) const noexcept;

private:
    [[nodiscard]] std::uint64_t check(std::span<const std::byte> row) const noexcept;
    std::vector<TableColumn> columns_;
    std::vector<std::size_t> offsets_;
    std::size_t bytes_ = 0;
};

/// A table in memory.
struct CaseTable {
    RowLayout layout;
    std::vector<Attribute> attributes;  ///< attributes and status; without format and format_version
    std::vector<std::byte> rows;

    [[nodiscard]] std::size_t size() const noexcept { return layout.bytes() == 0 ? 0 : rows.size() / layout.bytes(); }
    [[nodiscard]] std::span<const std::byte> row(std::size_t number) const noexcept {
        return {rows.data() + number * layout.bytes(), layout.bytes()};
    }
    [[nodiscard]] std::string attribute(std::string_view name) const;
    void set(Attribute attribute);
};

/// A table on disk: finished, being written, or left by a killed process. The file that it has opened stays the one it reads.
/// Errors (RecordError): as RunReader's; "row 12 is damaged: its checksum differs".
class CaseReader {
public:
    explicit CaseReader(std::string path);
    ~CaseReader();
    CaseReader(const CaseReader&) = delete;
    CaseReader& operator=(const CaseReader&) = delete;

    /// Columns and attributes, no rows.
    [[nodiscard]] const CaseTable& head() const noexcept { return head_; }
    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    /// Rows from `first` on, as many as there is room for.
    void read(std::size_t first, std::span<std::byte> rows) const;

private:
    struct Impl;
    std::string path_;
    std::unique_ptr<Impl> impl_;
    CaseTable head_;
    std::size_t size_ = 0;
};

/// All rows of a table. Errors as above.
[[nodiscard]] CaseTable read_cases(const std::string& path);

/// Writes a finished table atomically: readers see the former file or the new one. Errors (RecordError).
void write_cases(const Permit& permit, const CaseTable& table);
/// Writes a finished table at once from rows that come a few at a time. @param fill writes rows from `first` on, as many as there is room
/// for
void write_cases(const Permit& permit, const CaseTable& head, std::size_t rows,
                 const std::function<void(std::size_t first, std::span<std::byte> rows)>& fill);

/// A table that grows.
class CaseWriter {
public:
    /// Writes the rows so far, as write_cases does, and continues with that file. Errors (RecordError).
    CaseWriter(const Permit& permit, const CaseTable& begin);
    ~CaseWriter();
    CaseWriter(const CaseWriter&) = delete;
    CaseWriter& operator=(const CaseWriter&) = delete;

    /// Adds a sealed row and hands it to the operating system. Errors (RecordError): disk full, which is noticed before anything is
    /// written: "DIR/cases.h5: cannot write: No space left on device; 12 cases are saved". The file stays whole; nothing can be added any
    /// more.
    void append(std::span<const std::byte> row);
    /// Waits until the rows are on disk.
    void sync();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Keeps others from writing into a folder; released when the process ends, in whatever way. Creates the folder if its parent exists.
class FolderLock {
public:
    /// Errors (RecordError): no such parent, not writable, "DIR: another sweep is writing into it".
    explicit FolderLock(const std::string& folder);
    /// The lock, unless another process has it; then nullptr. It outlasts this object in processes that were forked meanwhile.
    [[nodiscard]] static std::unique_ptr<FolderLock> if_free(const std::string& folder);

private:
    FolderLock(const std::string& folder, int attempts);
    Descriptor file_;
};

/// A range of cases that a worker has claimed.
struct Claim {
    int worker = 0;
    long first = 0, cases = 0;
    [[nodiscard]] long end() const noexcept { return first + cases; }
};

/// The claims in a file, without gaps from case 0 on; none if it does not exist. A line that a killed worker left unfinished is no claim.
/// @throws RecordError  cannot be read; malformed
[[nodiscard]] std::vector<Claim> read_claims(const std::string& path);

/// Claims the next cases for a worker under the file's lock: whole strands, the fewer the fewer are left (1/256 of them, at least one).
/// @param cases of the sweep   @return no cases if all are claimed   @throws RecordError  as above; cannot be locked or written
[[nodiscard]] Claim claim_cases(const std::string& path, int worker, long cases, long strand);

/// Whether a file was given up while it grew, and contains a text that identifies it. Also false for files that cannot be read,
/// and for finished ones (they end with a seal), which nothing but a fault of the disk can have changed.
[[nodiscard]] bool torn_while_growing(const std::string& path, std::string_view text);

/// The rows of a file that have the check that they were written with, wherever they lie, in the order of their places.
/// @param layout     of the rows
/// @param plausible  is asked before a check is computed, for every place of the file; should be quick, and refuse most
/// @throws RecordError  the file cannot be read
[[nodiscard]] std::vector<std::byte> whole_rows(const std::string& path, const RowLayout& layout,
                                                const std::function<bool(std::span<const std::byte> row)>& plausible);

}  // namespace cvtflow::engine
