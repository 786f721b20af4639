#include "tools/program/output/output_place.hpp"

#include "engine/record/run/part_file.hpp"
#include "engine/record/run/schema.hpp"
#include "tasks/run/checkpoint.hpp"

namespace cvtflow::tools {

void require_no_input(const std::string& path, const std::vector<std::filesystem::path>& inputs) {
    for (const std::string& written : {path, path + ".part"}) {
        for (const std::filesystem::path& input : inputs) {
            std::error_code absent;
            if (input.empty() || !std::filesystem::equivalent(written, input, absent) || absent) continue;
            throw engine::RecordError(path + ": cannot create: " + (written == path ? "it" : "its .part") + " would replace the input " +
                                      input.string());
        }
    }
}

void require_output(const std::string& path, const std::vector<std::filesystem::path>& inputs) {
    if (path.empty()) return;
    require_no_input(path, inputs);
    engine::require_replaceable(path);
}

void require_checkpoint_place(const std::string& path, const std::string& record, const std::vector<std::filesystem::path>& inputs) {
    require_output(path, inputs);
    const auto place = [](const std::string& name) { return std::filesystem::absolute(name).lexically_normal(); };
    for (const char* suffix : {"", ".part", ".before"}) {
        if (!record.empty() && (place(path) == place(record + suffix) || place(path + suffix) == place(record))) {
            throw engine::RecordError("--checkpoint " + path + ": the run needs that name for its record " + record);
        }
    }
    std::error_code absent;
    if (!std::filesystem::exists(path, absent)) return;
    try {
        static_cast<void>(tasks::read_checkpoint(path));
    } catch (const engine::RecordError& error) {
        throw engine::RecordError(std::string("--checkpoint: the file exists and is not a checkpoint: ") + error.what());
    }
}

}  // namespace cvtflow::tools
