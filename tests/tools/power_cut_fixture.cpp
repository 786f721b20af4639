#include "tests/tools/power_cut_fixture.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>

namespace cvtflow::tools {

namespace fs = std::filesystem;

namespace {

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

}  // namespace

void carry_out(const Change& change, std::string& bytes) {
    if (change.what == "size") return bytes.resize(change.at);
    if (bytes.size() < change.at + change.bytes.size()) bytes.resize(change.at + change.bytes.size());
    bytes.replace(change.at, change.bytes.size(), change.bytes);
}

std::vector<Change> read_power_log(const fs::path& log, const fs::path& folder) {
    std::ifstream file(log, std::ios::binary);
    std::vector<Change> changes;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        Change change;
        words >> change.what >> change.inode;
        if (change.what == "write" || change.what == "size" || change.what == "sync") {
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

void cut_power(const std::vector<Change>& changes, std::size_t count, Disk disk, const fs::path& folder, std::mt19937& chance) {
    Replay replay(disk, folder);
    for (std::size_t i = 0; i < std::min(count, changes.size()); ++i) replay.add(changes[i]);
    replay.write(chance);
}

}  // namespace cvtflow::tools
