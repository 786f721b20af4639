#pragma once
/// Rows of text that several processes add to one folder:
///
///     DIR/rows-HOST-PID.csv   one file per process: a heading, then a line per row
///     DIR/claims/NUMBER       which process has taken a piece of the work: the name of its file of rows
///     DIR/results.csv         all rows, sorted by number, once none is missing
///
/// A line begins with its number and ends with the CRC-32 of all before its last comma, in eight hexadecimal digits. The rows of a folder
/// are those of all files; of rows with one number the first that is found counts, since all of them are equal. A line that a killed
/// process or a power cut has torn is no row.

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/input_file.hpp"
#include "engine/thread/guards.hpp"
#include "engine/thread/ticker.hpp"

namespace cvtflow::engine {

/// CRC-32 as in zlib, PNG and POSIX archives.
[[nodiscard]] std::uint32_t crc32(std::string_view bytes) noexcept;
/// A line with its checksum and line end. @param cells without line breaks
[[nodiscard]] std::string checked_line(std::string_view cells);
/// A heading for lines with checksums.
[[nodiscard]] std::string checked_heading(std::string_view cells);
/// The cells of a line without its end; nothing if its checksum differs.
[[nodiscard]] std::optional<std::string_view> checked_cells(std::string_view line) noexcept;

/// The file that this process adds rows to. Any thread may add. On disk once a second, and after every 64 rows; a thread touches the file
/// every ten seconds, by which others on other machines see that this process lives. Errors are RecordError.
class RowWriter {
public:
    /// Creates DIR/rows-HOST-PID.csv, or with a further number if it is there, and locks it.
    RowWriter(const std::string& folder, const std::string& heading);
    ~RowWriter();
    RowWriter(const RowWriter&) = delete;
    RowWriter& operator=(const RowWriter&) = delete;

    /// "rows-HOST-PID.csv".
    [[nodiscard]] const std::string& name() const noexcept { return name_; }
    /// @param line from checked_line()
    void append(std::string_view line);
    /// Waits until all rows are on disk. A file without rows is removed.
    void finish();

private:
    void tick() noexcept;
    void sync();

    std::string path_, name_;
    Descriptor file_;
    Mutex mutex_;
    std::size_t rows_ = 0, unsynced_ = 0, ticks_ = 0;
    int failed_ = 0;  ///< errno of a tick; the next call throws it
    std::unique_ptr<Ticker> ticker_;
};

/// The rows of a folder on disk: some 80 bytes in memory for each. Writes and locks nothing. One thread at a time.
class RowFiles {
public:
    /// Reads DIR/results.csv if `complete`, else all files of rows; none if the folder does not exist. @throws RecordError
    explicit RowFiles(std::string folder, bool complete = false);

    /// Reads what has been added since. @return whether there was anything   @throws RecordError
    bool refresh();
    /// Heading of the files; empty if there is none yet.
    [[nodiscard]] const std::string& heading() const noexcept { return heading_; }
    [[nodiscard]] std::size_t size() const noexcept { return places_.size(); }
    [[nodiscard]] bool has(long number) const noexcept { return places_.contains(number); }
    /// Numbers of all rows, ascending.
    [[nodiscard]] std::vector<long> numbers() const;
    /// Cells of a row, without checksum. @throws RecordError  damaged or gone meanwhile; std::out_of_range
    [[nodiscard]] std::string row(long number) const;
    /// "DIR/rows-a-1.csv:12: its checksum differs" for each line that was damaged: not the last one of a file.
    [[nodiscard]] const std::vector<std::string>& damage() const noexcept { return damage_; }
    /// Number of rows by file.
    [[nodiscard]] std::map<std::string, long> by_file() const;

private:
    struct Source {
        std::string path;
        std::uint64_t read = 0;  ///< bytes up to the end of the last whole line
        long lines = 0, rows = 0;
    };
    struct Place {
        std::size_t source;
        std::uint64_t begin;
        std::size_t bytes;
    };
    void find_files();
    bool read_more(std::size_t source);
    void take_line(std::size_t source, std::string_view line, std::uint64_t begin);

    std::string folder_, heading_;
    bool complete_;
    std::vector<Source> sources_;
    std::map<long, Place> places_;
    std::vector<std::string> damage_;
    mutable std::optional<InputFile> open_;  ///< the file of the last row() …
    mutable std::size_t opened_ = 0;         ///< … and its source
};

/// Names of the files of rows in a folder, sorted.
[[nodiscard]] std::vector<std::string> row_files_in(const std::string& folder);

/// Pieces of work that the processes of a folder share, numbered from 0. A claim is a file that only one process can create. It is taken
/// over when its process is dead (on this machine: its rows are unlocked) or silent: its file of rows has been as it is for two minutes.
/// What two processes do is done twice with the same result. Errors are RecordError.
class Claims {
public:
    /// @param owner   name of this process's file of rows   @param silence  time after which a process counts as lost [s]
    Claims(const std::string& folder, std::string owner, double silence = 120.0);

    /// Whether this process has a piece from now on. False: another process has it, which is not known to be lost.
    [[nodiscard]] bool take(const std::string& piece);
    /// Whose the last piece was that take() did not get.
    [[nodiscard]] const std::string& holder() const noexcept { return holder_; }
    /// Removes the claims, when nothing is left to do.
    void remove();

private:
    /// When a file was last seen to change.
    struct Watched {
        FileIdentity file;
        double since = 0.0;  ///< [s]
    };
    [[nodiscard]] bool is_lost(const std::string& owner, const std::string& claim);
    [[nodiscard]] bool create(const std::string& path) const;

    std::string rows_folder_, folder_, owner_, host_, holder_;
    double silence_;
    bool locks_;  ///< whether the file system locks, so that a free file of this machine is that of a dead process
    std::map<std::string, Watched> watched_;
};

/// Owner of each claim of a folder, by piece.
[[nodiscard]] std::map<std::string, std::string> read_claims(const std::string& folder);

}  // namespace cvtflow::engine
