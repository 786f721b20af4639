#include "tasks/batch/shared_work.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

namespace cvtflow::tasks {

namespace {

constexpr long pieces_of_sweep = 1024;
constexpr double pause_seconds = 0.2, notice_after = 60.0;

std::string name_of(long piece) { return fmt::format("{:06}", piece); }

}  // namespace

SharedWork::SharedWork(const Sweep& sweep, SweepRows& rows, engine::Claims& claims, HasEnd has_end,
                       std::function<void(const std::string&)> notice)
    : sweep_(sweep),
      rows_(rows),
      claims_(claims),
      has_end_(std::move(has_end)),
      notice_(std::move(notice)),
      length_(std::max(1L, strands() / pieces_of_sweep)),
      taken_(static_cast<std::size_t>((strands() + length_ - 1) / length_)) {}

void SharedWork::restrict_to(long number) {
    cursor_ = std::ssize(taken_);
    std::ranges::fill(taken_, char{1});
    begin_ = number / sweep_.strand();
    end_ = begin_ + 1;
}

bool SharedWork::is_open(long strand) const noexcept {
    for (long number = strand * sweep_.strand(); number < (strand + 1) * sweep_.strand(); ++number)
        if (!rows_.files().has(number)) return true;
    return false;
}

/// The cases of a strand that have no row; all of them if one of these would start from an end that is not there.
std::vector<CaseToRun> SharedWork::cases_of(long strand) const {
    std::vector<CaseToRun> cases;
    bool broken = false;
    for (long number = strand * sweep_.strand(); number < (strand + 1) * sweep_.strand(); ++number) {
        const bool is_new = !rows_.files().has(number);
        broken = broken || (!is_new && !cases.empty() && cases.back().is_new) ||
                 (!is_new && sweep_.strand() > 1 && rows_.text(number, "status") == status_name(CaseStatus::ok) && !has_end_(number));
        cases.push_back({number, is_new});
    }
    if (!broken) std::erase_if(cases, [](const CaseToRun& each) { return !each.is_new; });
    return cases;
}

bool SharedWork::take(long piece) {
    if (!claims_.take(name_of(piece))) return false;
    taken_[static_cast<std::size_t>(piece)] = 1;
    begin_ = piece * length_;
    end_ = std::min(begin_ + length_, strands());
    return true;
}

/// Claims the next piece that nobody has; pieces of other processes are passed over.
bool SharedWork::claim_new() {
    while (cursor_ < std::ssize(taken_)) {
        const long piece = cursor_++, first = piece * length_, end = std::min(first + length_, strands());
        bool open = false;
        for (long strand = first; strand < end && !open; ++strand) open = is_open(strand);
        if (open && take(piece)) return true;
    }
    return false;
}

/// Claims a piece of a process that is lost. @param others  whether another process is at work
bool SharedWork::claim_lost(bool& others) {
    others = false;
    for (long piece = 0; piece < std::ssize(taken_); ++piece) {
        if (taken_[static_cast<std::size_t>(piece)] != 0) continue;
        bool open = false;
        for (long strand = piece * length_; strand < std::min((piece + 1) * length_, strands()) && !open; ++strand) open = is_open(strand);
        if (!open) continue;
        if (take(piece)) return true;
        others = true;
    }
    return false;
}

void SharedWork::wait(double& waited) {
    usleep(static_cast<unsigned>(1e6 * pause_seconds));
    const double before = std::exchange(waited, waited + pause_seconds);
    if (notice_ && before < notice_after && waited >= notice_after)
        notice_(fmt::format("waits for the cases of {}; they run here if it gives no sign of life for two minutes", claims_.holder()));
}

std::vector<CaseToRun> SharedWork::next(const std::function<bool()>& stop) {
    double waited = 0.0;
    while (!stop()) {
        while (begin_ < end_) {
            if (std::vector<CaseToRun> cases = cases_of(begin_++); !cases.empty()) return cases;
        }
        if (claim_new()) continue;
        bool others = false;
        rows_.refresh();
        if (claim_lost(others)) continue;
        if (!others) return {};
        wait(waited);
    }
    return {};
}

}  // namespace cvtflow::tasks
