#include "engine/record/run/run_file.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "engine/record/hdf5/hdf5_handle.hpp"
#include "engine/record/hdf5/hdf5_series.hpp"
#include "engine/record/run/run_layout.hpp"

namespace cvtflow::engine {

namespace {

/// Kept free beyond every write, for HDF5's tables and for the status and attributes that close the file [byte].
constexpr std::size_t spare_run_bytes = 65536;

hdf5::RowBlock open_block(hid_t file, const hdf5::BlockShape& shape) {
    hdf5::RowBlock block(shape.rows, shape.series.empty() ? 1 : shape.series.front().chunk);
    for (const hdf5::SeriesShape& series : shape.series) block.add(hdf5::open_series(file, series.path), series);
    return block;
}

/// The eight bytes of a table's cell. Throws Failure for what is no whole number in an integer column.
std::uint64_t cell(const TableColumn& column, double value) {
    if (column.type == ColumnType::real) return std::bit_cast<std::uint64_t>(value);
    if (!(std::abs(value) <= 9007199254740992.0) || value != std::floor(value))
        throw hdf5::Failure(fmt::format("cannot write: {} in the integer column '{}'", value, column.name));
    return std::bit_cast<std::uint64_t>(static_cast<std::int64_t>(value));
}

}  // namespace

struct RunFile::Impl {
    PartFile part;
    RunContents contents;
    RunFileOptions options;
    hdf5::RunLayout layout;
    hdf5::Handle file;
    hdf5::RowBlock channels;
    hdf5::RowBlock states;
    std::vector<hdf5::RowBlock> tables;
    std::vector<std::uint64_t> table_row;  ///< scratch: one row of the widest table
    std::size_t values_per_row = 0;
    double last_time = 0.0;   ///< time of the last row taken [s]
    double saved_time = 0.0;  ///< time of the last row written [s]
    std::chrono::steady_clock::time_point last_flush = std::chrono::steady_clock::now();
    std::vector<Attribute> late_attributes;
    std::string status;
    std::string damage;  ///< reason why HDF5 failed; nothing is written any more

    Impl(const OutputFile& place, RunContents what, RunFileOptions how)
        : part(place, how.continues), contents(std::move(what)), options(how) {
        try {
            hdf5::guarded(part.path(), [this] { start(); });
        } catch (...) {
            release();
            part.discard();
            throw;
        }
    }

    void start() {
        hdf5::check_contents(contents);
        layout = hdf5::run_layout(contents, options);
        hdf5::create_run(part.path(), contents, layout);
        file = {H5Fopen(part.path().c_str(), H5F_ACC_RDWR | H5F_ACC_SWMR_WRITE, hdf5::file_access().id()), H5Fclose,
                "cannot open for writing"};
        channels = open_block(file.id(), layout.channels);
        states = open_block(file.id(), layout.states);
        for (const hdf5::BlockShape& shape : layout.tables) tables.push_back(open_block(file.id(), shape));
        for (const TableInfo& table : contents.tables) table_row.resize(std::max(table_row.size(), table.columns.size()));
        for (const ChannelInfo& channel : contents.channels) values_per_row += static_cast<std::size_t>(channel.width);
    }

    void require_open() const {
        if (!damage.empty()) fail(damage);
        if (!file) throw RecordError(part.final_path() + ": cannot write: closed");
    }

    void require_size(std::size_t given, std::size_t requested, std::string_view of) const {
        if (given != requested)
            throw RecordError(fmt::format("{}: cannot write: {} values of {}, not {}", part.path(), given, of, requested));
    }

    [[noreturn]] void fail(const std::string& reason) const {
        const std::size_t rows = channels.written();
        const std::string saved = rows == 0 ? "nothing" : fmt::format("{} rows up to t = {:.9g} s", rows, saved_time);
        throw RecordError(fmt::format("{}: cannot write: {}; saved: {}", part.path(), reason, saved));
    }

    void make_room(std::size_t growth) {
        hsize_t size = 0;
        hdf5::check(H5Fget_filesize(file.id(), &size), "cannot get the file's size");
        if (const int reason = part.reserve(size + growth + spare_run_bytes); reason != 0) fail(std::strerror(reason));
    }

    /// Runs a call that writes; after a failure nothing is written any more.
    template <class Body>
    void or_damage(Body&& body) {
        try {
            body();
        } catch (const hdf5::Failure& failure) {
            const std::string_view text = failure.what();
            damage = text.substr(text.find(": ") + 2);
            fail(damage);
        }
    }

    void write(hdf5::RowBlock& block, bool last = false) {
        if (block.buffered() == 0 && !last) return;
        make_room(block.growth());
        or_damage([&] { last ? block.complete() : block.write(); });
        if (&block == &channels) saved_time = last_time;
    }

    /// Makes room before a row is taken, not after: a row whose append threw was not taken.
    void prepare(hdf5::RowBlock& block) {
        if (std::chrono::duration<double>(std::chrono::steady_clock::now() - last_flush).count() >= options.flush_seconds)
            flush();
        else if (block.full())
            hdf5::guarded(part.path(), [&] { write(block); });
    }

    /// @param last no row follows
    void flush(bool last = false) {
        hdf5::guarded(part.path(), [this, last] {
            write(channels, last);
            write(states, last);
            for (hdf5::RowBlock& table : tables) write(table, last);
            or_damage([this] { hdf5::check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "cannot write"); });
        });
        if (const int reason = part.sync(); reason != 0) fail(std::strerror(reason));
        last_flush = std::chrono::steady_clock::now();
    }

