#include "tests/tools/forgery_fixture.hpp"

#include <fcntl.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <vector>

#include "engine/record/case_table.hpp"
#include "engine/record/hdf5/file_seal.hpp"
#include "engine/record/run/state_file.hpp"
#include "tests/engine/record/hdf5_mutant_fixture.hpp"

namespace cvtflow::tools {

namespace {

using engine::Dice;

double odd_number(Dice& dice) {
    constexpr double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    const double choices[] = {nan, inf, -inf, 1.7e308, -1.7e308, 5e-324, -0.0, 9.3e18, -1.0, 1e15};
    return dice.one_of(choices);
}

/// A few of them, or all.
void spoil(std::vector<double>& values, Dice& dice) {
    const double odd = odd_number(dice);
    const std::size_t stride = dice.heads() ? 1 : 1 + dice.below(std::max<std::size_t>(1, values.size()));
    for (std::size_t k = 0; k < values.size(); k += stride) values[k] = odd;
}

void seal_anew(const std::string& path) {
    const int descriptor = open(path.c_str(), O_RDWR | O_CLOEXEC);
    static_cast<void>(engine::write_seal(descriptor, std::filesystem::file_size(path)));
    close(descriptor);
}

struct Names {
    std::vector<std::string> datasets;
};

Names names_in(hid_t file) {
    Names names;
    const auto collect = [](hid_t, const char* name, const H5O_info_t* info, void* client) -> herr_t {
        if (info->type == H5O_TYPE_DATASET) static_cast<Names*>(client)->datasets.emplace_back(name);
        return 0;
    };
    H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, collect, &names);
    return names;
}

void set_text(hid_t object, const std::string& name, const std::string& text) {
    const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(type, std::max<std::size_t>(1, text.size()));
    if (H5Aexists(object, name.c_str()) > 0) H5Adelete(object, name.c_str());
    const hid_t attribute = H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, type, text.c_str());
    H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
}

/// The numbers of a dataset, in all that can be converted.
void forge_numbers(hid_t file, const std::string& path, Dice& dice) {
    const hid_t dataset = H5Dopen2(file, path.c_str(), H5P_DEFAULT), space = H5Dget_space(dataset), type = H5Dget_type(dataset);
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    if (H5Tget_class(type) != H5T_COMPOUND && count > 0) {
        std::vector<double> values(static_cast<std::size_t>(count));
        H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
        const std::uint64_t how = dice.below(3);
        if (how == 0) std::ranges::reverse(values);
        if (how != 0) spoil(values, dice);
        H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    }
    H5Tclose(type);
    H5Sclose(space);
    H5Dclose(dataset);
}

/// Very many rows that take no room on disk: deflated zeros, or chunks that were never written.
void swell(hid_t file, const std::string& path, Dice& dice) {
    const hid_t former = H5Dopen2(file, path.c_str(), H5P_DEFAULT), type = H5Dget_type(former);
    H5Dclose(former);
    const bool compound = H5Tget_class(type) == H5T_COMPOUND;
    const hsize_t sizes[] = {hsize_t{1} << (10 + dice.below(15)), 1 + dice.below(100)};
    const hsize_t chunk[] = {std::min<hsize_t>(sizes[0], 65536), sizes[1]};
    const int rank = compound ? 1 : 2;
    const hid_t space = H5Screate_simple(rank, sizes, nullptr), creation = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(creation, rank, chunk);
    H5Pset_deflate(creation, 9);
    H5Ldelete(file, path.c_str(), H5P_DEFAULT);
    const hid_t dataset = H5Dcreate2(file, path.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    if (dataset >= 0 && !compound && dice.heads() && sizes[0] * sizes[1] < (1U << 23U)) {
        const std::vector<double> zeros(sizes[0] * sizes[1]);
        H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros.data());
    }
    if (dataset >= 0) H5Dclose(dataset);
    H5Pclose(creation);
    H5Sclose(space);
    H5Tclose(type);
}

/// A dataset under another name, or under many.
void rename(hid_t file, const std::string& path, Dice& dice) {
    const std::string group = path.find('/') == std::string::npos ? "" : path.substr(0, path.find('/') + 1);
    const bool many = dice.heads();
    for (std::uint64_t k = 0, count = many ? dice.below(3000) : 1; k < count; ++k) {
        std::string name = many ? "many" + std::to_string(k) : hostile_text(dice.below(100));
        std::replace(name.begin(), name.end(), '/', '|');
        H5Lcreate_hard(file, path.c_str(), file, (group + name).c_str(), H5P_DEFAULT, H5P_DEFAULT);
    }
    if (dice.heads()) H5Ldelete(file, path.c_str(), H5P_DEFAULT);
}

