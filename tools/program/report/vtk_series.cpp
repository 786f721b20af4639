#include "tools/program/report/vtk_series.hpp"

#include <fmt/format.h>

#include <cstring>

#include "engine/record/run/part_file.hpp"
#include "engine/record/run/schema.hpp"

namespace cvtflow::tools {

namespace {

/// Places of blocks behind the head: 8 bytes of length, then the numbers.
class Offsets {
public:
    std::size_t next(std::size_t bytes) noexcept {
        const std::size_t here = end_;
        end_ += sizeof(std::uint64_t) + bytes;
        return here;
    }

private:
    std::size_t end_ = 0;
};

std::string array_text(std::string_view type, std::string_view name, int components, std::size_t offset) {
    return fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n", type, name,
                       components, offset);
}

/// A block: its length, then the numbers.
template <class Number>
void append(std::string& file, const std::vector<Number>& numbers) {
    const std::uint64_t bytes = numbers.size() * sizeof(Number);
    file.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
    file.append(reinterpret_cast<const char*>(numbers.data()), bytes);
}

std::string element(const std::string& name, const std::string& inside) { return fmt::format("<{0}>\n{1}</{0}>\n", name, inside); }

}  // namespace

void VtkMesh::add(VtkCell type, std::span<const std::int64_t> corners, std::int32_t which, std::int32_t count) {
    connectivity.insert(connectivity.end(), corners.begin(), corners.end());
    offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
    types.push_back(static_cast<std::uint8_t>(type));
    part.push_back(which);
    number.push_back(count);
}

VtkSeries::VtkSeries(std::filesystem::path collection, const VtkMesh& mesh, std::vector<VtkArray> arrays, bool replace)
    : collection_(std::move(collection)), folder_(collection_), mesh_(mesh), arrays_(std::move(arrays)) {
    folder_.replace_extension();
    engine::require_replaceable(collection_.string());
    std::error_code failed;
    const bool filled = std::filesystem::exists(folder_) && !std::filesystem::is_empty(folder_, failed);
    if (filled && !replace) throw engine::RecordError(folder_.string() + ": already exists; --force replaces it");
    std::filesystem::create_directory(folder_, failed);
    if (failed) throw engine::RecordError(fmt::format("{}: cannot be created: {}", folder_.string(), failed.message()));
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
        if (entry.path().extension() == ".vtu") std::filesystem::remove(entry.path(), failed);
    }
}

std::size_t VtkSeries::length(const VtkArray& array) const noexcept {
    return sizeof(float) * static_cast<std::size_t>(array.components) * (array.of_points ? mesh_.points : mesh_.cells());
}

/// The order of offsets is that in which blocks are written.
std::string VtkSeries::head() const {
    Offsets offsets;
    const std::size_t count = mesh_.cells();
    std::string cells = array_text("Int64", "connectivity", 1, offsets.next(sizeof(std::int64_t) * mesh_.connectivity.size()));
    cells += array_text("Int64", "offsets", 1, offsets.next(sizeof(std::int64_t) * count));
    cells += array_text("UInt8", "types", 1, offsets.next(count));
    std::string of_cells = array_text("Int32", "part", 1, offsets.next(sizeof(std::int32_t) * count));
    of_cells += array_text("Int32", "number", 1, offsets.next(sizeof(std::int32_t) * count));
    const std::string points = array_text("Float32", "Points", 3, offsets.next(3 * sizeof(float) * mesh_.points));
    std::string of_points;
    for (const VtkArray& array : arrays_)
        (array.of_points ? of_points : of_cells) += array_text("Float32", array.name, array.components, offsets.next(length(array)));
    std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" ";
    text += "header_type=\"UInt64\">\n<UnstructuredGrid>\n";
    text += fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", mesh_.points, count);
    text += element("Points", points) + element("Cells", cells) + element("PointData", of_points) + element("CellData", of_cells);
    return text + "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
}

void VtkSeries::write(const std::filesystem::path& path, const std::string& bytes) {
    engine::PartFile file(path.string(), true);
    if (const int error = file.write(bytes.data(), bytes.size()); error != 0) {
        file.discard();
        throw engine::RecordError(fmt::format("{}: cannot write: {}", path.string(), std::strerror(error)));
    }
    file.publish();
    bytes_ += bytes.size();
}

void VtkSeries::add(double time, const VtkFrame& frame) {
    std::string file = head();
    append(file, mesh_.connectivity);
    append(file, mesh_.offsets);
    append(file, mesh_.types);
    append(file, mesh_.part);
    append(file, mesh_.number);
    append(file, frame.points);
    for (const auto& values : frame.values) append(file, values);
    file += "\n</AppendedData>\n</VTKFile>\n";
    const std::string name = fmt::format("{}_{:06}.vtu", folder_.filename().string(), count_++);
    write(folder_ / name, file);
    rows_ += fmt::format("<DataSet timestep=\"{}\" file=\"{}/{}\"/>\n", time, folder_.filename().string(), name);
}

std::uintmax_t VtkSeries::finish() {
    write(collection_, "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n" +
                           element("Collection", rows_) + "</VTKFile>\n");
    return bytes_;
}

}  // namespace cvtflow::tools
