#include "tools/program/output/replacing.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "engine/record/run/schema.hpp"

namespace cvtflow::tools {

namespace {

bool is_there(const std::string& file) {
    std::error_code unknown;  // who writes the file says what is wrong with the place
    return !file.empty() && std::filesystem::is_regular_file(file, unknown);
}

}  // namespace

std::string replacing(const std::string& file, bool chosen, bool force) {
    if (!is_there(file)) return {};
    if (chosen && !force) throw engine::RecordError(file + ": is there already; --force replaces it");
    return file + ": what was there is replaced";
}

void keep_checkpoint(const std::string& file, bool force) {
    if (force || !is_there(file)) return;
    throw engine::RecordError(
        fmt::format("{0}: the checkpoint of a run that did not finish; cvtflow resume {0} goes on with it, --force begins anew", file));
}

}  // namespace cvtflow::tools
