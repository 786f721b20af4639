/// Power cuts, which keep of the unsynced data nothing or a part.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "engine/base/hash.hpp"
#include "engine/record/run/run_reader.hpp"
#include "tests/tools/program_fixture.hpp"

#ifdef CVTFLOW_POWER

namespace cvtflow::tools {
namespace {

namespace fs = std::filesystem;

// Remains of the files that a program has written, after a power cut (tests/faults/power.c records the writes).

/// One change to a file or a name, as in the log.
struct Change {
    std::string what;         ///< create, mkdir, remove, rename, write, size, sync, syncfs
    std::uint64_t inode = 0;  ///< inode of file or folder; 0 where only names change
    std::size_t at = 0;       ///< position of a write; the length that size sets
    std::string bytes;
    std::string path, to;  ///< names that change
};

/// Guarantee of a system: dropped keeps nothing that was not synced, names only with their folder. journalled is the behaviour of file
/// systems: a sync brings all names before it to disk as well, later ones follow in their order, and of unsynced bytes some pages.
enum class Disk { dropped, journalled };

/// Does a write or a new length to the bytes of a file.
void carry_out(const Change& change, std::string& bytes) {
    if (change.what == "size") return bytes.resize(change.at);
    if (bytes.size() < change.at + change.bytes.size()) bytes.resize(change.at + change.bytes.size());
    bytes.replace(change.at, change.bytes.size(), change.bytes);
}

constexpr std::size_t page_size = 4096;

/// A file's bytes: now, and what of them is on disk.
struct Content {
    std::string now, durable;
    std::vector<Change> since;  ///< changes since it was synced
    bool folder = false;
};

/// "./out/" is "out".
std::string plain(const std::string& path) {
    const std::string normal = fs::path(path).lexically_normal().string();
    return normal.size() > 1 && normal.back() == '/' ? normal.substr(0, normal.size() - 1) : normal;
}

/// The names of a line: one, or two with a tab between them.
void read_names(const std::string& text, Change& change) {
    const std::size_t tab = text.find('\t');
    change.path = plain(text.substr(0, tab));
    if (tab != std::string::npos) change.to = plain(text.substr(tab + 1));
}

/// Names and contents while changes are gone through.
class Replay {
public:
    Replay(Disk disk, const fs::path& folder) : disk_(disk) {
        struct stat of {};
        if (stat(folder.c_str(), &of) == 0) folders_[of.st_ino] = folder.string();
    }

    void add(const Change& change) {
        if (change.what == "create" || change.what == "mkdir") {
            by_inode_[change.inode] = std::make_shared<Content>();
            by_inode_[change.inode]->folder = change.what == "mkdir";
            if (change.what == "mkdir") folders_[change.inode] = change.path;
        }
        if (change.what == "sync") return sync(change.inode);
        if (change.what == "syncfs") return sync_all();
        const auto of = by_inode_.find(change.inode);
        if (change.what == "write" || change.what == "size") {
            if (of == by_inode_.end()) return;  // of a file outside
            carry_out(change, of->second->now);
            of->second->since.push_back(change);
            return;
        }
        waiting_.push_back({change, of == by_inode_.end() ? nullptr : of->second});
        rename(names_, waiting_.back());
    }

    /// Where nothing is that the log names.
    void write(std::mt19937& chance) {
        if (disk_ == Disk::journalled) {
            const std::size_t more = waiting_.empty() ? 0 : chance() % (waiting_.size() + 1);
            for (std::size_t i = 0; i < more; ++i) rename(durable_, waiting_[i]);
        }
        for (const auto& [path, content] : durable_) {  // folders come before what is in them
            if (!fs::is_directory(fs::path(path).parent_path())) continue;
            if (content->folder) {
                fs::create_directory(path);
                continue;
            }
            std::ofstream(path, std::ios::binary) << left_of(*content, chance);
        }
    }

private:
    struct Naming {
        Change change;
        std::shared_ptr<Content> content;
    };
    using Names = std::map<std::string, std::shared_ptr<Content>>;

    void rename(Names& names, const Naming& naming) {
        if (naming.change.what == "remove") {
            names.erase(naming.change.path);
        } else if (naming.change.what == "rename") {
            if (const auto from = names.find(naming.change.path); from != names.end()) {
                names[naming.change.to] = from->second;
                names.erase(from);
            }
        } else {
            names[naming.change.path] = naming.content;
        }
    }

