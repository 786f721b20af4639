#include "engine/record/run/run_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/record/run/run_writer.hpp"

namespace cvtflow::engine {
namespace {

/// The eight bytes of a table's cell. Throws Failure for what is no whole number in an integer column.
std::uint64_t cell(const TableColumn& column, double value) {
    if (column.type == ColumnType::real) {
        return std::bit_cast<std::uint64_t>(value);
    }
    if (!(std::abs(value) <= 9007199254740992.0) || value != std::floor(value)) {
        throw hdf5::Failure(fmt::format("cannot write: {} in the integer column '{}'", value, column.name));
    }
    return std::bit_cast<std::uint64_t>(static_cast<std::int64_t>(value));
}

}  // namespace

RunFile::RunFile(const Permit& permit, RunContents contents, RunFileOptions options)
    : impl_(std::make_unique<Impl>(permit, std::move(contents), options)) {}

RunFile::~RunFile() {
    if (!impl_->file) {
        return;
    }
    const hdf5::QuietErrors quiet;
    const std::string status = impl_->status.empty() ? "interrupted" : impl_->status;
    try {
        impl_->require_open();
        impl_->flush();
    } catch (const std::exception&) {
        // The rows that found no room are lost; those before them are in the file.
    }
    try {
        if (impl_->damage.empty()) {
            impl_->finish(status);
        }
    } catch (const std::exception&) {
        // The status stays "running"; RunReader opens the file all the same.
    }
    impl_->release();
}

void RunFile::append(double time, std::span<const double> values) {
    impl_->require_open();
    impl_->require_size(values.size(), impl_->values_per_row, "channels");
    impl_->prepare(impl_->channels);
    const double* next = values.data();
    std::size_t member = 0;
    for (const ChannelInfo& channel : impl_->contents.channels) {
        impl_->channels.put(member++, next);
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
    if (state.empty()) {
        throw RecordError(impl_->part.path() + ": cannot write: this run has no states");
    }
    impl_->prepare(impl_->states);
    std::size_t member = 0;
    impl_->states.put(member++, state.data());
    if (!phases.empty()) {
        impl_->states.put(member++, phases.data());
    }
    impl_->states.put(member, &time);
    impl_->states.advance();
}

void RunFile::append_row(std::string_view table, std::span<const double> values) {
    impl_->require_open();
    const auto& infos = impl_->contents.tables;
    const auto info = std::find_if(infos.begin(), infos.end(), [&](const TableInfo& candidate) { return candidate.name == table; });
    if (info == infos.end()) {
        throw RecordError(fmt::format("{}: cannot write: no table '{}'", impl_->part.path(), table));
    }
    impl_->require_size(values.size(), info->columns.size(), "a table's row");
    hdf5::RowBlock& block = impl_->tables[static_cast<std::size_t>(info - infos.begin())];
    hdf5::guarded(impl_->part.path(), [&] {
        for (std::size_t i = 0; i < values.size(); ++i) {
            impl_->table_row[i] = cell(info->columns[i], values[i]);
        }
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

void RunFile::close() {
    impl_->require_open();
    impl_->flush();
    impl_->finish(impl_->status.empty() ? "finished" : impl_->status);
    impl_->part.publish();
}

std::size_t RunFile::saved_rows() const noexcept { return impl_->channels.written(); }

const std::string& RunFile::part_path() const noexcept { return impl_->part.path(); }

}  // namespace cvtflow::engine
