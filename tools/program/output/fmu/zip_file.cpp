#include "tools/program/output/fmu/zip_file.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <stdexcept>

namespace cvtflow::tools {

namespace {

constexpr std::uint16_t version = 20;                  // of the format: folders
constexpr std::uint16_t first_of_january_1980 = 0x21;  // a file is the same whenever it is made
constexpr std::uint32_t plain_file = 0100644u << 16;
constexpr std::uint16_t from_unix = 3 << 8 | version;

/// CRC-32 of IEEE 802.3, as ZIP wants it.
std::uint32_t crc(const std::string& bytes) {
    static const auto table = [] {
        std::array<std::uint32_t, 256> rows{};
        for (std::uint32_t row = 0; row < 256; ++row) {
            rows[row] = row;
            for (int bit = 0; bit < 8; ++bit) rows[row] = rows[row] >> 1 ^ ((rows[row] & 1u) != 0 ? 0xEDB88320u : 0u);
        }
        return rows;
    }();
    std::uint32_t sum = ~0u;
    for (const char byte : bytes) sum = sum >> 8 ^ table[(sum ^ static_cast<unsigned char>(byte)) & 0xFFu];
    return ~sum;
}

template <class T>
void add(std::string& file, T number) {
    for (std::size_t byte = 0; byte < sizeof number; ++byte) file += static_cast<char>(number >> 8 * byte & 0xFFu);
}

/// What local header and directory have in common: flags, method, time, date, sum, sizes, lengths.
void add_facts(std::string& file, const ZipPart& part) {
    add<std::uint16_t>(file, 0x0800);  // names are UTF-8
    add<std::uint16_t>(file, 0);       // stored
    add<std::uint16_t>(file, 0);
    add(file, first_of_january_1980);
    add(file, crc(part.bytes));
    add(file, static_cast<std::uint32_t>(part.bytes.size()));
    add(file, static_cast<std::uint32_t>(part.bytes.size()));
    add(file, static_cast<std::uint16_t>(part.name.size()));
    add<std::uint16_t>(file, 0);
}

}  // namespace

std::string zip_file(const std::vector<ZipPart>& parts) {
    std::string file, directory;
    for (const ZipPart& part : parts) {
        const auto begin = static_cast<std::uint32_t>(file.size());
        add<std::uint32_t>(file, 0x04034B50);
        add(file, version);
        add_facts(file, part);
        file += part.name + part.bytes;
        if (file.size() > std::numeric_limits<std::uint32_t>::max() / 2) throw std::length_error("zip: more than 2 GiB");
        add<std::uint32_t>(directory, 0x02014B50);
        add(directory, from_unix);
        add(directory, version);
        add_facts(directory, part);
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
