#include "tests/tools/output/replacement_fixture.hpp"

#include <sys/stat.h>

#include "engine/base/hash.hpp"

namespace cvtflow::tools {

namespace fs = std::filesystem;

Replacement::Replacement() {
    std::string scene = "[scene]\nname = \"mine\"\n";
    write_sweep("\"6 N*m\"", "20 us");
    write("scene.toml", scene);
    write("numbers.csv", "time [s],load [N*m]\n0,1\n1,2\n");
    write("notes.txt", "mine\n");
    EXPECT_EQ(run(Words{"run", "tiny", "-o", "own.h5"} + brief_run).status, 0);
    EXPECT_EQ(run(Words{"run", "tiny", "-o", "foreign.h5", "--set", "scene.name=other"} + brief_run).status, 0);
    EXPECT_EQ(run(brief_settle + Words{"-o", "state.h5"}).status, 0);
    EXPECT_EQ(run(Words{"run", "tiny", "-o", "k.h5", "--checkpoint-every", "1 h", "--set", "run.max_steps=500"} + brief_run).status, 4);
    EXPECT_EQ(run({"batch", "sweep.toml", "-q", "-o", "first"}).status, 0);
    write_sweep("\"7 N*m\"", "20 us");
    for (const char* shard : {"1/2", "2/2"}) EXPECT_EQ(run({"batch", "sweep.toml", "-q", "-o", "cut", "--shard", shard}).status, 0);
    std::string text = read("sweep.toml");
    write("recorded.toml", text.insert(text.find("[start]"), "records = true\n"));
}

const std::map<std::string, std::string>& Replacement::kinds() {
    static const std::map<std::string, std::string> copies{{"own record", "own.h5"},
                                                           {"foreign record", "foreign.h5"},
                                                           {"state", "state.h5"},
                                                           {"checkpoint", "k.checkpoint.h5"},
                                                           {"table", "first/cases.h5"},
                                                           {"scene", "scene.toml"},
                                                           {"CSV", "numbers.csv"},
                                                           {"text", "notes.txt"},
                                                           {"read-only", "notes.txt"},
                                                           {"own .part", "own.h5"},
                                                           {"foreign .part", "foreign.h5"},
                                                           {"link", ""},
                                                           {"FIFO", ""},
                                                           {"folder", ""}};
    return copies;
}

fs::path Replacement::put(const std::string& kind, const std::string& target) const {
    const fs::path path = folder_ / (target + (kind.ends_with(".part") ? ".part" : ""));
    fs::create_directories(path.parent_path());
    if (kind == "link") fs::create_symlink(folder_ / "notes.txt", path);
    if (kind == "FIFO") mkfifo(path.c_str(), 0600);
    if (kind == "folder") fs::create_directory(path);
    if (!kinds().at(kind).empty()) fs::copy_file(folder_ / kinds().at(kind), path);
    if (kind == "read-only") fs::permissions(path, fs::perms::owner_read);
    return path;
}

std::map<std::string, std::string> Replacement::files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
        const fs::file_status status = entry.symlink_status();
        std::string what = std::to_string(static_cast<int>(status.type()));
        if (fs::is_regular_file(status))
            what += " " + engine::Hash().add(std::string_view(read(entry.path().lexically_relative(folder_)))).hex();
        if (fs::is_symlink(status)) what += " " + fs::read_symlink(entry).string();
        all[entry.path().lexically_relative(folder_)] = what;
    }
    return all;
}

void Replacement::expect_kept(const std::map<std::string, std::string>& before, const std::string& what) const {
    const auto after = files();
    for (const auto& [name, contents] : before) {
        const auto there = after.find(name);
        ASSERT_TRUE(there != after.end()) << what << ": " << name << " is gone";
        EXPECT_EQ(there->second, contents) << what << ": " << name << " has changed";
    }
}

void Replacement::forget_new(const std::map<std::string, std::string>& before) const {
    for (const auto& [name, contents] : files()) {
        if (!before.contains(name)) fs::remove_all(folder_ / name);
    }
}

}  // namespace cvtflow::tools
