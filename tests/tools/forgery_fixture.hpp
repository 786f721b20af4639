#pragma once
/// Files forged by an attacker: sound for HDF5, with a right seal and right hashes, and false contents. A seed decides what is forged, or
/// every object and every attribute is forged in turn.

#include <hdf5.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace cvtflow::tools {

/// Kind of file.
enum class Forged { record, state, table };

/// Hostile names and texts: markup, escape sequences, formulas.
[[nodiscard]] std::string hostile_text(std::uint64_t number);

/// Changes a file in place: shapes, types, links, missing and swollen data, invalid numbers, hostile names and texts. States keep a
/// right hash, rows of tables their check. @return description of the change
std::string forge(const std::string& path, Forged kind, std::uint64_t seed);

/// Opens a record, changes it through HDF5 and seals it again.
void change_record(const std::string& path, const std::function<void(hid_t file)>& change);
/// Sets all reals of a dataset to NaN.
void fill_with_nan(hid_t file, const std::string& dataset);
/// Replaces a dataset by zeros. @param deflated compressed by HDF5 to next to nothing on disk
void replace_dataset(hid_t file, const std::string& dataset, hid_t type, std::array<hsize_t, 2> sizes, bool deflated);
/// Adds an attribute to a dataset.
void put_text(hid_t file, const std::string& dataset, const std::string& name, const std::string& text);

// Every object and every attribute of an HDF5 file, each with every change that can be made to it.

/// One change of one object, or of one of its attributes.
struct ObjectForgery {
    std::string object;     ///< path, "/" for the whole file
    std::string attribute;  ///< empty: the object itself
    std::string change;     ///< a name in the list of changes

    /// Makes it, and seals the file again so that only its contents are false.
    void make(const std::string& path) const;
    [[nodiscard]] std::string text() const;
};

/// All forgeries of a file, in the order of its objects.
[[nodiscard]] std::vector<ObjectForgery> forgeries_of(const std::string& path);

}  // namespace cvtflow::tools
