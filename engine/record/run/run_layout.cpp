#include "engine/record/run/run_layout.hpp"

#include <fmt/format.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <set>

#include "engine/record/hdf5/hdf5_handle.hpp"

namespace cvtflow::engine::hdf5 {
namespace {

constexpr hsize_t kernel_page = 4096;                             // of Linux on x86-64 and aarch64, or a part of it
constexpr std::size_t table_rows = 512, most_channel_rows = 512;  // per chunk
constexpr std::size_t state_chunks = 4;                           // gathered in memory: each write takes its share of HDF5's tables

/// Chunks of about 256 KiB.
std::size_t state_rows(std::size_t state_size) { return std::clamp<std::size_t>((std::size_t{1} << 18U) / (8 * state_size), 1, 64); }

template <class Items>
void check_names(const Items& items, const std::string& kind, const std::set<std::string>& reserved) {
    std::set<std::string> seen;
    for (const auto& item : items) {
        const std::string& name = item.name;
        if (name.empty() || name.front() == '/' || name.back() == '/' || name.find("//") != std::string::npos)
            throw Failure("'" + name + "' cannot be the name of a " + kind);
        if (reserved.contains(name)) throw Failure("the name '" + name + "' is reserved (" + kind + ")");
        if (!seen.insert(name).second) throw Failure("the " + kind + " '" + name + "' is declared twice");
    }
}

Handle compound_type(const TableInfo& table) {
    const std::string what = "cannot make a type for table '" + table.name + "'";
    Handle type(H5Tcreate(H5T_COMPOUND, 8 * table.columns.size()), H5Tclose, what);
    std::size_t offset = 0;
    for (const TableColumn& column : table.columns) {
        const hid_t kind = column.type == ColumnType::integer ? H5T_NATIVE_INT64 : H5T_NATIVE_DOUBLE;
        check(H5Tinsert(type.id(), column.name.c_str(), offset, kind), what);
        offset += 8;
    }
    return type;
}

/// Every series of a block, with the last (the time) as the first dimension's scale of the others.
std::vector<Handle> create_block(hid_t file, const BlockShape& block) {
    std::vector<Handle> datasets;
    for (const SeriesShape& shape : block.series) datasets.push_back(create_series(file, shape));
    if (datasets.empty()) return datasets;
    const hid_t time = datasets.back().id();
    write_attribute(time, {"units", "s"});
    write_attribute(time, {"description", "time"});
    check(H5DSset_scale(time, "time"), "cannot make time a dimension scale");
    for (std::size_t i = 0; i + 1 < datasets.size(); ++i) {
        check(H5DSattach_scale(datasets[i].id(), time, 0), "cannot attach time to '" + block.series[i].path + "'");
        check(H5DSset_label(datasets[i].id(), 0, "time"), "cannot label '" + block.series[i].path + "'");
    }
    return datasets;
}

/// Names the second dimension of a dataset by a scale without numbers at the top of the file, where netCDF finds it from every group; the
/// first dataset along an axis makes it.
void attach_axis(hid_t file, hid_t dataset, const std::string& axis, std::size_t width) {
    const std::string what = "cannot make the axis '" + axis + "'";
    if (!has_object(file, "/" + axis)) {
        const hsize_t size = width;
        const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, what);
        const Handle made(H5Dcreate2(file, axis.c_str(), H5T_NATIVE_UINT8, space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose,
                          what);
        const std::string mark = fmt::format("This is a netCDF dimension but not a netCDF variable. {:10}", width);
        check(H5DSset_scale(made.id(), mark.c_str()), what);
    }
    const Handle scale = open_series(file, "/" + axis);
    check(H5DSattach_scale(dataset, scale.id(), 1), what);
    check(H5DSset_label(dataset, 1, axis.c_str()), what);
}

void describe_channels(hid_t file, const std::vector<Handle>& datasets, const std::vector<ChannelInfo>& channels) {
    for (std::size_t i = 0; i < channels.size(); ++i) {
        const hid_t dataset = datasets[i].id();
        write_attribute(dataset, {"units", channels[i].unit});
        write_attribute(dataset, {"description", channels[i].description});
        write_attribute(dataset, {"index", static_cast<std::int64_t>(i)});
        if (channels[i].width > 1 && !channels[i].axis.empty()) {
            attach_axis(file, dataset, channels[i].axis, static_cast<std::size_t>(channels[i].width));
            write_attribute(dataset, {"axis", channels[i].axis});
        }
    }
}

/// A kill ends a write between two pages of the kernel. So that it leaves every block of HDF5's tables old or new, none lies across a
/// border: blocks of an index have 2 KiB and less up to 8,180 chunks of a series.
Handle paged() {
    Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "cannot make creation properties");
    check(H5Pset_file_space_strategy(creation.id(), H5F_FSPACE_STRATEGY_PAGE, false, 1), "cannot choose how space is given");
    check(H5Pset_file_space_page_size(creation.id(), kernel_page), "cannot choose a page");
    return creation;
}

void create_table(hid_t file, const BlockShape& block, const TableInfo& table) {
    const Handle dataset = create_series(file, block.series.front());
    write_attribute(dataset.id(), {"description", table.description});
    write_texts(dataset.id(), "units", table.columns, &TableColumn::unit);
    write_texts(dataset.id(), "descriptions", table.columns, &TableColumn::description);
}

}  // namespace

