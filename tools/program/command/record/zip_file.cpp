#include "tools/program/command/record/zip_file.hpp"

#include <zlib.h>

#include <cstdint>
#include <limits>
#include <new>
#include <stdexcept>

namespace cvtflow::tools {

namespace {

constexpr std::uint16_t version = 20;                  // of the format: folders
constexpr std::uint16_t first_of_january_1980 = 0x21;  // a file is the same whenever it is made
constexpr std::uint32_t plain_file = 0100644u << 16;
constexpr std::uint16_t from_unix = 3 << 8 | version;

constexpr std::size_t longest_readable = 65535;

/// Without zlib's own header, as ZIP wants it.
std::string deflated(const std::string& bytes) {
    z_stream stream{};
    if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, -MAX_WBITS, MAX_MEM_LEVEL, Z_DEFAULT_STRATEGY) != Z_OK)
        throw std::bad_alloc();
    std::string out(deflateBound(&stream, bytes.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    const int status = deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    if (status != Z_STREAM_END) throw std::runtime_error("zip: zlib cannot compress");
    return out;
}

/// A part as it is in the file.
struct Packed {
    const ZipPart& part;
    bool compressed;
    std::string bytes = compressed ? deflated(part.bytes) : part.bytes;
    std::uint32_t sum =
        static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(part.bytes.data()), static_cast<uInt>(part.bytes.size())));
};

template <class T>
void add(std::string& file, T number) {
    for (std::size_t byte = 0; byte < sizeof number; ++byte) file += static_cast<char>(number >> 8 * byte & 0xFFu);
}

/// Facts that local header and directory have in common: flags, method, time, date, sum, sizes, lengths.
void add_facts(std::string& file, const Packed& packed) {
    add<std::uint16_t>(file, 0x0800);  // names are UTF-8
    add<std::uint16_t>(file, packed.compressed ? Z_DEFLATED : 0);
    add<std::uint16_t>(file, 0);
    add(file, first_of_january_1980);
    add(file, packed.sum);
    add(file, static_cast<std::uint32_t>(packed.bytes.size()));
    add(file, static_cast<std::uint32_t>(packed.part.bytes.size()));
    add(file, static_cast<std::uint16_t>(packed.part.name.size()));
    add<std::uint16_t>(file, 0);
}

}  // namespace

std::string zip_file(const std::vector<ZipPart>& parts) {
    std::string file, directory;
    for (const ZipPart& part : parts) {
        if (part.bytes.size() > std::numeric_limits<std::uint32_t>::max() / 2) throw std::length_error("zip: a part of more than 2 GiB");
        const Packed packed{part, !file.empty() || part.bytes.size() > longest_readable};
        const auto begin = static_cast<std::uint32_t>(file.size());
        add<std::uint32_t>(file, 0x04034B50);
        add(file, version);
        add_facts(file, packed);
        file += part.name + packed.bytes;
        if (file.size() > std::numeric_limits<std::uint32_t>::max() / 2) throw std::length_error("zip: more than 2 GiB");
        add<std::uint32_t>(directory, 0x02014B50);
        add(directory, from_unix);
        add(directory, version);
        add_facts(directory, packed);
        add<std::uint16_t>(directory, 0);
        add<std::uint16_t>(directory, 0);
        add<std::uint16_t>(directory, 0);
        add(directory, plain_file);
        add(directory, begin);
        directory += part.name;
    }
    const auto place = static_cast<std::uint32_t>(file.size());
    file += directory;
    add<std::uint32_t>(file, 0x06054B50);
    add<std::uint32_t>(file, 0);
    add(file, static_cast<std::uint16_t>(parts.size()));
    add(file, static_cast<std::uint16_t>(parts.size()));
    add(file, static_cast<std::uint32_t>(directory.size()));
    add(file, place);
    add<std::uint16_t>(file, 0);
    return file;
}

}  // namespace cvtflow::tools