std::string forge_attribute(hid_t file, const std::string& dataset, Dice& dice) {
    const char* of_file[] = {"scene", "scene_text", "parameters", "method", "step", "seed", "status", "run", "notes", "cpu", "date"};
    const char* of_data[] = {"units", "description", "axis", "index"};
    const bool whole = dice.heads() || dataset.empty();
    const std::string name = whole ? dice.one_of(of_file) : dice.one_of(of_data);
    const hid_t object = whole ? file : H5Dopen2(file, dataset.c_str(), H5P_DEFAULT);
    const std::uint64_t how = dice.below(4);
    if (how == 0 && H5Aexists(object, name.c_str()) > 0) H5Adelete(object, name.c_str());
    if (how == 1) set_text(object, name, std::string(dice.below(60'000), 'x'));
    if (how >= 2) set_text(object, name, hostile_text(dice.below(100)));
    if (!whole) H5Dclose(object);
    return "attribute " + name;
}

std::string forge_record(const std::string& path, Dice& dice) {
    std::string done;
    change_record(path, [&](hid_t file) {
        const Names names = names_in(file);
        const std::string dataset = dice.one_of(names.datasets);
        const std::uint64_t how = dice.below(5);
        done = "numbers of " + dataset;
        if (how <= 1) forge_numbers(file, dataset, dice);
        if (how == 2) swell(file, dataset, dice), done = "swollen " + dataset;
        if (how == 3) rename(file, dataset, dice), done = "renamed " + dataset;
        if (how == 4) done = forge_attribute(file, dataset, dice);
    });
    return done;
}

std::string forge_state(const std::string& path, Dice& dice) {
    engine::SavedState saved = engine::read_state(path);
    const std::uint64_t how = dice.below(6);
    std::vector<std::vector<double>*> arrays{&saved.state};
    for (engine::NamedArray& each : saved.more) arrays.push_back(&each.values);
    std::vector<double>& values = *arrays[dice.below(arrays.size())];
    if (how <= 1) spoil(values, dice);
    if (how == 2) values.resize(dice.below(2 * values.size() + 3), odd_number(dice));
    if (how == 3 && !saved.phases.empty())
        dice.heads() ? saved.phases.resize(dice.below(1000)) : saved.phases.assign(saved.phases.size(), 200);
    if (how == 4 && !saved.attributes.empty())
        saved.attributes[dice.below(saved.attributes.size())].value =
            dice.heads() ? hostile_text(dice.below(100)) : std::string(50'000, 'x');
    if (how == 5 && !saved.more.empty()) saved.more.erase(saved.more.begin() + static_cast<std::ptrdiff_t>(dice.below(saved.more.size())));
    if (how == 5 && saved.more.empty()) saved.time = odd_number(dice);
    engine::write_state(path, saved);
    return "state, " + std::to_string(how);
}

std::string forge_table(const std::string& path, Dice& dice) {
    engine::CaseTable table = engine::read_cases(path);
    const std::uint64_t how = dice.below(3);
    if (how == 0 && !table.attributes.empty()) table.attributes[dice.below(table.attributes.size())].value = hostile_text(dice.below(100));
    const std::size_t bytes = table.layout.bytes(), columns = table.layout.columns().size();
    if (how == 1) table.rows.resize(dice.below(4) * table.rows.size());
    for (std::size_t row = 0; row < table.size(); ++row) {
        const std::span<std::byte> cells = std::span(table.rows).subspan(row * bytes, bytes);
        const std::size_t column = dice.below(columns);
        const auto type = table.layout.columns()[column].type;
        if (type == engine::ColumnType::real) table.layout.put(cells, column, odd_number(dice));
        if (type == engine::ColumnType::integer) table.layout.put(cells, column, static_cast<std::int64_t>(dice.extent()));
        if (type == engine::ColumnType::text) table.layout.put(cells, column, std::string_view(hostile_text(dice.below(100))));
        table.layout.seal(cells);
    }
    engine::write_cases({path, {.force = true}}, table);
    return "table, " + std::to_string(how);
}

}  // namespace

void change_record(const std::string& path, const std::function<void(hid_t file)>& change) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_file_locking(access, 0, 1);
    H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V110);
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, access);
    H5Pclose(access);
    change(file);
    H5Fclose(file);
    seal_anew(path);
}

void fill_with_nan(hid_t file, const std::string& dataset) {
    const hid_t opened = H5Dopen2(file, dataset.c_str(), H5P_DEFAULT), space = H5Dget_space(opened);
    const std::vector<double> none(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)), std::nan(""));
    H5Dwrite(opened, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, none.data());
    H5Sclose(space);
    H5Dclose(opened);
}

void replace_dataset(hid_t file, const std::string& dataset, hid_t type, std::array<hsize_t, 2> sizes, bool deflated) {
    const hsize_t chunk[] = {std::min<hsize_t>(sizes[0], 1U << 20U), sizes[1]};
    const hid_t space = H5Screate_simple(2, sizes.data(), nullptr), creation = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(creation, 2, chunk);
    if (deflated) H5Pset_deflate(creation, 9);
    H5Ldelete(file, dataset.c_str(), H5P_DEFAULT);
    const hid_t made = H5Dcreate2(file, dataset.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    const std::vector<double> zeros(sizes[0] * sizes[1]);
    H5Dwrite(made, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros.data());
    H5Dclose(made);
    H5Pclose(creation);
    H5Sclose(space);
}

void put_text(hid_t file, const std::string& dataset, const std::string& name, const std::string& text) {
    const hid_t object = H5Oopen(file, dataset.c_str(), H5P_DEFAULT);
    set_text(object, name, text);
    H5Oclose(object);
}

std::string hostile_text(std::uint64_t number) {
    const std::string texts[] = {"A<img src=x onerror=\"window.ran=1\">",
                                 "</script><script>window.ran=1</script>",
                                 "\"onmouseover=\"window.ran=1\" x=\"",
                                 "\x1b]0;title\x07\x1b[31mred",
                                 "=cmd|' /C calc'!A1",
                                 "../../outside",
                                 "%s%n%s%n",
                                 "line\nbreak\ttab",
                                 std::string("\xc2\x9b") + "2J",
                                 "javascript:window.ran=1",
                                 "",
                                 "\xff\xfe\xc0\x80 not UTF-8"};
    return texts[number % std::size(texts)];
}

std::string forge(const std::string& path, Forged kind, std::uint64_t seed) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    Dice dice(seed);
    if (dice.below(3) == 0) {
        const auto what = engine::mutate(path, seed, {.seal_anew = true, .forge = false});
        return std::string(engine::mutation_names[static_cast<std::size_t>(what)]);
    }
    if (kind == Forged::record) return forge_record(path, dice);
    return kind == Forged::state ? forge_state(path, dice) : forge_table(path, dice);
}

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
