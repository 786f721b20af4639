#include "tools/program/view/vtk_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>

#include "engine/record/run/part_file.hpp"
#include "engine/record/run/schema.hpp"
#include "model/basis/portable_math.hpp"
#include "model/observe/chain_forces.hpp"
#include "tools/program/text/markup.hpp"

namespace cvtflow::tools {

namespace {

/// Adds a block, its length and then the numbers, to those behind the head; the head's line of it.
template <class Number>
std::string append(std::string& blocks, std::string_view type, std::string_view name, const std::vector<Number>& numbers,
                   int components = 1) {
    const std::uint64_t offset = blocks.size(), bytes = numbers.size() * sizeof(Number);
    blocks.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
    blocks.append(reinterpret_cast<const char*>(numbers.data()), bytes);
    return fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n", type, name,
                       components, offset);
}

std::string element(const std::string& name, const std::string& inside) { return fmt::format("<{0}>\n{1}</{0}>\n", name, inside); }

using model::End;

constexpr std::array along_half{-1.0, -0.5, 0.0, 0.5, 1.0};  ///< ξ of the points of a half
constexpr std::int64_t points_of_half = along_half.size();
constexpr int sectors = 72;  ///< sectors of a sheave

enum ArrayNumber { axial_force, bending_moment, tension, joint_force, tip_force };

[[nodiscard]] std::size_t place(std::int64_t number) noexcept { return static_cast<std::size_t>(number); }

void put(std::vector<float>& points, const std::array<float, 3>& point) { points.insert(points.end(), point.begin(), point.end()); }

}  // namespace

void VtkMesh::add(VtkCell type, std::span<const std::int64_t> corners, Solid which, int count) {
    connectivity.insert(connectivity.end(), corners.begin(), corners.end());
    offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
    types.push_back(static_cast<std::uint8_t>(type));
    part.push_back(static_cast<std::int32_t>(which));
    number.push_back(count);
}

void VtkMesh::add(VtkCell type, std::int64_t new_points, Solid which, int count) {
    std::vector<std::int64_t> corners(place(new_points));
    std::iota(corners.begin(), corners.end(), static_cast<std::int64_t>(points));
    points += corners.size();
    add(type, corners, which, count);
}

VtkSeries::VtkSeries(const engine::Permit& collection, const VtkMesh& mesh, std::vector<VtkArray> arrays, bool replace)
    : collection_(collection), folder_(collection.path()), replace_(replace), mesh_(mesh), arrays_(std::move(arrays)) {
    folder_.replace_extension();
    growing_ = folder_.string() + ".part";
    for (const std::filesystem::path& folder : {folder_, growing_}) {
        std::error_code failed;
        std::filesystem::create_directory(folder, failed);
        if (std::filesystem::is_symlink(folder)) failed = std::make_error_code(std::errc::too_many_symbolic_link_levels);
        if (failed) throw engine::RecordError(fmt::format("{}: cannot be created: {}", folder.string(), failed.message()));
    }
    for (const std::filesystem::path& folder : {folder_, growing_})
        for (const auto& entry : std::filesystem::directory_iterator(folder))
            if (number_of(entry.path()) >= 0 && !replace)
                throw engine::RecordError(fmt::format("{}: already exists; --force replaces the series there", entry.path().string()));
}

VtkSeries::~VtkSeries() {
    if (finished_) return;
    std::error_code ignored;
    for (long number = 0; number <= count_; ++number) {
        std::filesystem::remove(file(growing_, number), ignored);
        std::filesystem::remove(file(growing_, number).string() + ".part", ignored);
    }
    for (const std::filesystem::path& folder : {folder_, growing_}) std::filesystem::remove(folder, ignored);  // only if it is empty
}

std::filesystem::path VtkSeries::file(const std::filesystem::path& folder, long number) const {
    return folder / fmt::format("{}_{:06}.vtu", folder_.filename().string(), number);
}

long VtkSeries::number_of(const std::filesystem::path& file) const {
    const std::string name = file.filename().string(), begin = folder_.filename().string() + "_", end = ".vtu";
    if (!name.starts_with(begin) || !name.ends_with(end) || name.size() < begin.size() + 6 + end.size()) return -1;
    const char *first = name.data() + begin.size(), *last = name.data() + name.size() - end.size();
    long number = -1;
    const auto [stop, error] = std::from_chars(first, last, number);
    return error == std::errc() && stop == last && number >= 0 ? number : -1;
}

