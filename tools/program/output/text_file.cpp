#include "tools/program/output/text_file.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "engine/record/run/part_file.hpp"
#include "engine/record/run/schema.hpp"

namespace cvtflow::tools {

namespace {

[[noreturn]] void fail(const std::string& path, int reason) {
    throw engine::RecordError(path + ": cannot write" + (reason != 0 ? std::string(": ") + std::strerror(reason) : ""));
}

/// Whether the path is free or a plain file, in a folder where another file can be created.
bool replaceable(const std::string& path) {
    namespace fs = std::filesystem;
    std::error_code unknown;
    const fs::file_status there = fs::symlink_status(path, unknown);
    const std::string folder = fs::path(path).parent_path().string();
    return (there.type() == fs::file_type::not_found || there.type() == fs::file_type::regular) &&
           access(folder.empty() ? "." : folder.c_str(), W_OK) == 0;
}

}  // namespace

void write_text(const std::string& path, std::string_view text) {
    if (replaceable(path)) {
        engine::PartFile part(path, true);
        if (const int reason = part.write(text.data(), text.size()); reason != 0) {
            part.discard();
            fail(path, reason);
        }
        return part.publish();
    }
    errno = 0;
    std::ofstream file(path, std::ios::binary);  // a device, a pipe or the target of a link: as a shell's >
    file << text;
    file.close();
    if (!file) fail(path, errno);
}

}  // namespace cvtflow::tools
