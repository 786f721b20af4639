#include <algorithm>

#include "api/c/boundary.hpp"

using namespace cvtflow;

extern "C" {

cvtflow_code cvtflow_record_open(const char* path, cvtflow_record** record, cvtflow_message* message) {
    return api::guarded(message, [&] {
        Record opened(&api::given(path, "path"));
        std::string status = opened.status();
        std::vector<Column> channels = opened.channels();
        api::given(record, "record") = new cvtflow_record{std::move(opened), std::move(status), std::move(channels)};
    });
}

void cvtflow_record_close(cvtflow_record* record) { delete record; }

const char* cvtflow_record_status(const cvtflow_record* record) { return record != nullptr ? record->status.c_str() : ""; }
size_t cvtflow_record_rows(const cvtflow_record* record) { return record != nullptr ? record->record.rows() : 0; }
size_t cvtflow_record_channel_count(const cvtflow_record* record) { return record != nullptr ? record->channels.size() : 0; }

cvtflow_code cvtflow_record_describe(const cvtflow_record* record, size_t channel, cvtflow_channel_info* info, cvtflow_message* message) {
    return api::guarded(message, [&] {
        const std::vector<Column>& rows = api::given(record, "record").channels;
        if (channel >= rows.size())
            throw Error(ErrorCode::argument, "channel: number " + std::to_string(channel) + " of " + std::to_string(rows.size()));
        const Column& row = rows[channel];
        const cvtflow_channel_info ours{sizeof ours, 0, row.name.c_str(), row.unit.c_str(), row.description.c_str(), row.width};
        api::fill_versioned(&api::given(info, "info"), &ours, sizeof ours, sizeof ours);
    });
}

cvtflow_code cvtflow_record_read(const cvtflow_record* record, const char* channel, size_t first, size_t count, double* values, size_t size,
                                 cvtflow_message* message) {
    return api::guarded(message, [&] {
        const std::vector<double> rows = api::given(record, "record").record.read(&api::given(channel, "channel"), first, count);
        if (rows.size() != size)
            throw Error(ErrorCode::argument, "size: " + std::to_string(size) + " for " + std::to_string(rows.size()) + " values");
        std::copy(rows.begin(), rows.end(), &api::given(values, "values"));
    });
}

}  // extern "C"
