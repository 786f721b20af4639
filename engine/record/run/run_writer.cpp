#include "engine/record/run/run_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "engine/record/hdf5/hdf5_attribute.hpp"

namespace cvtflow::engine {
namespace {

/// Kept free beyond every write, for HDF5's own tables and for the status and attributes that close the file [byte].
constexpr std::size_t spare_run_bytes = 65536;

hdf5::RowBlock open_block(hid_t file, const hdf5::BlockShape& shape) {
    hdf5::RowBlock block(shape.rows);
    for (const hdf5::SeriesShape& series : shape.series) {
        block.add(hdf5::open_series(file, series.path), series);
    }
    return block;
}

}  // namespace

RunFile::Impl::Impl(const Permit& permit, RunContents what, RunFileOptions how) : part(permit), contents(std::move(what)), options(how) {
    try {
        hdf5::guarded(part.path(), [this] { start(); });
    } catch (...) {
        release();
        part.discard();
        throw;
    }
}

void RunFile::Impl::start() {
    hdf5::check_contents(contents);
    layout = hdf5::run_layout(contents, options);
    hdf5::create_run(part.path(), contents, layout);
    file = {H5Fopen(part.path().c_str(), H5F_ACC_RDWR | H5F_ACC_SWMR_WRITE, hdf5::file_access().id()), H5Fclose, "cannot open for writing"};
    channels = open_block(file.id(), layout.channels);
    states = open_block(file.id(), layout.states);
    for (const hdf5::BlockShape& shape : layout.tables) {
        tables.push_back(open_block(file.id(), shape));
    }
    for (const TableInfo& table : contents.tables) {
        table_row.resize(std::max(table_row.size(), table.columns.size()));
    }
    for (const ChannelInfo& channel : contents.channels) {
        values_per_row += static_cast<std::size_t>(channel.width);
    }
}

void RunFile::Impl::require_open() const {
    if (!damage.empty()) {
        fail(damage);
    }
    if (!file) {
        throw RecordError(part.final_path() + ": cannot write: closed");
    }
}

void RunFile::Impl::require_size(std::size_t given, std::size_t requested, std::string_view of) const {
    if (given != requested) {
        throw RecordError(fmt::format("{}: cannot write: {} values of {}, not {}", part.path(), given, of, requested));
    }
}

void RunFile::Impl::fail(const std::string& reason) const {
    const std::size_t rows = channels.written();
    const std::string saved = rows == 0 ? "nothing" : fmt::format("{} rows up to t = {:.9g} s", rows, saved_time);
    throw RecordError(fmt::format("{}: cannot write: {}; saved: {}", part.path(), reason, saved));
}

void RunFile::Impl::make_room(std::size_t growth) {
    hsize_t size = 0;
    hdf5::check(H5Fget_filesize(file.id(), &size), "cannot get the file's size");
    if (const int reason = part.reserve(size + growth + spare_run_bytes); reason != 0) {
        fail(std::strerror(reason));
    }
}

template <class Body>
void RunFile::Impl::or_damage(Body&& body) {
    try {
        body();
    } catch (const hdf5::Failure& failure) {
        const std::string_view text = failure.what();
        damage = text.substr(text.find(": ") + 2);
        fail(damage);
    }
}

void RunFile::Impl::write(hdf5::RowBlock& block) {
    if (block.buffered() == 0) {
        return;
    }
    make_room(block.growth());
    or_damage([&] { block.write(); });
    if (&block == &channels) {
        saved_time = last_time;
    }
}

/// Before a row is taken and not after, so that a row whose append threw was not taken.
void RunFile::Impl::prepare(hdf5::RowBlock& block) {
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - last_flush).count() >= options.flush_seconds) {
        flush();
    } else if (block.full()) {
        hdf5::guarded(part.path(), [&] { write(block); });
    }
}

void RunFile::Impl::flush() {
    hdf5::guarded(part.path(), [this] {
        write(channels);
        write(states);
        for (hdf5::RowBlock& table : tables) {
            write(table);
        }
        or_damage([this] { hdf5::check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "cannot write"); });
    });
    if (const int reason = part.sync(); reason != 0) {
        fail(std::strerror(reason));
    }
    last_flush = std::chrono::steady_clock::now();
}

/// Ends SWMR by closing, then writes what SWMR forbids. Leaves the file closed.
void RunFile::Impl::finish(const std::string& final_status) {
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
        if (const int reason = part.seal(); reason != 0) {
            fail(std::strerror(reason));
        }
    });
    part.trim();
}

void RunFile::Impl::write_ending(const std::string& final_status) {
    hdf5::Handle plain(H5Fopen(part.path().c_str(), H5F_ACC_RDWR, hdf5::file_access().id()), H5Fclose, "cannot complete");
    try {
        for (const Attribute& attribute : late_attributes) {
            hdf5::write_attribute(plain.id(), attribute);
        }
        hdf5::write_attribute(plain.id(), {"status", final_status});
        hdf5::check(H5Fflush(plain.id(), H5F_SCOPE_GLOBAL), "cannot complete");
    } catch (const hdf5::Failure&) {
        hdf5::divert_writes(plain.id());
        throw;
    }
    plain.close("cannot complete");
}

void RunFile::Impl::release() noexcept {
    if (!damage.empty()) {
        hdf5::divert_writes(file.id());
    }
    tables.clear();
    states = {};
    channels = {};
    file.release();
}

}  // namespace cvtflow::engine
