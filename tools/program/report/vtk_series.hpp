#pragma once
/// A mesh that moves, for ParaView and VTK: a collection (.pvd) of one XML UnstructuredGrid (.vtu) per time, raw binary data.
///
/// Not VTKHDF, whose time series are newer (VTK 9.3) than the readers that distributions have, and no series inside one .vtu: VTK 9.1 adds
/// the cells of all times up.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "engine/record/run/output_rule.hpp"

namespace cvtflow::tools {

enum class VtkCell : std::uint8_t { line = 3, poly_line = 4, quad = 9 };

/// Points and cells; constant in time.
struct VtkMesh {
    std::size_t points = 0;
    std::vector<std::int64_t> connectivity;  ///< point numbers, cell after cell
    std::vector<std::int64_t> offsets;       ///< [cells] ends of the cells in connectivity
    std::vector<std::uint8_t> types;         ///< [cells] VtkCell
    std::vector<std::int32_t> part, number;  ///< [cells] what a cell shows and which one of these

    [[nodiscard]] std::size_t cells() const noexcept { return types.size(); }
    void add(VtkCell type, std::span<const std::int64_t> corners, std::int32_t which, std::int32_t count);
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
    /// Without finish(): removes what it has written.
    ~VtkSeries();
    VtkSeries(const VtkSeries&) = delete;
    VtkSeries& operator=(const VtkSeries&) = delete;
    /// The next time.
    void add(double time, const VtkFrame& frame);
    /// The collection appears under its name. @return bytes of all files
    [[nodiscard]] std::uintmax_t finish();

private:
    [[nodiscard]] std::string head() const;
    [[nodiscard]] std::size_t length(const VtkArray& array) const noexcept;
    [[nodiscard]] std::filesystem::path file(long number) const;
    /// Number of a file of a series of this name; -1: another file.
    [[nodiscard]] long number_of(const std::filesystem::path& file) const;

    engine::Permit collection_;
    std::filesystem::path folder_;
    bool replace_, finished_ = false;
    const VtkMesh& mesh_;
    std::vector<VtkArray> arrays_;
    std::string rows_;  ///< of the collection
    long count_ = 0;
    std::uintmax_t bytes_ = 0;
};

}  // namespace cvtflow::tools