void VtkSeries::add(double time, const VtkFrame& frame) {
    std::string blocks, of_points;
    std::string cells = append(blocks, "Int64", "connectivity", mesh_.connectivity);
    cells += append(blocks, "Int64", "offsets", mesh_.offsets);
    cells += append(blocks, "UInt8", "types", mesh_.types);
    std::string of_cells = append(blocks, "Int32", "part", mesh_.part);
    of_cells += append(blocks, "Int32", "number", mesh_.number);
    const std::string points = append(blocks, "Float32", "Points", frame.points, 3);
    for (std::size_t k = 0; k < arrays_.size(); ++k)
        (arrays_[k].of_points ? of_points : of_cells) += append(blocks, "Float32", arrays_[k].name, frame.values[k], arrays_[k].components);
    std::string file = "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" ";
    file += "header_type=\"UInt64\">\n<UnstructuredGrid>\n";
    file += fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", mesh_.points, mesh_.cells());
    file += element("Points", points) + element("Cells", cells) + element("PointData", of_points) + element("CellData", of_cells);
    file += "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_" + blocks + "\n</AppendedData>\n</VTKFile>\n";
    const std::filesystem::path name = this->file(growing_, count_);
    engine::write_whole({name.string(), {.force = replace_}}, file, false);
    ++count_;
    bytes_ += file.size();
    rows_ +=
        fmt::format("<DataSet timestep=\"{}\" file=\"{}/{}\"/>\n", time, html(folder_.filename().string()), html(name.filename().string()));
}

std::uintmax_t VtkSeries::finish() {
    const std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n" +
                             element("Collection", rows_) + "</VTKFile>\n";
    engine::PartFile collection(collection_);
    collection.require(collection.write(text.data(), text.size()));
    collection.require(collection.sync());
    engine::sync_files_in(growing_.string());  // once for all files: two syncs of each were nine tenths of the time
    finished_ = true;                          // so that what cannot take its name stays
    try {
        for (long number = 0; number < count_; ++number)
            engine::Permit(file(folder_, number).string(), {.force = replace_}).give_name(file(growing_, number).string());
        engine::sync_files_in(folder_.string());
    } catch (...) {
        collection.discard();
        throw;
    }
    std::error_code ignored;
    std::filesystem::remove(growing_, ignored);
    collection.publish();
    engine::remove_own_files(folder_, [this](const std::filesystem::path& there) { return number_of(there) >= count_; });
    return bytes_ + text.size();
}

ChainSolids::ChainSolids(const model::Variator& variator, const model::Parameters& parameters)
    : variator_(variator), parameters_(parameters), observer_(variator) {
    const int links = variator.layout().links, plates = model::plates_per_link(variator.chain()) * links;
    for (int half = 0; half < 2 * links; ++half) mesh_.add(VtkCell::poly_line, points_of_half, Solid::half, half);
    for (int plate = 0; plate < plates; ++plate) mesh_.add(VtkCell::line, 2, Solid::plate, plate);
    if (variator.layout().pulley_size != 0) mesh_sheaves();
}

std::vector<VtkArray> ChainSolids::arrays() {
    return {{"axial_force"}, {"bending_moment"}, {"tension"}, {"joint_force"}, {"tip_force", 3, true}};
}

/// Rings of quads between the innermost and the outermost radius.
void ChainSolids::mesh_sheaves() {
    for (int sheave = 0; sheave < 4; ++sheave) {
        const std::int64_t first = static_cast<std::int64_t>(mesh_.points);
        mesh_.points += 2 * sectors;
        for (std::int64_t sector = 0; sector < sectors; ++sector) {
            const std::int64_t here = first + 2 * sector, next = first + 2 * ((sector + 1) % sectors);
            mesh_.add(VtkCell::quad, std::array{here, here + 1, next + 1, next}, Solid::sheave, sheave);
        }
    }
}

std::array<float, 3> ChainSolids::point_of(const double* link, End end, double position) const {
    const model::ChainLayout at = model::halves_layout(variator_.layout());
    double x = 0.0, y = 0.0;
    for (int m = 0; m < at.lateral(); ++m) {
        x += link[at.x(end, m)] * model::legendre(m, position);
        y += link[at.y(end, m)] * model::legendre(m, position);
    }
    const double z = link[at.z(end)] + position * (variator_.chain().coefficients().half_length + link[at.e(end)]);
    return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
}