    void sync(std::uint64_t inode) {
        if (const auto of = by_inode_.find(inode); of != by_inode_.end()) {
            of->second->durable = of->second->now;
            of->second->since.clear();
        }
        if (disk_ == Disk::journalled) {
            for (const Naming& naming : waiting_) rename(durable_, naming);
            waiting_.clear();
            return;
        }
        const auto folder = folders_.find(inode);
        if (folder == folders_.end()) return;
        const auto beside = [&](const std::string& name) { return fs::path(name).parent_path() == folder->second; };
        std::erase_if(durable_, [&](const auto& entry) { return beside(entry.first); });
        for (const auto& entry : names_) {
            if (beside(entry.first)) durable_.insert(entry);
        }
    }

    void sync_all() {
        for (const auto& [inode, content] : by_inode_) sync(inode);
        durable_ = names_;
        waiting_.clear();
    }

    [[nodiscard]] std::string left_of(const Content& content, std::mt19937& chance) const {
        std::string bytes = content.durable;
        if (disk_ == Disk::dropped) return bytes;
        for (const Change& change : content.since) {
            for (std::size_t at = 0; at < std::max<std::size_t>(1, change.bytes.size()); at += page_size) {
                Change part = change;
                part.at += at;
                part.bytes = change.bytes.substr(std::min(at, change.bytes.size()), page_size);
                if (chance() % 2 == 0) carry_out(part, bytes);
            }
        }
        return bytes;
    }

    Disk disk_;
    std::map<std::uint64_t, std::shared_ptr<Content>> by_inode_;
    std::map<std::uint64_t, std::string> folders_;
    Names names_, durable_;
    std::vector<Naming> waiting_;
};

/// @param folder  changes outside of it are left out
std::vector<Change> read_power_log(const fs::path& log, const fs::path& folder) {
    std::ifstream file(log, std::ios::binary);
    std::vector<Change> changes;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        Change change;
        words >> change.what >> change.inode;
        if (change.what == "write" || change.what == "size" || change.what.starts_with("sync")) {
            std::size_t count = 0;
            words >> change.at >> count;
            change.bytes.resize(count);
            file.read(change.bytes.data(), static_cast<std::streamsize>(count));
        } else {
            std::string names;
            std::getline(words >> std::ws, names);
            read_names(names, change);
            if (!change.path.starts_with(folder.string() + "/")) continue;
        }
        changes.push_back(std::move(change));
    }
    return changes;
}

/// Puts into `folder` what the first `count` changes leave on disk.
/// @param folder  as in the log; empty, but for what was there before   @param chance  for Disk::journalled
void cut_power(const std::vector<Change>& changes, std::size_t count, Disk disk, const fs::path& folder, std::mt19937& chance) {
    Replay replay(disk, folder);
    for (std::size_t i = 0; i < std::min(count, changes.size()); ++i) replay.add(changes[i]);
    replay.write(chance);
}

// Power cuts: unsynced data are lost, or part of them. A run or sweep resumes from the rest, and its results are bitwise those of an
// undisturbed one; or a run reports clearly that it cannot resume. Only complete files have a final name.

class PowerCut : public Sweeps {
protected:
    PowerCut() { std::filesystem::create_directory(work_); }

    Outcome run_at_work(const std::vector<std::string>& arguments, const std::vector<std::string>& environment = {}) const {
        return Child(arguments, work_, environment).wait();
    }

    /// Runs to the end. @return everything that was done to files on the way
    [[nodiscard]] std::vector<Change> logged(const std::vector<std::string>& arguments) const {
        const Outcome outcome = run_at_work(arguments, {preload(CVTFLOW_POWER), "CVTFLOW_POWER_LOG=" + (folder_ / "changes").string()});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return read_power_log(folder_ / "changes", work_);
    }

    /// Removes all files but those that were there before the program ran.
    void clear_work() const {
        const std::vector<std::filesystem::directory_entry> all(std::filesystem::directory_iterator(work_), {});
        for (const auto& entry : all) {
            if (entry.path().filename() != "sweep.toml") std::filesystem::remove_all(entry.path());
        }
    }

