#pragma once
/// A ZIP file of a few parts, compressed from 64 KiB on.

#include <string>
#include <vector>

namespace cvtflow::tools {

struct ZipPart {
    std::string name;  ///< with '/' between folders
    std::string bytes;
};

/// The file's bytes: the same for the same parts and version of zlib. @throws std::length_error beyond 2 GiB
[[nodiscard]] std::string zip_file(const std::vector<ZipPart>& parts);

}  // namespace cvtflow::tools
