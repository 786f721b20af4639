#include "tools/program/html/assets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace cvtflow::tools {

std::string_view asset(std::string_view name) {
    const auto found = std::find_if(assets().begin(), assets().end(), [&](const Asset& asset) { return asset.name == name; });
    if (found != assets().end()) return found->text;
    throw std::runtime_error(fmt::format(
        "reports require {}, which was missing when this program was built: install Debian's libjs-dygraphs and libjs-three, or run npm ci "
        "in tools/program/html/browser, then configure and build again; cvtflow plot requires neither",
        name));
}

}  // namespace cvtflow::tools
