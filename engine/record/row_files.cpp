#include "engine/record/row_files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "engine/record/run/part_file.hpp"
#include "engine/record/run/schema.hpp"

namespace cvtflow::engine {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t rows_per_sync = 64, ticks_per_touch = 10;
constexpr std::size_t checksum_digits = 8;
constexpr std::string_view checksum_column = "crc32";
constexpr std::size_t window_bytes = std::size_t{1} << 20U;

[[noreturn]] void fail(const std::string& path, const char* what, int reason) {
    throw RecordError(fmt::format("{}: cannot {}: {}", path, what, std::strerror(reason)));
}

/// Name of this machine as a part of a file's name, without '-', which separates it from the number of the process.
std::string machine_name() {
    std::array<char, 256> name{};
    if (gethostname(name.data(), name.size() - 1) != 0 || name[0] == '\0') return "host";
    std::string text(name.data());
    std::ranges::replace_if(
        text, [](unsigned char c) { return std::isalnum(c) == 0 && c != '.'; }, '_');
    return text;
}

/// Writes all of a text at the end of a file. @return 0 or an errno
int write_all(int descriptor, std::string_view text) noexcept {
    while (!text.empty()) {
        const ssize_t some = write(descriptor, text.data(), text.size());
        if (some < 0 && errno == EINTR) continue;
        if (some < 0) return errno;
        text.remove_prefix(static_cast<std::size_t>(some));
    }
    return 0;
}

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

std::uint32_t crc32(std::string_view bytes) noexcept {
    return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string checked_line(std::string_view cells) { return fmt::format("{},{:08x}\n", cells, crc32(cells)); }
std::string checked_heading(std::string_view cells) { return fmt::format("{},{}\n", cells, checksum_column); }

std::optional<std::string_view> checked_cells(std::string_view line) noexcept {
    if (line.size() <= checksum_digits || line[line.size() - checksum_digits - 1] != ',') return {};
    const std::string_view cells = line.substr(0, line.size() - checksum_digits - 1), digits = line.substr(cells.size() + 1);
    std::uint32_t stated = 0;
    const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), stated, 16);
    if (fault != std::errc() || end != digits.data() + digits.size() || stated != crc32(cells)) return {};
    return cells;
}

RowWriter::RowWriter(const std::string& folder, const std::string& heading) {
    const std::string process = fmt::format("rows-{}-{}", machine_name(), getpid());
    for (int further = 1; file_.number() < 0; ++further) {
        name_ = further == 1 ? process + ".csv" : fmt::format("{}-{}.csv", process, further);
        path_ = folder + "/" + name_;
        file_ = Descriptor(open(path_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666));
        if (file_.number() < 0 && errno != EEXIST) fail(path_, "create", errno);
    }
    try {
        static_cast<void>(lock_file(file_.number(), path_));
    } catch (const RecordError&) {}  // a file system without locks: others tell by its silence when this process is gone
    if (const int reason = write_all(file_.number(), heading); reason != 0) fail(path_, "write", reason);
    sync();
    fsync(Descriptor(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)).number());  // its name survives a power cut, too
    ticker_ = std::make_unique<Ticker>(std::chrono::seconds(1), [this] { tick(); });
}

RowWriter::~RowWriter() { ticker_.reset(); }

void RowWriter::tick() noexcept {
    mutex_.guard([&] {
        if (unsynced_ > 0 && failed_ == 0 && fdatasync(file_.number()) != 0) failed_ = errno;
        unsynced_ = 0;
    });
    if (++ticks_ % ticks_per_touch == 0) futimens(file_.number(), nullptr);
}

void RowWriter::sync() {
    if (failed_ == 0 && fdatasync(file_.number()) != 0) failed_ = errno;
    unsynced_ = 0;
}

void RowWriter::append(std::string_view line) {
    mutex_.guard([&] {
        if (failed_ == 0) failed_ = write_all(file_.number(), line);
        if (failed_ == 0 && ++unsynced_ >= rows_per_sync) sync();
        if (failed_ != 0) throw RecordError(fmt::format("{}: cannot write: {}; {} cases are saved", path_, std::strerror(failed_), rows_));
        ++rows_;
    });
}

