#pragma once
/// Documents of an FMU beside its description: a page, licences, an icon.

#include <vector>

#include "tools/program/command/record/fmu_description.hpp"
#include "tools/program/command/record/zip_file.hpp"

namespace cvtflow::tools {

/// Parts of the file where the standard's version has them. @param version  2 or 3
[[nodiscard]] std::vector<ZipPart> fmu_documents(const FmuFacts& facts, const std::vector<FmuVariable>& variables, int version);

}  // namespace cvtflow::tools