    /// Resumes after `cuts` cuts, one in each of as many equal parts of the changes, every other one of each kind.
    /// @param resume  status 0 if the result exists and is the same; else the message of the refusal
    template <class Resume>
    void cut_and_resume(const std::vector<Change>& changes, int cuts, const Resume& resume) {
        std::mt19937 chance(17);
        for (int cut = 0; cut < cuts; ++cut) {
            const std::size_t part = changes.size() / static_cast<std::size_t>(cuts) + 1;
            const std::size_t count = std::min(changes.size(), part * static_cast<std::size_t>(cut) + chance() % part);
            const Disk disk = cut % 2 == 0 ? Disk::dropped : Disk::journalled;
            clear_work();
            cut_power(changes, count, disk, work_, chance);
            SCOPED_TRACE("cut " + std::to_string(cut) + " after " + std::to_string(count) + " of " + std::to_string(changes.size()));
            const Outcome outcome = resume();
            same_ += outcome.status == 0;
            if (outcome.status == 0) continue;
            EXPECT_EQ(disk, Disk::journalled) << "refused what was synced: " << outcome.err;
            EXPECT_EQ(outcome.status, 1) << outcome.err;
            EXPECT_TRUE(outcome.err.starts_with("cvtflow: ")) << outcome.err;
            std::printf("refused: %s", outcome.err.c_str());
        }
        std::printf("%d power cuts: %d the same bits (%d of them continued from a checkpoint or table), %d refused\n", cuts, same_,
                    continued_, cuts - same_);
    }

    /// Writes the sweep and runs it with checkpoints. @return everything that was done to files on the way
    [[nodiscard]] std::vector<Change> logged_sweep(const Words& order) const;
    void single_run(int cuts);
    void sweep(int cuts, const Words& order);

    const std::filesystem::path work_ = folder_ / "work";
    int same_ = 0, continued_ = 0;
};

/// Contents of a record: rows, the last state, how the run ended.
std::string contents_of(const std::filesystem::path& record) {
    const engine::RunReader reader(record.string());
    engine::Hash hash;
    for (const engine::ChannelInfo& channel : reader.channels()) hash.add(std::span<const double>(reader.channel(channel.name)));
    hash.add(std::span<const double>(reader.times()));
    hash.add(std::span<const double>(reader.state(reader.state_times().size() - 1).state));
    return std::to_string(reader.rows()) + " " + hash.hex() + " " + reader.status();
}

void PowerCut::single_run(int cuts) {
    const std::vector<std::string> order = run_to_be_ended("run.h5");
    const std::vector<Change> changes = logged(order + std::vector<std::string>{"--checkpoint-every", "3 ms"});
    const std::string whole = contents_of(work_ / "run.h5");
    cut_and_resume(changes, cuts, [&] {
        Outcome outcome;
        if (std::filesystem::exists(work_ / "run.checkpoint.h5")) {
            outcome = run_at_work({"resume", "run.checkpoint.h5", "-q"});
            continued_ += outcome.status == 0;
        } else if (!std::filesystem::exists(work_ / "run.h5")) {
            outcome = run_at_work(order);
        }
        if (outcome.status == 0) {
            EXPECT_EQ(contents_of(work_ / "run.h5"), whole);
        }
        return outcome;
    });
}

const std::vector<std::string> sweep_order{"batch", "sweep.toml", "-o", "out"};

std::vector<Change> PowerCut::logged_sweep(const Words& order) const {
    write_sweep("\"6 N*m\", \"12 N*m\", \"18 N*m\"", "0.2 ms");
    std::filesystem::rename(folder_ / "sweep.toml", work_ / "sweep.toml");
    return logged(order + std::vector<std::string>{"--threads", "2"});
}

void PowerCut::sweep(int cuts, const Words& order) {
    const std::vector<Change> changes = logged_sweep(order);
    const std::string whole = hash_in(run_at_work(order).out);
    cut_and_resume(changes, cuts, [&] {
        const bool begun = fs::exists(work_ / "out/sweep.json");
        const Outcome outcome = run_at_work(order);
        if (outcome.status == 0) {
            EXPECT_EQ(hash_in(outcome.out), whole) << outcome.err;
        }
        continued_ += begun && outcome.status == 0;
        return outcome;
    });
    EXPECT_EQ(same_, cuts);
}

TEST_F(PowerCut, OfARunLeavesWhatLeadsToTheSameBits) {
    single_run(test::depth(3, 20));
    EXPECT_GE(continued_, test::depth(1, 5));
}

TEST_F(PowerCut, OfASweepLeavesWhatLeadsToTheSameBits) {
    sweep(test::depth(3, 20), sweep_order);
    EXPECT_GE(continued_, test::depth(1, 5));
}

using NightlyPowerCut = PowerCut;

TEST_F(NightlyPowerCut, TwoHundredOfARun) { single_run(200); }
TEST_F(NightlyPowerCut, TwoHundredOfASweep) { sweep(200, sweep_order); }

}  // namespace
}  // namespace cvtflow::tools

#endif