void check_contents(const RunContents& contents) {
    check_names(contents.channels, "channel", {"time"});
    check_names(contents.tables, "table", {});
    check_names(contents.attributes, "attribute", {"format", "format_version", "status"});
    for (const ChannelInfo& channel : contents.channels)
        if (channel.width < 1) throw Failure("the channel '" + channel.name + "' has width " + std::to_string(channel.width));
    for (const TableInfo& table : contents.tables) {
        check_names(table.columns, "column", {});
        if (table.columns.empty()) throw Failure("the table '" + table.name + "' has no columns");
    }
}

RunLayout run_layout(const RunContents& contents, const RunFileOptions& options) {
    RunLayout layout;
    const auto rows = static_cast<std::size_t>(std::max(1, options.channel_rows));
    const std::size_t chunk = std::min(rows, most_channel_rows);
    layout.channels.rows = rows;
    for (const ChannelInfo& channel : contents.channels) {
        const auto width = static_cast<std::size_t>(channel.width);
        layout.channels.series.push_back(
            {"/channels/" + channel.name, width > 1 ? H5T_NATIVE_FLOAT : H5T_NATIVE_DOUBLE, width, width == 1, chunk});
    }
    layout.channels.series.push_back({.path = "/channels/time", .type = H5T_NATIVE_DOUBLE, .chunk = chunk});
    if (contents.state_size > 0) {
        const std::size_t few = state_rows(contents.state_size);
        layout.states.rows = state_chunks * few;
        const auto add = [&](const char* path, hid_t type, std::size_t width) {
            layout.states.series.push_back({path, type, width, false, few});
        };
        add("/states/y", H5T_NATIVE_DOUBLE, contents.state_size);
        if (contents.phase_count > 0) add("/states/phases", H5T_NATIVE_UINT8, contents.phase_count);
        layout.states.series.push_back({.path = "/states/time", .type = H5T_NATIVE_DOUBLE, .chunk = few});
    }
    for (const TableInfo& table : contents.tables) {
        layout.types.push_back(compound_type(table));
        layout.tables.push_back({{{.path = "/tables/" + table.name, .type = layout.types.back().id(), .chunk = table_rows}}, table_rows});
    }
    return layout;
}

void create_run(const std::string& path, const RunContents& contents, const RunLayout& layout) {
    Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, paged().id(), file_access().id()), H5Fclose, "cannot create");
    write_attribute(file.id(), {"format", run_format});
    write_attribute(file.id(), {"format_version", run_format_version});
    write_attribute(file.id(), {"status", "running"});
    for (const Attribute& attribute : contents.attributes) write_attribute(file.id(), attribute);
    describe_channels(file.id(), create_block(file.id(), layout.channels), contents.channels);
    if (const auto datasets = create_block(file.id(), layout.states); !datasets.empty()) {
        write_attribute(datasets.front().id(), {"description", contents.state_description});
        attach_axis(file.id(), datasets[0].id(), "unknown", contents.state_size);
        if (contents.phase_count > 0) attach_axis(file.id(), datasets[1].id(), "phase", contents.phase_count);
    }
    for (std::size_t i = 0; i < contents.tables.size(); ++i) create_table(file.id(), layout.tables[i], contents.tables[i]);
    file.close("cannot create");
}

}  // namespace cvtflow::engine::hdf5
