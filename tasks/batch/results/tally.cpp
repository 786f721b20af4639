#include "tasks/batch/results/tally.hpp"

#include <algorithm>

#include "tasks/batch/case_engine.hpp"

namespace cvtflow::tasks {

void CaseTally::add(const engine::RowLayout& layout, std::span<const std::byte> row) {
    const std::string status = layout.text(row, layout.column("status"));
    ++rows_;
    ++statuses_[status];
    if (layout.has("notes")) {
        const std::string names = layout.text(row, layout.column("notes"));
        for (std::size_t begin = 0; begin < names.size();) {
            const std::size_t end = std::min(names.find(' ', begin), names.size());
            if (end > begin) ++notes_[names.substr(begin, end - begin)];
            begin = end + 1;
        }
    }
    if (status == status_name(CaseStatus::ok) || !layout.has("error")) return;
    const std::string error = layout.text(row, layout.column("error"));
    const long number = layout.integer(row, layout.column("case"));
    const auto known = std::ranges::find_if(failures_, [&](const Failure& each) { return each.status == status && each.error == error; });
    if (known == failures_.end()) {
        if (failures_.size() < max_failures) failures_.push_back({status, error, number, 1});
        return;
    }
    ++known->cases;
    known->first = std::min(known->first, number);
}

long CaseTally::failed() const noexcept {
    const auto ok = statuses_.find(std::string(status_name(CaseStatus::ok)));
    return rows_ - (ok == statuses_.end() ? 0 : ok->second);
}

}  // namespace cvtflow::tasks
