#pragma once
/// The running variator for ParaView and VTK: pin halves, plates and sheaves as a mesh that moves, with the forces on them, in a collection
/// (.pvd) of one XML UnstructuredGrid (.vtu) per time, raw binary data.
///
/// Not VTKHDF, whose time series are newer (VTK 9.3) than the readers that distributions have, and no series inside one .vtu: VTK 9.1 adds
/// the cells of all times up.

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "engine/record/run/output_rule.hpp"
#include "model/observe/observation.hpp"

namespace cvtflow::tools {

enum class VtkCell : std::uint8_t { line = 3, poly_line = 4, quad = 9 };

/// Kind of a cell (array "part"); "number": half = 2 link + (front), plate = (plates per link) link + number, sheave = 2 shaft + side.
enum class Solid { half = 0, plate = 1, sheave = 2 };

/// Points and cells; constant in time.
struct VtkMesh {
    std::size_t points = 0;
    std::vector<std::int64_t> connectivity;  ///< point numbers, cell after cell
    std::vector<std::int64_t> offsets;       ///< [cells] ends of the cells in connectivity
    std::vector<std::uint8_t> types;         ///< [cells] VtkCell
    std::vector<std::int32_t> part, number;  ///< [cells] what a cell shows and which one of these

    [[nodiscard]] std::size_t cells() const noexcept { return types.size(); }
    void add(VtkCell type, std::span<const std::int64_t> corners, Solid which, int count);
    /// A cell of new points, in their order.
    void add(VtkCell type, std::int64_t new_points, Solid which, int count);
};

/// A quantity at every time.
struct VtkArray {
    std::string name;
    int components = 1;
    bool of_points = false;  ///< else of cells
};

/// Positions of the points, and the values of the arrays in their order, of one time.
struct VtkFrame {
    std::vector<float> points;  ///< [points][3]
    std::vector<std::vector<float>> values;
};

/// run.pvd and, beside it, run/run_000000.vtu … Errors are engine::RecordError.
class VtkSeries {
public:
    /// @param replace whether files of a former series may go
    VtkSeries(const engine::Permit& collection, const VtkMesh& mesh, std::vector<VtkArray> arrays, bool replace);
    /// Removes what it has written if finish() was not called; a former series stays.
    ~VtkSeries();
    VtkSeries(const VtkSeries&) = delete;
    VtkSeries& operator=(const VtkSeries&) = delete;
    /// The next time.
    void add(double time, const VtkFrame& frame);
    /// The collection appears under its name. @return bytes of all files
    [[nodiscard]] std::uintmax_t finish();

private:
    /// Name of a file in a folder: that of the series, or FILE.part until all are complete.
    [[nodiscard]] std::filesystem::path file(const std::filesystem::path& folder, long number) const;
    /// Number of a file of a series of this name; -1: another file.
    [[nodiscard]] long number_of(const std::filesystem::path& file) const;

    engine::Permit collection_;
    std::filesystem::path folder_, growing_;
    bool replace_, finished_ = false;
    const VtkMesh& mesh_;
    std::vector<VtkArray> arrays_;
    std::string rows_;  ///< rows of the collection
    long count_ = 0;
    std::uintmax_t bytes_ = 0;
};

class ChainSolids {
public:
    ChainSolids(const model::Variator& variator, const model::Parameters& parameters);

    [[nodiscard]] const VtkMesh& mesh() const noexcept { return mesh_; }
    /// axial_force, bending_moment, tension, joint_force of cells; tip_force of points.
    [[nodiscard]] static std::vector<VtkArray> arrays();
    /// Fills the frame for an instant, reusing its memory.
    void show(double time, const double* state, const model::Phase* phases, VtkFrame& frame);

private:
    void mesh_sheaves();
    [[nodiscard]] std::array<float, 3> point_of(const double* link, model::End end, double position) const;
    void show_links(const double* state, VtkFrame& frame);
    void show_sheaves(const double* state, VtkFrame& frame);
    void show_tips(const double* state, VtkFrame& frame);

    const model::Variator& variator_;
    model::Parameters parameters_;
    model::Observer observer_;
    const model::Observation* now_ = nullptr;
    std::vector<double> halves_;  ///< links of the present state, as those of halves
    VtkMesh mesh_;
};

}  // namespace cvtflow::tools
