#include "engine/record/case_table.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <optional>
#include <stdexcept>

#include "engine/base/hash.hpp"
#include "engine/record/hdf5/file_seal.hpp"
#include "engine/record/hdf5/hdf5_handle.hpp"
#include "engine/record/hdf5/hdf5_open.hpp"
#include "engine/record/hdf5/hdf5_series.hpp"
#include "engine/record/run/part_file.hpp"

namespace cvtflow::engine {

RowLayout::RowLayout(std::vector<TableColumn> columns) : columns_(std::move(columns)) {
    for (const TableColumn& column : columns_) {
        offsets_.push_back(bytes_);
        bytes_ += static_cast<std::size_t>(column.width);
    }
    bytes_ += sizeof(std::uint64_t);  // check
}

bool RowLayout::has(std::string_view name) const noexcept {
    return std::any_of(columns_.begin(), columns_.end(), [&](const TableColumn& each) { return each.name == name; });
}

std::size_t RowLayout::column(std::string_view name) const {
    const auto found = std::find_if(columns_.begin(), columns_.end(), [&](const TableColumn& each) { return each.name == name; });
    if (found == columns_.end()) throw std::out_of_range("no column " + std::string(name));
    return static_cast<std::size_t>(found - columns_.begin());
}

void RowLayout::put(std::span<std::byte> row, std::size_t column, double value) const noexcept {
    std::memcpy(row.data() + offsets_[column], &value, sizeof value);
}
void RowLayout::put(std::span<std::byte> row, std::size_t column, std::int64_t value) const noexcept {
    std::memcpy(row.data() + offsets_[column], &value, sizeof value);
}

void RowLayout::put(std::span<std::byte> row, std::size_t column, std::string_view text) const noexcept {
    const std::size_t width = static_cast<std::size_t>(columns_[column].width);
    std::byte* begin = row.data() + offsets_[column];
    std::memset(begin, 0, width);
    text.copy(reinterpret_cast<char*>(begin), width);
}

double RowLayout::real(std::span<const std::byte> row, std::size_t column) const noexcept {
    double value = 0.0;
    std::memcpy(&value, row.data() + offsets_[column], sizeof value);
    return value;
}

std::int64_t RowLayout::integer(std::span<const std::byte> row, std::size_t column) const noexcept {
    std::int64_t value = 0;
    std::memcpy(&value, row.data() + offsets_[column], sizeof value);
    return value;
}

std::string RowLayout::text(std::span<const std::byte> row, std::size_t column) const {
    const char* begin = reinterpret_cast<const char*>(row.data() + offsets_[column]);
    return {begin, strnlen(begin, static_cast<std::size_t>(columns_[column].width))};
}

std::string RowLayout::cell(std::span<const std::byte> row, std::size_t column) const {
    switch (columns_[column].type) {
        case ColumnType::real: return fmt::format("{}", real(row, column));
        case ColumnType::integer: return std::to_string(integer(row, column));
        case ColumnType::text: return text(row, column);
    }
    return {};
}

std::uint64_t RowLayout::check(std::span<const std::byte> row) const noexcept {
    return Hash().add(row.first(bytes_ - sizeof(std::uint64_t))).value();
}

void RowLayout::seal(std::span<std::byte> row) const noexcept {
    const std::uint64_t value = check(row);
    std::memcpy(row.data() + bytes_ - sizeof value, &value, sizeof value);
}

bool RowLayout::sound(std::span<const std::byte> row) const noexcept {
    const std::uint64_t value = check(row);
    return std::memcmp(row.data() + bytes_ - sizeof value, &value, sizeof value) == 0;
}

std::string CaseTable::attribute(std::string_view name) const {
    for (const Attribute& each : attributes)
        if (each.name == name) return std::visit([](const auto& value) { return fmt::format("{}", value); }, each.value);
    return {};
}

void CaseTable::set(Attribute attribute) {
    std::erase_if(attributes, [&](const Attribute& each) { return each.name == attribute.name; });
    attributes.push_back(std::move(attribute));
}

namespace {

constexpr const char* cases_format = "cvtflow cases";
constexpr std::int64_t cases_version = 1;
constexpr std::size_t rows_per_chunk = 64;
constexpr std::size_t rows_per_write = 16 * rows_per_chunk;
constexpr std::size_t spare_bytes = 65536;  ///< kept free beyond every write, for HDF5's tables

hdf5::Handle row_type(const RowLayout& layout) {
    hdf5::Handle type(H5Tcreate(H5T_COMPOUND, layout.bytes()), H5Tclose, "cannot make a type");
    for (std::size_t i = 0; i < layout.columns().size(); ++i) {
        const TableColumn& column = layout.columns()[i];
        std::optional<hdf5::Handle> text;
        if (column.type == ColumnType::text) text.emplace(hdf5::text_type(static_cast<std::size_t>(column.width)));
        const hid_t cell = text ? text->id() : column.type == ColumnType::real ? H5T_IEEE_F64LE : H5T_STD_I64LE;
        hdf5::check(H5Tinsert(type.id(), column.name.c_str(), layout.offset(i), cell), "cannot make a type");
    }
    hdf5::check(H5Tinsert(type.id(), "check", layout.bytes() - sizeof(std::uint64_t), H5T_STD_U64LE), "cannot make a type");
    return type;
}

using FillRows = std::function<void(std::size_t first, std::span<std::byte> rows)>;

void create_table(const std::string& path, const CaseTable& table, std::size_t rows, const FillRows& fill) {
    const hdf5::Handle created(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, hdf5::file_access().id()), H5Fclose, "cannot create");
    for (const Attribute& attribute : table.attributes) hdf5::write_attribute(created.id(), attribute);
    hdf5::write_attribute(created.id(), {"format", cases_format});
    hdf5::write_attribute(created.id(), {"format_version", cases_version});
    const hdf5::Handle type = row_type(table.layout);
    const hdf5::Handle dataset = hdf5::create_series(created.id(), {"/cases", type.id(), 1, true, 0, rows_per_chunk});
    hdf5::write_texts(dataset.id(), "columns", table.layout.columns(), &TableColumn::name);
    hdf5::write_texts(dataset.id(), "units", table.layout.columns(), &TableColumn::unit);
    hdf5::write_texts(dataset.id(), "descriptions", table.layout.columns(), &TableColumn::description);
    std::vector<std::byte> some;
    for (std::size_t first = 0; first < rows; first += rows_per_write) {
        const std::size_t count = std::min(rows_per_write, rows - first);
        some.resize(count * table.layout.bytes());
        fill(first, some);
        hdf5::append_rows(dataset.id(), type.id(), 0, first, count, some.data());
    }
    hdf5::check(H5Fflush(created.id(), H5F_SCOPE_GLOBAL), "cannot write");
}

/// Columns as the file has them.
RowLayout read_layout(hid_t dataset) {
    const hdf5::Handle type(H5Dget_type(dataset), H5Tclose, "cannot read the columns");
    const auto names = hdf5::read_texts(dataset, "columns");
    const auto units = hdf5::read_texts(dataset, "units");
    const auto descriptions = hdf5::read_texts(dataset, "descriptions");
    const int members = hdf5::require_record_type(type.id(), "cannot read the columns");
    if (static_cast<std::size_t>(members) != names.size() + 1 || units.size() != names.size() || descriptions.size() != names.size())
        throw hdf5::Failure("cannot read the columns: inconsistent layout");
    std::vector<TableColumn> columns;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const hdf5::Handle cell(H5Tget_member_type(type.id(), static_cast<unsigned>(i)), H5Tclose, "cannot read the columns");
        const H5T_class_t kind = H5Tget_class(cell.id());
        const ColumnType what = kind == H5T_STRING ? ColumnType::text : kind == H5T_FLOAT ? ColumnType::real : ColumnType::integer;
        const auto text = [&](const auto& texts) { return hdf5::label(texts[i], "/cases"); };
        columns.push_back({text(names), text(units), text(descriptions), what, static_cast<int>(H5Tget_size(cell.id()))});
    }
    return RowLayout(std::move(columns));
}

}  // namespace

