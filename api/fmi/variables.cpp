#include "api/fmi/variables.hpp"

#include <cvtflow/error.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <locale>
#include <sstream>

namespace cvtflow::fmi {

std::string read_file(const std::string& path) {
    const std::filesystem::path place(std::u8string(path.begin(), path.end()));  // FMI's paths are UTF-8, Windows' are not
    std::ifstream file(place, std::ios::binary);
    if (!file) throw Error(ErrorCode::argument, path + ": cannot be read");
    return {std::istreambuf_iterator<char>(file), {}};
}

Variables read_variables(const std::string& path) {
    static const std::map<std::string, VariableKind> kinds{{"time", VariableKind::time},
                                                           {"input", VariableKind::input},
                                                           {"output", VariableKind::output},
                                                           {"parameter", VariableKind::parameter}};
    Variables variables;
    std::istringstream lines(read_file(path));
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        words.imbue(std::locale::classic());
        std::uint32_t reference = 0;
        std::string kind;
        Variable variable;
        if (!(words >> reference >> kind >> variable.width >> variable.name) || !kinds.contains(kind))
            throw Error(ErrorCode::argument, path + ": not a variable: " + line);
        words >> variable.element;
        variable.kind = kinds.at(kind);
        variables[reference] = variable;
    }
    return variables;
}

}  // namespace cvtflow::fmi
