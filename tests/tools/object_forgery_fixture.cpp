#include "tests/tools/object_forgery_fixture.hpp"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "tests/tools/forgery_fixture.hpp"

namespace cvtflow::tools {

namespace {

constexpr hsize_t bomb_rows = hsize_t{1} << 24;  // of zeros, deflated to some kilobytes

std::string parent_of(const std::string& path) {
    const auto slash = path.rfind('/');
    return slash == std::string::npos ? "" : path.substr(0, slash + 1);
}

void remove(hid_t file, const std::string& path) { H5Ldelete(file, path.c_str(), H5P_DEFAULT); }

/// A dataset of zeros in the place of another object.
void put_dataset(hid_t file, const std::string& path, hid_t type, const std::vector<hsize_t>& sizes) {
    remove(file, path);
    const int rank = static_cast<int>(sizes.size());
    const hid_t space = rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, sizes.data(), nullptr);
    const hid_t dataset = H5Dcreate2(file, path.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (dataset >= 0) H5Dclose(dataset);
    H5Sclose(space);
}

struct Shape {
    std::vector<hsize_t> sizes;
    hid_t type = -1;
};

Shape shape_of(hid_t file, const std::string& path) {
    const hid_t dataset = H5Dopen2(file, path.c_str(), H5P_DEFAULT), space = H5Dget_space(dataset);
    hsize_t sizes[H5S_MAX_RANK]{};
    const int rank = std::max(0, H5Sget_simple_extent_dims(space, sizes, nullptr));
    const Shape shape{{sizes, sizes + rank}, H5Dget_type(dataset)};
    H5Sclose(space);
    H5Dclose(dataset);
    return shape;
}

/// A dataset of the same type in another shape.
template <class Change>
void reshape(hid_t file, const std::string& path, const Change& change) {
    Shape shape = shape_of(file, path);
    change(shape.sizes);
    put_dataset(file, path, shape.type, shape.sizes);
    H5Tclose(shape.type);
}

template <class Change>
void change_numbers(hid_t file, const std::string& path, const Change& change) {
    const hid_t dataset = H5Dopen2(file, path.c_str(), H5P_DEFAULT), space = H5Dget_space(dataset), type = H5Dget_type(dataset);
    std::vector<double> values(static_cast<std::size_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space))));
    if (H5Tget_class(type) == H5T_FLOAT || H5Tget_class(type) == H5T_INTEGER) {
        H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
        change(values);
        H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    }
    H5Tclose(type);
    H5Sclose(space);
    H5Dclose(dataset);
}

/// The object under another name, or under very many.
void link_again(hid_t file, const std::string& path, const std::string& name) {
    H5Lcreate_hard(file, path.c_str(), file, (parent_of(path) + name).c_str(), H5P_DEFAULT, H5P_DEFAULT);
}

using ObjectChange = void (*)(hid_t file, const std::string& path);

