#include "engine/record/run/former_record.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>

#include "engine/base/hash.hpp"
#include "engine/record/run/run_reader.hpp"

namespace cvtflow::engine {
namespace {

constexpr std::size_t rows_at_once = 256;

void require_rows(const std::string& path, const char* what, std::size_t found, std::size_t requested) {
    if (found >= requested) return;
    throw RecordError(fmt::format("{}: cannot be continued: it contains {} {}, the checkpoint follows {}", path, found, what, requested));
}

void require_same_rows(const std::string& path, const char* what, const RowsWritten& found, const RowsWritten& requested) {
    if (found == requested) return;
    throw RecordError(fmt::format("{}: cannot be continued: damaged: its {} differ from those written before the checkpoint", path, what));
}

/// @return what was copied
RowsWritten copy_channels(const RunReader& former, const RunContents& contents, std::size_t rows, RunFile& file) {
    RowsWritten copied;
    std::vector<double> row;
    for (std::size_t first = 0; first < rows; first += rows_at_once) {
        const std::size_t count = std::min(rows_at_once, rows - first);
        const std::vector<double> times = former.channel_rows("time", first, count);
        std::vector<std::vector<double>> blocks;
        for (const ChannelInfo& channel : contents.channels) blocks.push_back(former.channel_rows(channel.name, first, count));
        for (std::size_t i = 0; i < count; ++i) {
            row.clear();
            for (const std::vector<double>& block : blocks) {
                const auto width = static_cast<std::ptrdiff_t>(block.size() / count);
                const auto begin = block.begin() + static_cast<std::ptrdiff_t>(i) * width;
                row.insert(row.end(), begin, begin + width);
            }
            file.append(times[i], row);
            copied.add(times[i], row);
        }
    }
    return copied;
}

RowsWritten copy_states(const RunReader& former, std::size_t count, RunFile& file) {
    RowsWritten copied;
    for (std::size_t i = 0; i < count; ++i) {
        const RecordedState state = former.state(i);
        file.append_state(state.time, state.state, state.phases);
        copied.add(state.time, state.state, state.phases);
    }
    return copied;
}

}  // namespace

void RowsWritten::add(double time, std::span<const double> values, std::span<const std::uint8_t> phases) noexcept {
    ++count;
    sum = Checksum()
              .add(std::as_bytes(std::span(&sum, 1)))
              .add(std::as_bytes(std::span(&time, 1)))
              .add(std::as_bytes(values))
              .add(std::as_bytes(phases))
              .value();
}

FormerRecord former_record(OutputFile& file, const MayReplace& own) {
    const auto is_own = [own](const std::string& there) { return OutputFile(there, own).replaces(there); };
    file.may_replace = [is_own, others = file](const std::string& there) { return is_own(there) || others.replaces(there); };
    require_place(file);
    for (const std::string& there : {file.path + ".part", file.path}) {
        if (!is_own(there)) continue;
        Descriptor lock(open(there.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW));
        if (lock.number() >= 0 && !lock_file(lock.number(), there))
            throw RecordError(there + ": cannot be continued: " + writer_of(there) + " is writing it");
        return {there, std::move(lock)};
    }
    return {};
}

void copy_record(const std::string& path, const RecordPosition& until, const RunContents& contents, RunFile& file) {
    const RunReader former(path);
    require_rows(path, "rows", former.rows(), until.channels.count);
    require_rows(path, "states", former.state_times().size(), until.states.count);
    if (former.channels() != contents.channels) throw RecordError(path + ": cannot be continued: it contains other channels");
    require_same_rows(path, "rows", copy_channels(former, contents, until.channels.count, file), until.channels);
    require_same_rows(path, "states", copy_states(former, until.states.count, file), until.states);
    for (std::size_t i = 0; i < contents.tables.size(); ++i) {
        const RowsWritten requested = i < until.tables.size() ? until.tables[i] : RowsWritten{};
        const auto rows = former.table(contents.tables[i].name);
        require_rows(path, "transitions", rows.size(), requested.count);
        RowsWritten copied;
        for (std::size_t row = 0; row < requested.count; ++row) {
            file.append_row(contents.tables[i].name, rows[row]);
            copied.add(0.0, rows[row]);
        }
        require_same_rows(path, "transitions", copied, requested);
    }
    file.take_place();
}

}  // namespace cvtflow::engine