void ChainSolids::show(double time, const double* state, const model::Phase* phases, VtkFrame& frame) {
    now_ = &observer_.observe(time, state, phases);
    frame.points.clear();
    frame.values.resize(arrays().size());
    for (std::size_t k = 0; k < frame.values.size(); ++k) {
        const VtkArray array = arrays()[k];
        frame.values[k].assign(static_cast<std::size_t>(array.components) * (array.of_points ? mesh_.points : mesh_.cells()), 0.0F);
    }
    show_links(state, frame);
    if (variator_.layout().pulley_size == 0) return;
    show_sheaves(state, frame);
    show_tips(state, frame);
}

void ChainSolids::show_links(const double* state, VtkFrame& frame) {
    const model::ChainForces& forces = observer_.forces().chain;
    model::halves_of(variator_.chain().coefficients(), state, halves_);
    const model::ChainLayout at = model::halves_layout(variator_.layout());
    const double* links = halves_.data();
    for (int half = 0; half < 2 * at.links; ++half) {
        const End end = half % 2 == 0 ? End::rear : End::front;
        for (const double position : along_half) put(frame.points, point_of(links + at.link_begin(half / 2), end, position));
        const std::size_t cell = place(half), pin = place(end == End::rear ? half / 2 : at.next(half / 2));
        frame.values[axial_force][cell] = static_cast<float>(forces.half_axial[cell]);
        frame.values[bending_moment][cell] = static_cast<float>(std::hypot(forces.bending_travel[cell], forces.bending_height[cell]));
        frame.values[joint_force][cell] = static_cast<float>(forces.joint_normal[pin]);
    }
    const auto& positions = variator_.chain().coefficients().plates.position;
    for (std::size_t plate = 0; plate < forces.plate_tension.size(); ++plate) {
        const int link = static_cast<int>(plate) / forces.plates_per_link;
        const double position = positions[plate % place(forces.plates_per_link)];
        for (const End end : {End::rear, End::front}) put(frame.points, point_of(links + at.link_begin(link), end, position));
        frame.values[tension][place(2 * at.links) + plate] = static_cast<float>(forces.plate_tension[plate]);
    }
}

void ChainSolids::show_sheaves(const double* state, VtkFrame& frame) {
    const model::ChainLayout& at = variator_.layout();
    model::SheaveMotion sheaves[4];
    variator_.pulleys().motions(state + at.pulley_begin(), sheaves);
    std::size_t cell = mesh_.cells() - 4 * sectors;
    for (std::size_t number = 0; number < 4; ++number) {
        const model::SheaveMotion& s = sheaves[number];
        const double side = number % 2 == 0 ? -1.0 : 1.0;
        for (int sector = 0; sector < sectors; ++sector, ++cell) {
            const double angle = now_->angle[number / 2] + 2.0 * std::numbers::pi * sector / sectors;
            for (const double radius : {parameters_.pulley.innermost, parameters_.pulley.outermost}) {
                const double x = radius * std::cos(angle), y = radius * std::sin(angle);
                const double z = side * (radius - parameters_.pulley.arc_position) * std::tan(parameters_.tip.angle);
                put(frame.points, {static_cast<float>(s.x + x + s.tilt_y * z), static_cast<float>(s.y + y - s.tilt_x * z),
                                   static_cast<float>(s.z + z + s.tilt_x * y - s.tilt_y * x)});
            }
            frame.values[axial_force][cell] = static_cast<float>(now_->axial_force[number]);
        }
    }
}

/// Force of every tip on its sheave, at the end of its half.
void ChainSolids::show_tips(const double* state, VtkFrame& frame) {
    const model::ChainForces& forces = observer_.forces().chain;
    const model::ChainLayout& at = variator_.layout();
    for (int tip = 0; tip < model::tips_per_link * at.links; ++tip) {
        const std::size_t n = place(tip);
        const std::int64_t point = points_of_half * (tip / 2) + (tip % 2 == 0 ? 0 : points_of_half - 1);
        const double* link = state + at.link_begin(tip / model::tips_per_link);
        const double x =
            frame.points[place(3 * point)] - variator_.chain().shaft_of(link) * variator_.chain().coefficients().centre_distance;
        const double y = frame.points[place(3 * point + 1)], radius = std::hypot(x, y);
        float* out = &frame.values[tip_force][place(3 * point)];
        out[0] = static_cast<float>((forces.tip_radial[n] * x - forces.tip_tangential[n] * y) / radius);
        out[1] = static_cast<float>((forces.tip_radial[n] * y + forces.tip_tangential[n] * x) / radius);
        out[2] = static_cast<float>(now_->tip_axial[n]);
    }
}

}  // namespace cvtflow::tools