    /// Ends SWMR by closing, then writes what SWMR forbids. Leaves the file closed.
    void finish(const std::string& final_status) {
        hdf5::guarded(part.path(), [&] {
            std::size_t bytes = final_status.size();
            for (const Attribute& attribute : late_attributes) {
                const auto* text = std::get_if<std::string>(&attribute.value);
                bytes += attribute.name.size() + (text == nullptr ? 8 : text->size()) + 512;
            }
            // Spare space was kept by every write; only attributes of unusual size can need more.
            make_room(bytes + 16384 > spare_run_bytes ? bytes : 0);
            release();
            write_ending(final_status);
            if (const int reason = part.seal(); reason != 0) fail(std::strerror(reason));
        });
        part.trim();
    }

    void write_ending(const std::string& final_status) {
        hdf5::Handle plain(H5Fopen(part.path().c_str(), H5F_ACC_RDWR, hdf5::file_access().id()), H5Fclose, "cannot complete");
        try {
            for (const Attribute& attribute : late_attributes) hdf5::write_attribute(plain.id(), attribute);
            hdf5::write_attribute(plain.id(), {"status", final_status});
            hdf5::check(H5Fflush(plain.id(), H5F_SCOPE_GLOBAL), "cannot complete");
        } catch (const hdf5::Failure&) {
            hdf5::divert_writes(plain.id());
            throw;
        }
        plain.close("cannot complete");
    }

    void release() noexcept {
        if (!damage.empty()) hdf5::divert_writes(file.id());
        tables.clear();
        states = {};
        channels = {};
        file.release();
    }
};

RunFile::RunFile(const OutputFile& file, RunContents contents, RunFileOptions options)
    : impl_(std::make_unique<Impl>(file, std::move(contents), options)) {}

RunFile::~RunFile() {
    if (!impl_->file) return;
    const hdf5::QuietErrors quiet;
    if (impl_->options.continues) {
        impl_->release();
        impl_->part.discard();
        return;
    }
    const std::string status = impl_->status.empty() ? "interrupted" : impl_->status;
    try {
        impl_->require_open();
        impl_->flush(true);
    } catch (const std::exception&) {
        // The rows that found no room are lost; those before them are in the file.
    }
    try {
        if (impl_->damage.empty()) impl_->finish(status);
    } catch (const std::exception&) {
        // The status stays "running"; RunReader opens the file all the same.
    }
    impl_->release();
}

void RunFile::append(double time, std::span<double> values) {
    impl_->require_open();
    impl_->require_size(values.size(), impl_->values_per_row, "channels");
    impl_->prepare(impl_->channels);
    double* next = values.data();
    std::size_t member = 0;
    for (const ChannelInfo& channel : impl_->contents.channels) {
        impl_->channels.put_reals(member++, {next, static_cast<std::size_t>(channel.width)});
        next += channel.width;
    }
    impl_->channels.put(member, &time);
    impl_->channels.advance();
    impl_->last_time = time;
}

void RunFile::append_state(double time, std::span<const double> state, std::span<const std::uint8_t> phases) {
    impl_->require_open();
    impl_->require_size(state.size(), impl_->contents.state_size, "a state");
    impl_->require_size(phases.size(), impl_->contents.phase_count, "phases");
    if (state.empty()) throw RecordError(impl_->part.path() + ": cannot write: this run has no states");
    impl_->prepare(impl_->states);
    std::size_t member = 0;
    impl_->states.put(member++, state.data());
    if (!phases.empty()) impl_->states.put(member++, phases.data());
    impl_->states.put(member, &time);
    impl_->states.advance();
}

void RunFile::append_row(std::string_view table, std::span<const double> values) {
    impl_->require_open();
    const auto& infos = impl_->contents.tables;
    const auto info = std::find_if(infos.begin(), infos.end(), [&](const TableInfo& candidate) { return candidate.name == table; });
    if (info == infos.end()) throw RecordError(fmt::format("{}: cannot write: no table '{}'", impl_->part.path(), table));
    impl_->require_size(values.size(), info->columns.size(), "a table's row");
    hdf5::RowBlock& block = impl_->tables[static_cast<std::size_t>(info - infos.begin())];
    hdf5::guarded(impl_->part.path(), [&] {
        for (std::size_t i = 0; i < values.size(); ++i) impl_->table_row[i] = cell(info->columns[i], values[i]);
    });
    impl_->prepare(block);
    block.put(0, impl_->table_row.data());
    block.advance();
}

void RunFile::set_attribute(Attribute attribute) {
    hdf5::guarded(impl_->part.path(), [&] { hdf5::check_contents({.attributes = {attribute}}); });
    impl_->late_attributes.push_back(std::move(attribute));
}

void RunFile::set_status(std::string status) { impl_->status = std::move(status); }

void RunFile::flush() {
    impl_->require_open();
    impl_->flush();
}

void RunFile::take_place() {
    flush();
    impl_->part.take_place();
    impl_->options.continues = false;
}

void RunFile::close() {
    impl_->require_open();
    impl_->flush(true);
    impl_->finish(impl_->status.empty() ? "finished" : impl_->status);
    impl_->part.publish();
}

}  // namespace cvtflow::engine
