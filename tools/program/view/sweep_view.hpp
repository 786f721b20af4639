#pragma once
/// The results of a sweep, from its table or from a CSV of it, and their pictures.

#include <optional>
#include <string>
#include <vector>

#include "engine/record/run/schema.hpp"
#include "tasks/scene/scene.hpp"
#include "tools/program/plot/plot.hpp"

namespace cvtflow::tools {

struct SweepColumn {
    std::string name, unit, description;
    bool axis = false;    ///< a key of the scene that the cases differ in or that the sweep sets
    bool number = false;  ///< whether its cells are numbers
};

struct SweepView {
    std::string path;
    std::string name;                           ///< of the sweep; of a CSV, the file's
    std::vector<engine::Attribute> attributes;  ///< none of a CSV
    std::optional<tasks::Scene> scene = {};     ///< what all cases share; none of a CSV, or if this program cannot read it
    std::vector<SweepColumn> columns;
    std::vector<std::vector<std::string>> cells;  ///< [case][column]

    /// @throws UsageError with the column that was probably meant; keys with dots and scalars ("slip mean") are accepted
    [[nodiscard]] std::size_t column(const std::string& word) const;
    /// NaN for a cell that is no number.
    [[nodiscard]] double number(std::size_t row, std::size_t column) const;
    /// Whether the cases differ in a column.
    [[nodiscard]] bool varies(std::size_t column) const;
    /// The scene of a case, without a start state; none of a CSV, or if this program cannot read it.
    [[nodiscard]] std::optional<tasks::Scene> scene_of_case(std::size_t row) const;
    /// Keeps cases whose column has that value. @param condition "start.ratio=1"   @throws UsageError
    void keep(const std::string& condition);
};

/// In the unit in which pictures show the column.
[[nodiscard]] double value_of(const SweepView& sweep, std::size_t row, std::size_t column);

/// A column of measured data.
struct MeasuredColumn {
    std::string name, unit;      ///< as in the heading: "slip [%]"; without a unit the numbers are in SI
    double factor = 1.0;         ///< from its unit to SI
    std::vector<double> values;  ///< in SI; NaN for a cell that is no number
};

/// Measured data beside a simulation: a CSV whose headings are names of channels, columns or keys with units.
struct Measured {
    std::string path, name;
    std::vector<MeasuredColumn> columns;

    /// A name and its SI unit.
    struct Quantities {
        std::string name, unit;
    };
    /// Names of its columns: "time, slip".
    [[nodiscard]] std::string names() const;
    /// nullptr if there is none. Signs other than letters and digits are the same. @throws UsageError for a unit of another dimension
    [[nodiscard]] const MeasuredColumn* find(const std::string& name, const std::string& unit) const;
    /// @throws UsageError if there is none, with the names that there are
    [[nodiscard]] const MeasuredColumn& at(const std::string& name, const std::string& unit) const;
    /// One column over another as rings, in units of display. @param series in the legend
    [[nodiscard]] Series points(const Quantities& x, const Quantities& y, const std::string& series) const;
};
/// @throws engine::RecordError
[[nodiscard]] Measured read_measured(const std::string& path);

/// Whether a path is that of a sweep: a folder, a table of cases, or a CSV.
[[nodiscard]] bool is_sweep(const std::string& path);

/// The table of a sweep: the path itself, or cases.h5 in a folder.
/// @throws engine::RecordError for a folder without one, with the records in it
[[nodiscard]] std::string table_path(const std::string& path);

/// @param path folder of a sweep, its cases.h5, or what `cvtflow table --csv` printed
/// @throws engine::RecordError
[[nodiscard]] SweepView read_sweep(const std::string& path);

/// y over x; a curve for each combination of the other axes. Cases that did not end well are left out and counted.
/// @param measured drawn as points if given   @throws UsageError for columns that are not there or hold no numbers
[[nodiscard]] Plot sweep_curves(const SweepView& sweep, const std::string& x, const std::string& y, const Measured* measured = nullptr);

/// `colour` over x and y: with contours where the cases form a grid, as coloured points where they do not; map_marks() above them. A speed
/// ratio has a logarithmic axis.
/// @throws UsageError as above, and where several cases fall on one point, with the axes in which they differ
[[nodiscard]] Plot sweep_map(const SweepView& sweep, const std::string& x, const std::string& y, const std::string& colour);

/// The load of safety factor 1 of a case, on the side of zero on which its load is [N*m]; none where it depends on the run.
[[nodiscard]] std::optional<double> load_limit(const SweepView& sweep, std::size_t row);

/// Series above a map, in units of display. "torque limit": where one axis is load.torque, the load of safety factor 1 over the other
/// axis, by the scenes of the cases; absent where it is outside of their loads, where it depends on more than the other axis, and where the
/// clamping force or the load follows from the run. "verified": cases that also ran at reference quality.
/// @param sweep cases that ended well   @param x, y columns of numbers
[[nodiscard]] std::vector<Series> map_marks(const SweepView& sweep, std::size_t x, std::size_t y);

}  // namespace cvtflow::tools