void RowWriter::finish() {
    ticker_.reset();
    if (rows_ == 0) {
        unlink(path_.c_str());
        return;
    }
    sync();
    if (failed_ != 0) fail(path_, "write to disk", failed_);
}

RowFiles::RowFiles(std::string folder, bool complete) : folder_(std::move(folder)), complete_(complete) { refresh(); }

void RowFiles::find_files() {
    for (const std::string& name : complete_ ? std::vector<std::string>{"results.csv"} : row_files_in(folder_)) {
        const std::string path = (fs::path(folder_) / name).string();
        if (std::ranges::find(sources_, path, &Source::path) == sources_.end()) sources_.push_back({path});
    }
}

bool RowFiles::refresh() {
    find_files();
    bool any = false;
    for (std::size_t source = 0; source < sources_.size(); ++source) any = read_more(source) || any;
    return any;
}

/// Reads whole lines from where the last call has ended.
bool RowFiles::read_more(std::size_t source) try {
    const InputFile file(sources_[source].path);
    std::string window(window_bytes, '\0');
    const std::uint64_t before = sources_[source].read;
    while (sources_[source].read < file.size()) {
        const std::uint64_t begin = sources_[source].read;
        const std::string_view text(window.data(), file.read(begin, reinterpret_cast<std::byte*>(window.data()), window.size()));
        std::size_t at = 0;
        for (std::size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n', at)) {
            take_line(source, text.substr(at, end - at), begin + at);
            at = end + 1;
        }
        sources_[source].read += at;
        if (at == 0) break;  // a torn last line
    }
    return sources_[source].read != before;
} catch (const InputError& error) {
    if (sources_[source].rows == 0 && access(sources_[source].path.c_str(), F_OK) != 0) return false;  // of a worker that got no case
    throw RecordError(sources_[source].path + ": " + error.what());
}

void RowFiles::take_line(std::size_t source, std::string_view line, std::uint64_t begin) {
    Source& file = sources_[source];
    ++file.lines;
    const bool torn = line.find('\0') != std::string_view::npos;  // pages that a power cut has taken
    if (file.lines == 1 && !torn) {
        if (!line.ends_with(checksum_column)) throw RecordError(file.path + ": not a file of rows: its heading does not end with crc32");
        if (heading_.empty()) heading_ = line;
        if (heading_ != line) throw RecordError(file.path + ": rows with other columns than beside it");
        return;
    }
    const std::optional<std::string_view> cells = checked_cells(line);
    long number = -1;
    if (!cells || std::from_chars(cells->data(), cells->data() + cells->size(), number).ec != std::errc() || number < 0) {
        damage_.push_back(fmt::format("{}:{}: its checksum differs", file.path, file.lines));
        return;
    }
    ++file.rows;
    places_.try_emplace(number, Place{source, begin, cells->size()});
}

std::vector<long> RowFiles::numbers() const {
    std::vector<long> numbers;
    numbers.reserve(places_.size());
    for (const auto& [number, place] : places_) numbers.push_back(number);
    return numbers;
}

std::string RowFiles::row(long number) const {
    const auto& [source, begin, bytes] = places_.at(number);
    std::string line(bytes + 1 + checksum_digits, '\0');
    try {
        if (!open_ || opened_ != source) open_.emplace(sources_[source].path);
        opened_ = source;
        line.resize(open_->read(begin, reinterpret_cast<std::byte*>(line.data()), line.size()));
    } catch (const InputError& error) {
        throw RecordError(sources_[source].path + ": " + error.what());
    }
    if (!checked_cells(line)) throw RecordError(fmt::format("{}: row {}: its checksum differs", sources_[source].path, number));
    line.resize(bytes);
    return line;
}

std::map<std::string, long> RowFiles::by_file() const {
    std::map<std::string, long> rows;
    for (const Source& source : sources_) rows[fs::path(source.path).filename().string()] = source.rows;
    return rows;
}

