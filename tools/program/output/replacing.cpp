#include "tools/program/output/replacing.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "engine/record/run/schema.hpp"

namespace cvtflow::tools {

namespace {

bool is_there(const std::string& file) {
    std::error_code unknown;  // writing the file reports errors of the path
    return !file.empty() && std::filesystem::is_regular_file(file, unknown);
}

}  // namespace

std::string replacing(const std::string& file, bool chosen, bool force) {
    if (!is_there(file)) return {};
    if (chosen && !force) throw engine::RecordError(file + ": already exists; --force replaces it");
    return file + ": the existing file is replaced";
}

void keep_checkpoint(const std::string& file, bool force) {
    if (force || !is_there(file)) return;
    throw engine::RecordError(
        fmt::format("{0}: the checkpoint of an unfinished run; cvtflow resume {0} continues it, --force starts again", file));
}

}  // namespace cvtflow::tools
