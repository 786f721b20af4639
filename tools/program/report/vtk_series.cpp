#include "tools/program/report/vtk_series.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstring>

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

VtkSeries::VtkSeries(const engine::Permit& collection, const VtkMesh& mesh, std::vector<VtkArray> arrays, bool replace)
    : collection_(collection), folder_(collection.path()), replace_(replace), mesh_(mesh), arrays_(std::move(arrays)) {
    folder_.replace_extension();
    std::error_code failed;
    std::filesystem::create_directory(folder_, failed);
    if (failed) throw engine::RecordError(fmt::format("{}: cannot be created: {}", folder_.string(), failed.message()));
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
        if (number_of(entry.path()) >= 0 && !replace)
            throw engine::RecordError(fmt::format("{}: already exists; --force replaces the series there", entry.path().string()));
    }
}

VtkSeries::~VtkSeries() {
    if (finished_) return;
    std::error_code ignored;
    for (long number = 0; number < count_; ++number) std::filesystem::remove(file(number), ignored);
    std::filesystem::remove(folder_, ignored);  // only if it is empty
}

std::filesystem::path VtkSeries::file(long number) const {
    return folder_ / fmt::format("{}_{:06}.vtu", folder_.filename().string(), number);
}

long VtkSeries::number_of(const std::filesystem::path& file) const {
    const std::string name = file.filename().string(), begin = folder_.filename().string() + "_", end = ".vtu";
    if (!name.starts_with(begin) || !name.ends_with(end) || name.size() < begin.size() + 6 + end.size()) return -1;
    const char *first = name.data() + begin.size(), *last = name.data() + name.size() - end.size();
    long number = -1;
    const auto [stop, error] = std::from_chars(first, last, number);
    return error == std::errc() && stop == last && number >= 0 ? number : -1;
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
    const std::filesystem::path name = this->file(count_);
    engine::write_whole({name.string(), {.force = replace_}}, file);
    ++count_;
    bytes_ += file.size();
    rows_ += fmt::format("<DataSet timestep=\"{}\" file=\"{}/{}\"/>\n", time, folder_.filename().string(), name.filename().string());
}

std::uintmax_t VtkSeries::finish() {
    const std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n" +
                             element("Collection", rows_) + "</VTKFile>\n";
    engine::write_whole(collection_, text);
    finished_ = true;
    engine::remove_own_files(folder_, [this](const std::filesystem::path& there) { return number_of(there) >= count_; });
    return bytes_ + text.size();
}

}  // namespace cvtflow::tools
