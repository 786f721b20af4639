#pragma once
/// Every object and every attribute of an HDF5 file, each with every change that can be made to it.

#include <cstddef>
#include <string>
#include <vector>

namespace cvtflow::tools {

/// One change of one object, or of one of its attributes.
struct ObjectForgery {
    std::string object;     ///< path, "/" for the whole file
    std::string attribute;  ///< empty: the object itself
    std::string change;     ///< a name in the list of changes

    /// Makes it, and seals the file anew so that only its contents are false.
    void make(const std::string& path) const;
    [[nodiscard]] std::string text() const;
};

/// All forgeries of a file, in the order of its objects.
[[nodiscard]] std::vector<ObjectForgery> forgeries_of(const std::string& path);

}  // namespace cvtflow::tools
