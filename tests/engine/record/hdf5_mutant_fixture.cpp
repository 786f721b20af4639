#include "tests/engine/record/hdf5_mutant_fixture.hpp"

#include <fcntl.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

#include "engine/record/hdf5/file_seal.hpp"

namespace cvtflow::engine {
namespace {

Bytes read_bytes(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const auto* first = reinterpret_cast<const std::byte*>(text.data());
    return {first, first + text.size()};
}

void write_bytes(const std::string& path, const Bytes& bytes) {
    std::filesystem::remove(path);  // file systems write out at once what is cut and written anew
    std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

struct Objects {
    std::vector<std::string> datasets, all;
};

Objects objects_of(hid_t file) {
    Objects objects;
    const auto collect = [](hid_t, const char* name, const H5O_info_t* info, void* client) -> herr_t {
        auto& found = *static_cast<Objects*>(client);
        found.all.emplace_back(name);
        if (info->type == H5O_TYPE_DATASET) found.datasets.emplace_back(name);
        return 0;
    };
    H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, collect, &objects);
    return objects;
}

/// A type of elements that no reader expects.
hid_t odd_type(Dice& dice) {
    const hid_t plain[] = {H5T_IEEE_F32LE,  H5T_IEEE_F64BE,      H5T_STD_I8LE, H5T_STD_U64BE,  H5T_NATIVE_LDOUBLE,
                           H5T_STD_REF_OBJ, H5T_STD_REF_DSETREG, H5T_STD_B8LE, H5T_IEEE_F64LE, H5T_STD_U8LE};
    if (dice.heads()) return H5Tcopy(dice.one_of(plain));
    hid_t type = -1;
    const hsize_t sides[] = {2, 3};
    switch (dice.below(6)) {
        case 0:
            type = H5Tcopy(H5T_C_S1);
            H5Tset_size(type, H5T_VARIABLE);
            return type;
        case 1:
            type = H5Tcopy(H5T_C_S1);
            H5Tset_size(type, 1 + dice.below(100'000));
            return type;
        case 2: return H5Tvlen_create(H5T_IEEE_F64LE);
        case 3: return H5Tarray_create2(H5T_IEEE_F64LE, 2, sides);
        case 4: return H5Tcreate(H5T_OPAQUE, 1 + dice.below(64));
        default:
            type = H5Tcreate(H5T_COMPOUND, 40);
            for (const auto& [name, offset] : {std::pair{"check", 0}, {"time", 9}, {"case", 20}})
                H5Tinsert(type, name, static_cast<std::size_t>(offset), dice.one_of(plain));
            return type;
    }
}

struct Plan {
    std::vector<hsize_t> sizes, most, chunk;
    hid_t type = -1;
    hid_t creation = -1;
};

/// Shape and type of the dataset at a path, from which a forgery departs.
Plan plan_of(hid_t file, const std::string& path) {
    Plan plan;
    const hid_t dataset = H5Dopen2(file, path.c_str(), H5P_DEFAULT), space = H5Dget_space(dataset);
    hsize_t sizes[H5S_MAX_RANK]{}, most[H5S_MAX_RANK]{};
    const int rank = std::max(0, H5Sget_simple_extent_dims(space, sizes, most));
    plan.sizes.assign(sizes, sizes + rank);
    plan.most.assign(most, most + rank);
    plan.chunk.assign(static_cast<std::size_t>(rank), 4);
    plan.type = H5Dget_type(dataset);
    plan.creation = H5Pcreate(H5P_DATASET_CREATE);
    H5Sclose(space);
    H5Dclose(dataset);
    return plan;
}

void put_in_place(hid_t file, const std::string& path, Plan& plan, bool chunked) {
    const int rank = static_cast<int>(plan.sizes.size());
    const hid_t space = rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, plan.sizes.data(), chunked ? plan.most.data() : nullptr);
    if (chunked && rank > 0) H5Pset_chunk(plan.creation, rank, plan.chunk.data());
    H5Ldelete(file, path.c_str(), H5P_DEFAULT);
    const hid_t dataset = H5Dcreate2(file, path.c_str(), plan.type, space, H5P_DEFAULT, plan.creation, H5P_DEFAULT);
    if (dataset >= 0) H5Dclose(dataset);
    if (space >= 0) H5Sclose(space);
    H5Tclose(plan.type);
    H5Pclose(plan.creation);
}

void change_shape(hid_t file, const std::string& path, Mutation what, Dice& dice) {
    Plan plan = plan_of(file, path);
    bool chunked = dice.heads();
    if (what == Mutation::rank) {
        const std::size_t rank = dice.below(6);
        plan.sizes.resize(rank, 1 + dice.below(50));
        if (dice.heads()) std::ranges::reverse(plan.sizes);
    }
    if (what == Mutation::extent && !plan.sizes.empty()) plan.sizes[dice.below(plan.sizes.size())] = dice.extent();
    if (what == Mutation::type) {
        H5Tclose(plan.type);
        plan.type = odd_type(dice);
    }
    plan.most.assign(plan.sizes.size(), H5S_UNLIMITED);
    plan.chunk.assign(plan.sizes.size(), 1 + dice.below(8));
    if (what == Mutation::storage) {
        const std::uint64_t how = dice.below(6);
        chunked = how >= 2;
        if (how == 0) H5Pset_external(plan.creation, "/dev/zero", 0, H5F_UNLIMITED);
        if (how == 1) H5Pset_layout(plan.creation, H5D_VIRTUAL);
        if (how == 2 && !plan.chunk.empty()) plan.chunk[0] = hsize_t{1} << dice.below(32);
        if (how == 3) H5Pset_fletcher32(plan.creation);
        for (int twice = 0; how == 4 && twice < 2; ++twice) H5Pset_deflate(plan.creation, 9);
        if (how == 5) H5Pset_scaleoffset(plan.creation, H5Z_SO_FLOAT_DSCALE, 3);
    }
    put_in_place(file, path, plan, chunked);
}

void change_link(hid_t file, const std::string& path, const std::string& other, Dice& dice) {
    H5Ldelete(file, path.c_str(), H5P_DEFAULT);
    const std::uint64_t how = dice.below(6);
    if (how == 0) H5Lcreate_soft(("/" + path).c_str(), file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    if (how == 1) H5Lcreate_soft(("/" + other).c_str(), file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    if (how == 2) H5Lcreate_external("/dev/zero", "/y", file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    if (how == 3) H5Gclose(H5Gcreate2(file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    if (how == 4) H5Lcreate_hard(file, other.c_str(), file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    if (how == 5) {
        const hid_t type = odd_type(dice);
        H5Tcommit2(file, path.c_str(), type, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        H5Tclose(type);
    }
}

void change_attribute(hid_t file, const std::string& object_name, Dice& dice) {
    const hid_t object = H5Oopen(file, object_name.c_str(), H5P_DEFAULT);
    std::vector<std::string> names{"format", "units", "columns", "index"};
    const auto collect = [](hid_t, const char* name, const H5A_info_t*, void* client) -> herr_t {
        static_cast<std::vector<std::string>*>(client)->emplace_back(name);
        return 0;
    };
    H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names);
    const std::string name = dice.one_of(names);
    H5Adelete(object, name.c_str());
    const hsize_t sizes[] = {dice.below(5), 1 + dice.below(2000)};
    const std::uint64_t how = dice.below(4);
    const hid_t space = how == 0   ? H5Screate(H5S_NULL)
                        : how == 1 ? H5Screate(H5S_SCALAR)
                                   : H5Screate_simple(how == 2 ? 1 : 2, sizes, nullptr);
    const hid_t type = odd_type(dice);
    if (!dice.heads() || how != 1) H5Aclose(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT));
    H5Tclose(type);
    H5Sclose(space);
    H5Oclose(object);
}

/// Groups deep in one another, very many, or in themselves.
void change_group(hid_t file, Dice& dice) {
    const std::vector<std::string> parents{"channels", "tables", "more"};
    const std::string parent = dice.one_of(parents);
    if (H5Lexists(file, parent.c_str(), H5P_DEFAULT) <= 0)
        H5Gclose(H5Gcreate2(file, parent.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    std::string path = parent;
    const std::uint64_t how = dice.below(3);
    for (std::uint64_t i = 0, count = dice.below(200); i < count; ++i) {
        const std::string name = (how == 0 ? path : parent) + "/g" + std::to_string(i);
        if (how == 1)
            H5Lcreate_hard(file, parent.c_str(), file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
        else
            H5Gclose(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
        path = name;
    }
}

void change_structure(const std::string& path, Mutation what, Dice& dice) {
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_file_locking(access, 0, 1);
    H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V110);
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, access);
    H5Pclose(access);
    if (file < 0) return;
    const Objects objects = objects_of(file);
    const std::string dataset = objects.datasets.empty() ? "" : dice.one_of(objects.datasets);
    if (objects.all.empty()) {  // a mutant of a mutant
        H5Fclose(file);
        return;
    }
    if (what == Mutation::attribute)
        change_attribute(file, dice.one_of(objects.all), dice);
    else if (what == Mutation::group)
        change_group(file, dice);
    else if (what == Mutation::link && !dataset.empty())
        change_link(file, dataset, dice.one_of(objects.all), dice);
    else if (!dataset.empty())
        change_shape(file, dataset, what, dice);
    H5Fclose(file);
}

void change_bytes(Bytes& bytes, Mutation what, Dice& dice) {
    if (bytes.empty()) return;
    if (what == Mutation::bits) {
        for (std::uint64_t i = 0, count = 1 + dice.below(3); i < count; ++i)
            bytes[dice.below(bytes.size())] ^= static_cast<std::byte>(1U << dice.below(8));
    } else if (what == Mutation::bytes) {
        const std::size_t begin = dice.below(bytes.size()), count = std::min<std::size_t>(bytes.size() - begin, 1 + dice.below(64));
        const std::uint64_t how = dice.below(3);
        for (std::size_t i = begin; i < begin + count; ++i)
            bytes[i] = how == 0 ? std::byte{0} : how == 1 ? std::byte{0xff} : static_cast<std::byte>(dice.below(256));
    } else {
        bytes.resize(dice.heads() ? dice.below(bytes.size()) : bytes.size() + dice.below(100'000));
    }
}

std::uint64_t little_endian(const Bytes& bytes, std::size_t at, std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i) value |= std::to_integer<std::uint64_t>(bytes[at + i]) << (8 * i);
    return value;
}

/// Where messages of an object header (version 2) begin and end; the checksum follows. Empty if there is none at that place.
std::pair<std::size_t, std::size_t> messages_at(const Bytes& bytes, std::size_t header) {
    const std::uint64_t flags = little_endian(bytes, header + 5, 1);
    const std::size_t width = std::size_t{1} << (flags & 3U);
    const std::size_t begin = header + 6 + ((flags & 0x20U) != 0 ? 16 : 0) + ((flags & 0x10U) != 0 ? 4 : 0) + width;
    const std::uint64_t size = little_endian(bytes, begin - width, width);
    return size > bytes.size() || begin + size + 4 > bytes.size() ? std::pair<std::size_t, std::size_t>{}
                                                                  : std::pair{begin, begin + static_cast<std::size_t>(size)};
}

/// Changes a byte in an object's header, and corrects the header's checksum.
void forge(Bytes& bytes, Dice& dice) {
    constexpr std::byte mark[] = {std::byte{'O'}, std::byte{'H'}, std::byte{'D'}, std::byte{'R'}};
    std::vector<std::size_t> headers;
    for (auto at = bytes.begin(); (at = std::search(at, bytes.end(), std::begin(mark), std::end(mark))) != bytes.end(); ++at)
        headers.push_back(static_cast<std::size_t>(at - bytes.begin()));
    if (headers.empty()) return;
    const std::size_t header = dice.one_of(headers);
    const auto [begin, end] = messages_at(bytes, header);
    if (end <= begin) return;
    for (std::uint64_t i = 0, count = 1 + dice.below(2); i < count; ++i) {
        std::byte& byte = bytes[begin + dice.below(end - begin)];
        byte = dice.heads() ? byte ^ static_cast<std::byte>(1U << dice.below(8)) : static_cast<std::byte>(dice.below(256));
    }
    const std::uint32_t sum = hdf5::metadata_checksum(std::span<const std::byte>(bytes).subspan(header, end - header));
    std::memcpy(bytes.data() + end, &sum, sizeof sum);
}

void renew_seal(const std::string& path, bool had_seal) {
    const int descriptor = open(path.c_str(), O_RDWR | O_CLOEXEC);  // it is there: it was just written
    std::uint64_t length = std::filesystem::file_size(path);
    if (had_seal && length >= seal_size) length -= seal_size;
    static_cast<void>(write_seal(descriptor, length));
    close(descriptor);
}

}  // namespace

Mutation mutate(const std::string& path, std::uint64_t seed, const MutantOptions& options) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    Dice dice(seed);
    const auto what = static_cast<Mutation>(dice.below(mutation_names.size() - (options.forge ? 0 : 1)));
    if (what < Mutation::bits) {
        change_structure(path, what, dice);
        if (options.seal_anew) renew_seal(path, false);  // HDF5 has cut the former one off
        return what;
    }
    Bytes bytes = read_bytes(path);
    if (what == Mutation::forged)
        forge(bytes, dice);
    else
        change_bytes(bytes, what, dice);
    write_bytes(path, bytes);
    if (options.seal_anew) renew_seal(path, what != Mutation::size);
    return what;
}

}  // namespace cvtflow::engine