struct CaseReader::Impl {
    hdf5::OpenFile open;
    std::optional<hdf5::Series> cases;
    hdf5::Handle type;
};

CaseReader::CaseReader(std::string path) : path_(std::move(path)), impl_(std::make_unique<Impl>()) {
    impl_->open = hdf5::open_for_reading(path_, {cases_format, cases_version, false});
    hdf5::guarded(path_, [&] {
        const hid_t file = impl_->open.file.id();
        head_.attributes = hdf5::read_attributes(file);
        std::erase_if(head_.attributes, [](const Attribute& each) { return each.name == "format" || each.name == "format_version"; });
        impl_->cases.emplace(file, "/cases", hdf5::Cells::records);
        hdf5::ReadBudget(file).take(impl_->cases->bytes());
        head_.layout = read_layout(impl_->cases->id());
        impl_->type = row_type(head_.layout);
        size_ = impl_->cases->rows();
    });
}

CaseReader::~CaseReader() = default;

void CaseReader::read(std::size_t first, std::span<std::byte> rows) const {
    const std::size_t bytes = head_.layout.bytes();
    hdf5::guarded(path_, [&] {
        impl_->cases->read(impl_->type.id(), first, rows.size() / bytes, rows.data(), rows.size());
        for (std::size_t at = 0; at < rows.size(); at += bytes)
            if (!head_.layout.sound(rows.subspan(at, bytes)))
                throw hdf5::Failure("row " + std::to_string(first + at / bytes) + " is damaged: its checksum differs");
    });
}