const std::map<std::string, ObjectChange>& link_changes() {
    static const std::map<std::string, ObjectChange> changes{
        {"missing", [](hid_t file, const std::string& path) { remove(file, path); }},
        {"linked to itself",
         [](hid_t file, const std::string& path) {
             remove(file, path);
             H5Lcreate_soft(("/" + path).c_str(), file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT);
         }},
        {"linked to the root",
         [](hid_t file, const std::string& path) {
             remove(file, path);
             H5Lcreate_hard(file, "/", file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT);
         }},
        {"linked to another file",
         [](hid_t file, const std::string& path) {
             remove(file, path);
             H5Lcreate_external("../victim.txt", "/y", file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT);
         }},
        {"with a name of markup",
         [](hid_t file, const std::string& path) {
             link_again(file, path, "A<img src=x onerror=\"window.ran=1\">");
             remove(file, path);
         }},
        {"with a name of escapes", [](hid_t file, const std::string& path) { link_again(file, path, "\x1b]0;title\x07 =1+1"); }},
        {"with a name of 60,000 bytes", [](hid_t file, const std::string& path) { link_again(file, path, std::string(60'000, 'n')); }},
        {"under 3,000 names",
         [](hid_t file, const std::string& path) {
             for (int k = 0; k < 3000; ++k) link_again(file, path, "many" + std::to_string(k));
         }},
        {"a group",
         [](hid_t file, const std::string& path) {
             remove(file, path);
             H5Gclose(H5Gcreate2(file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
         }},
        {"a number", [](hid_t file, const std::string& path) { put_dataset(file, path, H5T_NATIVE_DOUBLE, {}); }},
    };
    return changes;
}

void put_text_type(hid_t file, const std::string& path, std::size_t size) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, size);
    put_dataset(file, path, type, shape_of(file, path).sizes);
    H5Tclose(type);
}

const std::map<std::string, ObjectChange>& dataset_changes() {
    using Sizes = std::vector<hsize_t>;
    using Values = std::vector<double>;
    static constexpr double inf = std::numeric_limits<double>::infinity(), huge = std::numeric_limits<double>::max();
    static const std::map<std::string, ObjectChange> changes{
        {"of no rows",
         [](hid_t file, const std::string& path) { reshape(file, path, [](Sizes& s) { s.empty() ? void() : void(s[0] = 0); }); }},
        {"of one row",
         [](hid_t file, const std::string& path) { reshape(file, path, [](Sizes& s) { s.empty() ? void() : void(s[0] = 1); }); }},
        {"of twice the rows",
         [](hid_t file, const std::string& path) { reshape(file, path, [](Sizes& s) { s.empty() ? void() : void(s[0] *= 2); }); }},
        {"of another rank", [](hid_t file, const std::string& path) { reshape(file, path, [](Sizes& s) { s.push_back(3); }); }},
        {"of rank 0", [](hid_t file, const std::string& path) { reshape(file, path, [](Sizes& s) { s.clear(); }); }},
        {"of wider rows",
         [](hid_t file, const std::string& path) { reshape(file, path, [](Sizes& s) { s.empty() ? void() : void(s.back() += 7); }); }},
        {"of bytes", [](hid_t file, const std::string& path) { put_dataset(file, path, H5T_STD_U8LE, shape_of(file, path).sizes); }},
        {"of long integers",
         [](hid_t file, const std::string& path) { put_dataset(file, path, H5T_STD_I64BE, shape_of(file, path).sizes); }},
        {"of short texts", [](hid_t file, const std::string& path) { put_text_type(file, path, 3); }},
        {"of long texts", [](hid_t file, const std::string& path) { put_text_type(file, path, 50'000); }},
        {"of texts of any length", [](hid_t file, const std::string& path) { put_text_type(file, path, H5T_VARIABLE); }},
        {"swollen",
         [](hid_t file, const std::string& path) {
             replace_dataset(file, path, H5T_NATIVE_DOUBLE, {bomb_rows, 1}, true);
         }},
        {"not a number",
         [](hid_t f, const std::string& path) { change_numbers(f, path, [](Values& v) { std::ranges::fill(v, std::nan("")); }); }},
        {"infinite",
         [](hid_t f, const std::string& path) { change_numbers(f, path, [](Values& v) { v.empty() ? void() : void(v.back() = -inf); }); }},
        {"huge", [](hid_t f, const std::string& path) { change_numbers(f, path, [](Values& v) { std::ranges::fill(v, huge); }); }},
        {"negative", [](hid_t f, const std::string& path) { change_numbers(f, path, [](Values& v) { std::ranges::fill(v, -7.0); }); }},
        {"backwards", [](hid_t f, const std::string& path) { change_numbers(f, path, [](Values& v) { std::ranges::reverse(v); }); }},
    };
    return changes;
}

/// An attribute of another type or shape, of zeros.
void put_attribute(hid_t object, const std::string& name, hid_t type, hid_t space) {
    H5Adelete(object, name.c_str());
    const hid_t attribute = H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT);
    if (attribute >= 0) H5Aclose(attribute);
    H5Sclose(space);
}

constexpr std::array attribute_changes{"missing",       "of markup", "of escapes",        "of 60,000 bytes", "empty", "a path",
                                       "not UTF-8",     "a number",  "an array of 2,000", "of no extent",    "NaN",   "of any length",
                                       "a huge number", "-1",        "text of a number"};

void change_attribute(hid_t file, const ObjectForgery& forgery) {
    const std::string& name = forgery.attribute;
    const hid_t object = H5Oopen(file, forgery.object.c_str(), H5P_DEFAULT);
    const auto text = [&](const std::string& value) { put_text(file, forgery.object, name, value); };
    const hsize_t many[] = {2000};
    const std::string& change = forgery.change;
    if (change == "missing") H5Adelete(object, name.c_str());
    if (change == "of markup") text(hostile_text(1));
    if (change == "of escapes") text(hostile_text(3));
    if (change == "of 60,000 bytes") text(std::string(60'000, 'x'));
    if (change == "empty") text("");
    if (change == "a path") text("../victim.txt");
    if (change == "not UTF-8") text(hostile_text(11));
    if (change == "NaN") text("nan");
    if (change == "a huge number") text("1e300");
    if (change == "-1") text("-1");
    if (change == "text of a number") text("0.5");
    if (change == "a number") put_attribute(object, name, H5T_NATIVE_DOUBLE, H5Screate(H5S_SCALAR));
    if (change == "an array of 2,000") put_attribute(object, name, H5T_NATIVE_DOUBLE, H5Screate_simple(1, many, nullptr));
    if (change == "of no extent") put_attribute(object, name, H5T_NATIVE_DOUBLE, H5Screate(H5S_NULL));
    if (change == "of any length") {
        const hid_t type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, H5T_VARIABLE);
        put_attribute(object, name, type, H5Screate(H5S_SCALAR));
        H5Tclose(type);
    }
    H5Oclose(object);
}

struct Collected {
    hid_t file;
    std::vector<ObjectForgery> forgeries;
};

void collect_attributes(Collected& all, const std::string& path) {
    std::vector<std::string> names;
    const auto name_of = [](hid_t, const char* name, const H5A_info_t*, void* client) -> herr_t {
        static_cast<std::vector<std::string>*>(client)->emplace_back(name);
        return 0;
    };
    const hid_t object = H5Oopen(all.file, path.c_str(), H5P_DEFAULT);
    H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, name_of, &names);
    H5Oclose(object);
    for (const std::string& name : names)
        for (const char* change : attribute_changes) all.forgeries.push_back({path, name, change});
}

herr_t collect_object(hid_t, const char* name, const H5O_info_t* info, void* client) {
    Collected& all = *static_cast<Collected*>(client);
    const std::string path = std::string(name) == "." ? "/" : name;
    if (path != "/")
        for (const auto& [change, make] : link_changes()) all.forgeries.push_back({path, "", change});
    if (info->type == H5O_TYPE_DATASET)
        for (const auto& [change, make] : dataset_changes()) all.forgeries.push_back({path, "", change});
    collect_attributes(all, path);
    return 0;
}

}  // namespace

void ObjectForgery::make(const std::string& path) const {
    change_record(path, [&](hid_t file) {
        if (!attribute.empty()) return change_attribute(file, *this);
        const auto& links = link_changes();
        (links.contains(change) ? links : dataset_changes()).at(change)(file, object);
    });
}

std::string ObjectForgery::text() const { return object + (attribute.empty() ? "" : ", attribute " + attribute) + ": " + change; }

std::vector<ObjectForgery> forgeries_of(const std::string& path) {
    Collected all{H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), {}};
    H5Ovisit(all.file, H5_INDEX_NAME, H5_ITER_INC, collect_object, &all);
    H5Fclose(all.file);
    return all.forgeries;
}

}  // namespace cvtflow::tools
