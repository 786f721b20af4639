#include "tools/program/output/text_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace cvtflow::tools {

void write_text(const std::string& path, std::string_view text) {
    errno = 0;
    std::ofstream file(path, std::ios::binary);
    file << text;
    file.close();
    if (!file) throw std::runtime_error(path + ": cannot write" + (errno != 0 ? std::string(": ") + std::strerror(errno) : ""));
}

}  // namespace cvtflow::tools