CaseTable read_cases(const std::string& path) {
    const CaseReader reader(path);
    CaseTable table = reader.head();
    table.rows.resize(reader.size() * table.layout.bytes());
    reader.read(0, table.rows);
    return table;
}

namespace {

/// The table in `<path>.part`, checked to have room; not yet under its name.
void write_part(PartFile& part, const CaseTable& table, std::size_t rows, const FillRows& fill) {
    part.require(part.reserve(rows * table.layout.bytes() + spare_bytes));
    hdf5::guarded(part.final_path(), [&] { create_table(part.path(), table, rows, fill); });
}

FillRows rows_of(const CaseTable& table) {
    return [&table](std::size_t first, std::span<std::byte> rows) { std::copy_n(table.row(first).data(), rows.size(), rows.data()); };
}

}  // namespace

void write_cases(const Permit& permit, const CaseTable& head, std::size_t rows, const FillRows& fill) {
    PartFile part(permit);
    write_part(part, head, rows, fill);
    part.require(part.seal());
    part.publish();
}

void write_cases(const Permit& permit, const CaseTable& table) { write_cases(permit, table, table.size(), rows_of(table)); }

struct CaseWriter::Impl {
    std::string path;
    PartFile part;
    hdf5::Handle type, file, dataset;
    std::size_t rows = 0;
    std::size_t row_bytes = 0;
    std::string damage;

    Impl(const Permit& permit, const CaseTable& begin)
        : path(permit.path()), part(permit), rows(begin.size()), row_bytes(begin.layout.bytes()) {
        write_part(part, begin, begin.size(), rows_of(begin));
        part.publish();  // `part` keeps its descriptor: the same file under its new name
        hdf5::guarded(path, [&] {
            type = row_type(begin.layout);
            file = {H5Fopen(path.c_str(), H5F_ACC_RDWR | H5F_ACC_SWMR_WRITE, hdf5::file_access().id()), H5Fclose,
                    "cannot open for writing"};
            dataset = hdf5::open_series(file.id(), "/cases");
        });
    }

    [[noreturn]] void fail(const std::string& reason) {
        damage = reason;
        throw RecordError(path + ": cannot write: " + reason + "; " + std::to_string(rows) + " cases are saved");
    }
};

CaseWriter::CaseWriter(const Permit& permit, const CaseTable& begin) : impl_(std::make_unique<Impl>(permit, begin)) {}

CaseWriter::~CaseWriter() {
    const hdf5::QuietErrors quiet;
    if (!impl_->damage.empty()) hdf5::divert_writes(impl_->file.id());
    impl_->dataset.release();
    impl_->file.release();
    impl_->part.trim();
}

void CaseWriter::append(std::span<const std::byte> row) {
    Impl& file = *impl_;
    hdf5::guarded(file.path, [&] {
        if (!file.damage.empty()) file.fail(file.damage);
        hsize_t size = 0;
        hdf5::check(H5Fget_filesize(file.file.id(), &size), "cannot get the file's size");
        const std::size_t end = size + rows_per_chunk * file.row_bytes + spare_bytes;
        if (const int reason = file.part.reserve(end); reason != 0) file.fail(std::strerror(reason));
        try {
            hdf5::append_rows(file.dataset.id(), file.type.id(), 0, file.rows, 1, row.data());
            hdf5::check(H5Fflush(file.file.id(), H5F_SCOPE_GLOBAL), "cannot write");
        } catch (const hdf5::Failure& failure) {
            file.fail(failure.what());
        }
        ++file.rows;
    });
}