std::vector<std::string> row_files_in(const std::string& folder) {
    std::vector<std::string> names;
    std::error_code unreadable;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, unreadable)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with("rows-") && name.ends_with(".csv") && fs::is_regular_file(entry.symlink_status(unreadable)))
            names.push_back(name);
    }
    std::ranges::sort(names);
    return names;
}

Claims::Claims(const std::string& folder, std::string owner, double silence)
    : rows_folder_(folder),
      folder_(folder + "/claims"),
      owner_(std::move(owner)),
      host_(fmt::format("rows-{}-", machine_name())),
      silence_(silence),
      locks_(being_written(folder + "/" + owner_)) {
    std::error_code failed;
    fs::create_directory(folder_, failed);
    if (!fs::is_directory(fs::symlink_status(folder_, failed))) throw RecordError(folder_ + ": cannot create: a file, or a link");
}

/// Creates a file with the owner's name. @return false if it is there, or its folder is gone, since another process has ended the work
bool Claims::create(const std::string& path) const {
    const Descriptor file(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666));
    if (file.number() < 0 && errno == ENOENT && access(rows_folder_.c_str(), F_OK) != 0)
        throw RecordError(rows_folder_ + ": the folder of the sweep was moved or removed meanwhile");
    if (file.number() < 0 && (errno == EEXIST || errno == ENOENT)) return false;
    if (file.number() < 0) fail(path, "create", errno);
    if (const int reason = write_all(file.number(), owner_ + "\n"); reason != 0) fail(path, "write", reason);
    return true;
}

namespace {

constexpr std::uint64_t longest_claim = 512;

/// Name of a file of rows in a claim; empty if it is torn, gone, or no claim.
std::string owner_in(const std::string& path) {
    try {
        std::string text(longest_claim, '\0');
        text.resize(InputFile(path).read(0, reinterpret_cast<std::byte*>(text.data()), text.size()));
        const bool whole = text.starts_with("rows-") && text.ends_with(".csv\n") && text.find('/') == std::string::npos;
        return whole ? text.substr(0, text.size() - 1) : "";
    } catch (const InputError&) {
        return {};
    }
}

}  // namespace

/// Whether a process is dead or silent. Its file is watched by the clock of this process, so that wrong clocks do not matter. Of a claim
/// without an owner, which a power cut has torn or which is being written, the claim itself is watched, for a second.
bool Claims::is_lost(const std::string& owner, const std::string& claim) {
    const std::string file = owner.empty() ? claim : rows_folder_ + "/" + owner;
    const FileIdentity is = identity_of(file);
    if (!owner.empty() && is == FileIdentity{}) return true;
    if (locks_ && owner.starts_with(host_) && !being_written(file)) return true;
    const auto [watched, is_new] = watched_.try_emplace(file, Watched{is, now()});
    if (is_new || watched->second.file != is) watched->second = {is, now()};
    return now() - watched->second.since > (owner.empty() ? std::min(1.0, silence_) : silence_);
}

bool Claims::take(const std::string& piece) {
    const std::string claim = folder_ + "/" + piece;
    if (create(claim)) return true;
    holder_ = owner_in(claim);
    if (holder_ == owner_) return true;
    if (!is_lost(holder_, claim)) return false;
    const std::string mine = claim + "." + owner_;  // its name changes in one step: of two that take it over the last one has it
    unlink(mine.c_str());
    if (!create(mine)) return false;
    if (std::rename(mine.c_str(), claim.c_str()) != 0) fail(claim, "rename", errno);
    return owner_in(claim) == owner_;
}

void Claims::remove() {
    for (const auto& [piece, owner] : read_claims(rows_folder_)) unlink((folder_ + "/" + piece).c_str());
    rmdir(folder_.c_str());
}

std::map<std::string, std::string> read_claims(const std::string& folder) {
    std::map<std::string, std::string> claims;
    std::error_code unreadable;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder + "/claims", unreadable)) {
        const std::string owner = owner_in(entry.path().string());
        if (!owner.empty()) claims[entry.path().filename().string()] = owner;
    }
    return claims;
}

}  // namespace cvtflow::engine
