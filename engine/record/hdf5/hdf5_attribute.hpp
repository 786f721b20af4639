#pragma once
/// Internal to engine/record: attributes of HDF5 objects. Texts are UTF-8 of fixed length, padded with zeros; h5py reads them as bytes.

#include <string>
#include <string_view>
#include <vector>

#include "engine/record/hdf5/hdf5_handle.hpp"

namespace cvtflow::engine::hdf5 {

/// Datatype of a text: UTF-8, as many bytes, at least one.
[[nodiscard]] Handle text_type(std::size_t width);

/// Creates or replaces an attribute. Throws Failure.
void write_attribute(hid_t object, const Attribute& attribute);
/// Same, for a list of texts. Throws Failure.
void write_texts(hid_t object, const std::string& name, const std::vector<std::string>& texts);

[[nodiscard]] bool has_attribute(hid_t object, const std::string& name);
/// All scalar attributes that are text of fixed length, integer or real, by name; others (such as those of dimension scales) are passed
/// over.
[[nodiscard]] std::vector<Attribute> read_attributes(hid_t object);
/// A scalar text, or "" if absent or of another kind.
[[nodiscard]] std::string read_text(hid_t object, const std::string& name);
/// A scalar number, or the fallback.
[[nodiscard]] std::int64_t read_integer(hid_t object, const std::string& name, std::int64_t fallback);
/// A list of texts, empty if absent or of another kind.
[[nodiscard]] std::vector<std::string> read_texts(hid_t object, const std::string& name);

}  // namespace cvtflow::engine::hdf5