void CaseWriter::sync() {
    if (const int reason = impl_->part.sync(); reason != 0) throw RecordError(impl_->path + ": cannot write: " + std::strerror(reason));
}

namespace {

/// A sweep writes only into the folder that the user named: a link inside would lead elsewhere.
void require_no_link(const std::string& path) {
    std::error_code absent;
    if (std::filesystem::is_symlink(path, absent)) throw RecordError(path + ": a symbolic link; a sweep writes into real folders only");
}

}  // namespace

FolderLock::FolderLock(const std::string& folder, int attempts) {
    std::error_code error;
    std::filesystem::create_directory(folder, error);
    std::error_code unreadable;
    if (!std::filesystem::is_directory(folder, unreadable)) {
        if (const std::string absent = missing_folder(folder); !absent.empty()) throw RecordError(folder + ": cannot create: " + absent);
        throw RecordError(folder + ": cannot create: " + (error ? error.message() : "a file with that name exists"));
    }
    for (const char* inside : {"", "/records", "/checkpoints", "/continuation", "/states"}) require_no_link(folder + inside);
    const std::string lock = folder + "/lock";
    Descriptor file(open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666));
    if (file.number() < 0) throw RecordError(folder + ": cannot write into it: " + std::strerror(errno));
    while (!lock_file(file.number(), lock)) {
        if (--attempts <= 0) return;
        usleep(10'000);
    }
    file_ = std::move(file);
}

FolderLock::FolderLock(const std::string& folder) : FolderLock(folder, 100) {  // one that was killed is gone before that
    if (file_.number() < 0) throw RecordError(folder + ": another sweep is writing into it");
}

std::unique_ptr<FolderLock> FolderLock::if_free(const std::string& folder) {
    std::unique_ptr<FolderLock> lock(new FolderLock(folder, 1));
    return lock->file_.number() >= 0 ? std::move(lock) : nullptr;
}

