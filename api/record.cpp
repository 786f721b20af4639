#include <cvtflow/record.hpp>

#include <algorithm>

#include "api/host/translate.hpp"
#include "engine/base/spelling.hpp"
#include "engine/record/run/run_reader.hpp"
#include "tasks/batch/results/results.hpp"

namespace cvtflow {
inline namespace v0 {

using api::entered;

namespace {

[[nodiscard]] RecordAttributes attributes_from(const std::vector<engine::Attribute>& rows) {
    RecordAttributes attributes;
    for (const engine::Attribute& row : rows) attributes.emplace_back(row.name, row.value);
    return attributes;
}

}  // namespace

struct Record::Impl {
    engine::RunReader reader;
};

Record::Record(const std::string& path)
    : impl_(entered(ErrorCode::record, [&] { return std::make_unique<Impl>(Impl{engine::RunReader(path)}); })) {}
Record::~Record() = default;
Record::Record(Record&& other) noexcept = default;
Record& Record::operator=(Record&& other) noexcept = default;

const std::string& Record::status() const noexcept { return impl_->reader.status(); }
std::size_t Record::rows() const noexcept { return impl_->reader.rows(); }

RecordAttributes Record::attributes() const {
    return entered(ErrorCode::record, [&] { return attributes_from(impl_->reader.attributes()); });
}

std::vector<Column> Record::channels() const {
    return entered(ErrorCode::record, [&] {
        std::vector<Column> columns;
        for (const engine::ChannelInfo& row : impl_->reader.channels())
            columns.push_back({row.name, row.unit, row.description, static_cast<std::size_t>(row.width)});
        return columns;
    });
}

std::vector<double> Record::read(const std::string& channel, std::size_t first, std::size_t count) const {
    return entered(ErrorCode::record, [&] {
        if (first > rows() || count > rows() - first) {
            throw Error(ErrorCode::argument,
                        "rows " + std::to_string(first) + " to " + std::to_string(first + count) + " of " + std::to_string(rows()));
        }
        return impl_->reader.channel_rows(channel, first, count);
    });
}

std::vector<double> Record::read(const std::string& channel) const { return read(channel, 0, rows()); }
std::vector<double> Record::state_times() const {
    return entered(ErrorCode::record, [&] { return impl_->reader.state_times(); });
}

struct Table::Impl {
    engine::CaseTable table;

    [[nodiscard]] std::size_t column(const std::string& name) const {
        const auto& columns = table.layout.columns();
        std::vector<std::string> names;
        for (std::size_t index = 0; index < columns.size(); ++index) {
            if (columns[index].name == name) return index;
            names.push_back(columns[index].name);
        }
        throw Error(ErrorCode::argument, "column: there is no '" + name + "'" + engine::did_you_mean(engine::closest(name, names)));
    }
};

Table::Table(const std::string& path)
    : impl_(entered(ErrorCode::record, [&] {
          auto made = std::make_unique<Impl>(Impl{tasks::read_results(path)});
          tasks::sort_rows(made->table);
          return made;
      })) {}
Table::~Table() = default;
Table::Table(Table&& other) noexcept = default;
Table& Table::operator=(Table&& other) noexcept = default;

std::size_t Table::rows() const noexcept { return impl_->table.size(); }
RecordAttributes Table::attributes() const {
    return entered(ErrorCode::record, [&] { return attributes_from(impl_->table.attributes); });
}

std::vector<Column> Table::columns() const {
    return entered(ErrorCode::record, [&] {
        std::vector<Column> columns;
        for (const engine::CaseColumn& row : impl_->table.layout.columns())
            columns.push_back({row.name, row.unit, row.description, 1, row.type == engine::CaseColumnType::text});
        return columns;
    });
}

std::vector<double> Table::numbers(const std::string& column) const {
    return entered(ErrorCode::record, [&] {
        const std::size_t index = impl_->column(column);
        const engine::RowLayout& layout = impl_->table.layout;
        const engine::CaseColumnType type = layout.columns()[index].type;
        if (type == engine::CaseColumnType::text) throw Error(ErrorCode::argument, "column: '" + column + "' holds texts");
        std::vector<double> values;
        for (std::size_t row = 0; row < rows(); ++row) {
            const auto bytes = impl_->table.row(row);
            values.push_back(type == engine::CaseColumnType::real ? layout.real(bytes, index)
                                                                  : static_cast<double>(layout.integer(bytes, index)));
        }
        return values;
    });
}

std::vector<std::string> Table::texts(const std::string& column) const {
    return entered(ErrorCode::record, [&] {
        const std::size_t index = impl_->column(column);
        std::vector<std::string> values;
        for (std::size_t row = 0; row < rows(); ++row) values.push_back(impl_->table.layout.cell(impl_->table.row(row), index));
        return values;
    });
}

}  // namespace v0
}  // namespace cvtflow
