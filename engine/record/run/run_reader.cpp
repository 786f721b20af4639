#include "engine/record/run/run_reader.hpp"

#include <algorithm>
#include <new>

#include "engine/record/hdf5/file_seal.hpp"
#include "engine/record/hdf5/hdf5_handle.hpp"
#include "engine/record/hdf5/hdf5_open.hpp"
#include "engine/record/hdf5/hdf5_series.hpp"
#include "engine/record/run/part_file.hpp"
#include "engine/record/run/run_layout.hpp"
#include "engine/record/run/state_file.hpp"

namespace cvtflow::engine {
namespace {

std::vector<ChannelInfo> read_channels(hid_t file) {
    std::vector<std::pair<std::int64_t, ChannelInfo>> found;
    for (const std::string& name : hdf5::dataset_names(file, "/channels")) {
        if (name == "time") continue;
        const hdf5::Series series(file, "/channels/" + name, hdf5::Cells::reals, 2);
        const auto text = [&](const char* of) { return hdf5::read_text(series.id(), of); };
        found.push_back({hdf5::read_integer(series.id(), "index", 0),
                         {name, text("units"), text("description"), static_cast<int>(series.width()), text("axis")}});
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<ChannelInfo> channels;
    for (auto& [index, info] : found) channels.push_back(std::move(info));
    return channels;
}

TableInfo read_table_info(hid_t file, const std::string& name) {
    const hdf5::Series series(file, "/tables/" + name, hdf5::Cells::records);
    const hdf5::Handle type(H5Dget_type(series.id()), H5Tclose, "cannot read the type of table '" + name + "'");
    TableInfo table{name, hdf5::read_text(series.id(), "description"), {}};
    const auto units = hdf5::read_texts(series.id(), "units");
    const auto descriptions = hdf5::read_texts(series.id(), "descriptions");
    const int members = hdf5::require_record_type(type.id(), "cannot read table '" + name + "'");
    for (unsigned i = 0; i < static_cast<unsigned>(members); ++i) {
        const std::unique_ptr<char, herr_t (*)(void*)> column(H5Tget_member_name(type.id(), i), H5free_memory);
        const H5T_class_t kind = H5Tget_member_class(type.id(), i);
        if (column == nullptr) throw std::bad_alloc();
        const auto text = [&](const auto& texts) { return i < texts.size() ? texts[i] : ""; };
        table.columns.push_back(
            {column.get(), text(units), text(descriptions), kind == H5T_INTEGER ? ColumnType::integer : ColumnType::real});
    }
    return table;
}

std::vector<TableInfo> read_tables(hid_t file) {
    std::vector<TableInfo> tables;
    for (const std::string& name : hdf5::dataset_names(file, "/tables")) tables.push_back(read_table_info(file, name));
    return tables;
}

std::size_t rows_of(hid_t file, const std::string& path) {
    if (!hdf5::has_object(file, path)) return 0;
    const hdf5::Series series(file, path, hdf5::Cells::reals);
    return series.rows();
}

std::vector<double> read_reals(hid_t file, const std::string& path, std::size_t first, std::size_t count, int max_rank = 1) {
    return hdf5::Series(file, path, hdf5::Cells::reals, max_rank).reals(first, count);
}

}  // namespace

void require_unchanged(const std::string& path) {
    try {
        if (inspect_seal(InputFile(path)) != Seal::broken) return;
    } catch (const InputError& error) {
        throw RecordError(path + ": " + error.what());
    }
    throw RecordError(path + ": damaged HDF5 file (changed after it was finished: its checksum differs)");
}

bool is_record_with(const std::string& path, std::string_view attribute, std::string_view text, bool torn) {
    const RunReader reader(path);
    const auto* found = attribute_value<std::string>(reader.attributes(), attribute);
    return found != nullptr && (*found == text || (torn && text.starts_with(*found)));
}

bool is_torn_record(const std::string& path) {
    const std::string head = head_of(path);
    if (head.find_first_not_of('\0') >= 48) return true;  // bytes of the superblock, which a power cut may take alone
    if (!head.starts_with("\x89HDF\r\n\x1a\n\x03")) return false;
    try {
        if (hdf5::format_of(path) == hdf5::run_format) static_cast<void>(RunReader(path).attributes());
        return false;
    } catch (const RecordError&) {
        return true;
    }
}

struct RunReader::Impl {
    hdf5::OpenFile opened;
    const hid_t file = opened.file.id();
};

RunReader::RunReader(const std::string& path)
    : path_(path),
      impl_(new Impl{hdf5::open_for_reading(path, {hdf5::run_format, hdf5::run_format_version})}),
      sealed_(impl_->opened.sealed) {
    hdf5::guarded(path_, [this] {
        const hid_t file = impl_->file;
        status_ = hdf5::read_text(file, "status");
        attributes_ = hdf5::read_attributes(file);
        std::erase_if(attributes_, [](const Attribute& each) {
            return each.name == "format" || each.name == "format_version" || each.name == "status";
        });
        channels_ = read_channels(file);
        tables_ = read_tables(file);
        rows_ = rows_of(file, "/channels/time");
        states_ = rows_of(file, "/states/time");
    });
}

RunReader::~RunReader() = default;
RunReader::RunReader(RunReader&&) noexcept = default;
RunReader& RunReader::operator=(RunReader&&) noexcept = default;

std::vector<double> RunReader::times() const {
    return hdf5::guarded(path_, [&] { return read_reals(impl_->file, "/channels/time", 0, rows_); });
}

/// Rows of a killed run's channels beyond the last time are passed over.
std::vector<double> RunReader::channel(std::string_view name) const { return channel_rows(name, 0, rows_); }

std::vector<double> RunReader::channel_rows(std::string_view name, std::size_t first, std::size_t count) const {
    if (name != "time" && std::none_of(channels_.begin(), channels_.end(), [&](const ChannelInfo& each) { return each.name == name; }))
        throw RecordError(path_ + ": no channel '" + std::string(name) + "'");
    return hdf5::guarded(path_, [&] { return read_reals(impl_->file, "/channels/" + std::string(name), first, count, 2); });
}

RecordedState RunReader::state(std::size_t number) const {
    if (states_ == 0) throw RecordError(path_ + ": no states recorded");
    return hdf5::guarded(path_, [&] {
        const hid_t file = impl_->file;
        RecordedState result{read_reals(file, "/states/time", number, 1).front(), read_reals(file, "/states/y", number, 1, 2), {}};
        if (hdf5::has_object(file, "/states/phases")) {
            const hdf5::Series series(file, "/states/phases", hdf5::Cells::bytes, 2);
            result.phases.resize(series.width());
            series.read(H5T_NATIVE_UINT8, number, 1, result.phases.data(), result.phases.size());
        }
        return result;
    });
}

std::vector<double> RunReader::last(std::string_view name) const {
    return rows_ == 0 ? channel_rows(name, 0, 0) : channel_rows(name, rows_ - 1, 1);
}

std::vector<double> RunReader::state_times() const {
    if (states_ == 0) return {};
    return hdf5::guarded(path_, [&] { return read_reals(impl_->file, "/states/time", 0, states_); });
}

SavedState last_state_of_record(const std::string& path) {
    const RunReader run(path);
    SavedState saved;
    const auto text = [&](const char* name) {
        const auto* found = attribute_value<std::string>(run.attributes(), name);
        return found == nullptr ? std::string() : *found;
    };
    const auto number = [&](const char* name) {
        const auto* found = attribute_value<double>(run.attributes(), name);
        return found == nullptr ? 0.0 : *found;
    };
    saved.program = text("program_version"), saved.method = text("method"), saved.scene = text("parameters");
    saved.step = number("step_taken"), saved.balance_error_ratio = number("energy_error_ratio");
    const std::size_t states = run.state_times().size();
    RecordedState last = run.state(states == 0 ? 0 : states - 1);
    saved.time = last.time, saved.state = std::move(last.state), saved.phases = std::move(last.phases);
    return saved;
}

std::vector<std::vector<double>> RunReader::table(std::string_view name) const {
    const auto info = std::find_if(tables_.begin(), tables_.end(), [&](const TableInfo& each) { return each.name == name; });
    if (info == tables_.end()) throw RecordError(path_ + ": no table '" + std::string(name) + "'");
    return hdf5::guarded(path_, [&] {
        const hdf5::Series series(impl_->file, "/tables/" + info->name, hdf5::Cells::records);
        const std::size_t columns = info->columns.size();
        const hdf5::Handle type(H5Tcreate(H5T_COMPOUND, 8 * columns), H5Tclose, "cannot make a type");
        for (std::size_t i = 0; i < columns; ++i)
            hdf5::check(H5Tinsert(type.id(), info->columns[i].name.c_str(), 8 * i, H5T_NATIVE_DOUBLE), "cannot make a type");
        const std::size_t rows = series.rows();
        std::vector<double> cells(rows * columns);
        series.read(type.id(), 0, rows, cells.data(), 8 * cells.size());
        std::vector<std::vector<double>> result;
        for (std::size_t row = 0; row < rows; ++row) {
            const auto begin = cells.begin() + static_cast<std::ptrdiff_t>(row * columns);
            result.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(columns));
        }
        return result;
    });
}

}  // namespace cvtflow::engine