namespace {

constexpr std::size_t claim_bytes = 8 + 1 + 12 + 1 + 12 + 1;
constexpr int claim_attempts = 30'000;  ///< attempts, 2 ms each: a claim takes far less than a minute, also on a slow shared folder
constexpr long claims_of_rest = 256;
constexpr off_t max_claim_bytes = off_t{16} << 20U;  ///< far beyond what workers write: the number of claims grows like a logarithm

/// Claims up to a line that a power cut has torn, of which pages may be missing; the cases behind it are unclaimed.
/// @throws RecordError for another file
std::vector<Claim> parsed_claims(const std::string& path, const std::string& text) {
    if (text.find_first_not_of(std::string_view(" 0123456789\n\0", 13)) != std::string::npos)
        throw RecordError(path + ": not the claims of a sweep's workers; move it away");
    std::vector<Claim> claims;
    for (std::size_t at = 0; at + claim_bytes <= text.size(); at += claim_bytes) {
        const auto count = [&](std::size_t from, std::size_t width) {
            const std::size_t first = text.find_first_not_of(' ', at + from);
            long number = -1;
            const char* end = text.data() + at + from + width;
            const auto [stop, error] = std::from_chars(text.data() + std::min(first, at + from + width), end, number);
            return error == std::errc() && stop == end ? number : -1L;
        };
        const Claim claim{static_cast<int>(count(0, 8)), count(9, 12), count(22, 12)};
        const bool follows = claim.first == (claims.empty() ? 0 : claims.back().end());
        if (!follows || claim.worker < 1 || claim.cases < 1 || text[at + claim_bytes - 1] != '\n') break;
        claims.push_back(claim);
    }
    return claims;
}

/// Opens a file of claims and does not wait for a pipe. The number is negative if it is absent. @throws RecordError
Descriptor open_claims(const std::string& path, int mode) {
    Descriptor file(open(path.c_str(), mode | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666));
    if (file.number() < 0 && errno == ENOENT) return file;
    if (file.number() < 0) throw RecordError(path + ": cannot be opened: " + std::strerror(errno));
    struct stat status {};
    if (fstat(file.number(), &status) != 0 || !S_ISREG(status.st_mode) || (mode != O_RDONLY && status.st_nlink > 1) ||
        status.st_size > max_claim_bytes)
        throw RecordError(path + ": a file with a second name, or none of a sweep; move it away");
    return file;
}

/// @throws RecordError
std::string text_behind(int descriptor, const std::string& path) {
    std::string text;
    char some[4096];
    for (ssize_t count = 1; count != 0;) {
        count = pread(descriptor, some, sizeof some, static_cast<off_t>(text.size()));
        if (count < 0 && errno != EINTR) throw RecordError(path + ": cannot be read: " + std::strerror(errno));
        text.append(some, static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    }
    return text;
}

}  // namespace

std::vector<Claim> read_claims(const std::string& path) {
    const Descriptor file = open_claims(path, O_RDONLY);
    if (file.number() < 0) return {};
    return parsed_claims(path, text_behind(file.number(), path));
}

Claim claim_cases(const std::string& path, int worker, long cases, long strand) {
    const Descriptor file = open_claims(path, O_RDWR | O_CREAT);
    if (file.number() < 0) throw RecordError(path + ": cannot create: " + std::strerror(errno));
    for (int attempt = 0; !lock_file(file.number(), path); ++attempt) {
        if (attempt == claim_attempts) throw RecordError(path + ": another worker does not release its lock");
        usleep(2'000);
    }
    const std::vector<Claim> claims = parsed_claims(path, text_behind(file.number(), path));
    Claim claim{worker, claims.empty() ? 0 : claims.back().end()};
    const long strands = (cases - claim.first) / strand;
    if (strands <= 0) return claim;
    claim.cases = strand * std::max(1L, strands / claims_of_rest);
    const std::string line = fmt::format("{:8} {:12} {:12}\n", worker, claim.first, claim.cases);
    const auto end = static_cast<off_t>(claims.size() * claim_bytes);
    errno = EIO;
    const bool written = ftruncate(file.number(), end) == 0 &&
                         pwrite(file.number(), line.data(), line.size(), end) == static_cast<ssize_t>(claim_bytes) &&
                         fdatasync(file.number()) == 0;
    if (!written) throw RecordError(path + ": cannot write: " + std::strerror(errno));
    return claim;
}

namespace {

constexpr std::size_t window_bytes = std::size_t{1} << 20U;

/// Shows every `width` bytes of a file that lie together, from its beginning on.
/// @param inspect  @return number of bytes to the next position; 0: end
template <class Inspect>
void walk(const InputFile& file, std::size_t width, const Inspect& inspect) {
    std::vector<std::byte> window(window_bytes + width);
    std::uint64_t from = 0;
    for (std::size_t read = 0; (read = file.read(from, window.data(), window.size())) >= width;) {
        std::size_t at = 0;
        while (at + width <= read) {
            const std::size_t further = inspect(std::span<const std::byte>(window).subspan(at, width));
            if (further == 0) return;
            at += further;
        }
        from += at;
    }
}

}  // namespace

bool torn_while_growing(const std::string& path, std::string_view text) {
    try {
        const InputFile file(path);
        if (text.empty() || inspect_seal(file) != Seal::none) return false;
        bool found = false;
        walk(file, text.size(), [&](std::span<const std::byte> bytes) -> std::size_t {
            found = std::memcmp(bytes.data(), text.data(), text.size()) == 0;
            return found ? 0 : 1;
        });
        return found;
    } catch (const InputError&) {
        return false;
    }
}

std::vector<std::byte> whole_rows(const std::string& path, const RowLayout& layout,
                                  const std::function<bool(std::span<const std::byte> row)>& plausible) {
    std::vector<std::byte> rows;
    try {
        walk(InputFile(path), layout.bytes(), [&](std::span<const std::byte> row) -> std::size_t {
            if (!plausible(row) || !layout.sound(row)) return 1;
            rows.insert(rows.end(), row.begin(), row.end());
            return row.size();
        });
    } catch (const InputError& error) {
        throw RecordError(path + ": " + error.what());
    }
    return rows;
}

}  // namespace cvtflow::engine
