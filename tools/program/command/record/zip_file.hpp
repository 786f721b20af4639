#pragma once
/// ZIP files.

#include <string>
#include <vector>

namespace cvtflow::tools {

/// A part of a ZIP file.
struct ZipPart {
    std::string name;  ///< with '/' between folders
    std::string bytes;
};

/// The parts as a ZIP file, compressed; the first, up to 64 KiB, is not, so that its text can be found. Equal bytes for the same parts
/// and version of zlib.
/// @throws std::length_error beyond 2 GiB
[[nodiscard]] std::string zip_file(const std::vector<ZipPart>& parts);

}  // namespace cvtflow::tools
