#pragma once
/// The results of a sweep, from its table or from a CSV of it, and measured data beside it.

#include <optional>
#include <string>
#include <vector>

#include "engine/record/run/schema.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tools {

struct SweepColumn {
    std::string name, unit, description;
    bool axis = false;    ///< a key of the scene that the cases differ in or that the sweep sets
    bool number = false;  ///< whether its cells are numbers
};

struct SweepView {
    std::string path;
    std::string name;                           ///< name of the sweep, or of the CSV file
    std::vector<engine::Attribute> attributes;  ///< none for a CSV
    std::optional<tasks::Scene> scene = {};     ///< values that all cases share; none for a CSV, or if this program cannot read it
    std::vector<SweepColumn> columns;
    std::vector<std::vector<std::string>> cells;  ///< [case][column]

    /// @throws UsageError with the column that was probably meant; keys with dots and scalars ("slip mean") are accepted
    [[nodiscard]] std::size_t column(const std::string& word) const;
    /// NaN for a cell that is no number.
    [[nodiscard]] double number(std::size_t row, std::size_t column) const;
    /// The scene of a case, without a start state; none of a CSV, or if this program cannot read it.
    [[nodiscard]] std::optional<tasks::Scene> scene_of_case(std::size_t row) const;
    /// Keeps cases whose column has that value. @param condition "start.ratio=1"   @throws UsageError
    void keep(const std::string& condition);
};

/// A column of measured data.
struct MeasuredColumn {
    std::string name, unit;      ///< parts of the heading: "slip [%]"; without a unit the numbers are in SI
    double factor = 1.0;         ///< factor from `unit` to SI
    std::vector<double> values;  ///< numbers in SI; NaN for a cell that is no number
};

/// Measured data beside a simulation: a CSV whose headings are names of channels, columns or keys with units.
struct Measured {
    std::string path, name;
    std::vector<MeasuredColumn> columns;
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

/// The load of safety factor 1 of a case, on the side of zero on which its load is [N*m]; none where it depends on the run.
[[nodiscard]] std::optional<double> load_limit(const SweepView& sweep, std::size_t row);

}  // namespace cvtflow::tools
