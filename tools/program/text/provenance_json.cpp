#include "tools/program/text/provenance_json.hpp"

#include "engine/base/provenance.hpp"

namespace cvtflow::tools {

nlohmann::ordered_json provenance_json() {
    const engine::Provenance here = engine::current_provenance();
    return {{"version", here.version},
            {"commit", here.commit},
            {"compiler", here.compiler},
            {"build_type", here.build_type},
            {"instruction_set", here.instruction_set},
            {"cpu", here.cpu},
            {"cores", here.cores},
            {"os", here.os},
            {"date", here.date}};
}

std::string json_text(const nlohmann::ordered_json& json) {
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace cvtflow::tools
