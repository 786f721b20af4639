#pragma once
/// The running variator as lines and surfaces with forces on them: pin halves, plates, sheaves.

#include <array>

#include "model/observe/observation.hpp"
#include "tools/program/report/vtk_series.hpp"

namespace cvtflow::tools {

/// Kind of a cell (array "part"); "number": half = 2 link + (front), plate = (plates per link) link + number, sheave = 2 shaft + side.
enum class Solid { half = 0, plate = 1, sheave = 2 };

class ChainSolids {
public:
    ChainSolids(const model::Variator& variator, const model::Parameters& parameters);

    [[nodiscard]] const VtkMesh& mesh() const noexcept { return mesh_; }
    /// axial_force, bending_moment, tension, joint_force of cells; tip_force of points.
    [[nodiscard]] static std::vector<VtkArray> arrays();
    /// Of an instant; the frame's memory is used again.
    void show(double time, const double* state, const model::Phase* phases, VtkFrame& frame);

private:
    void mesh_halves();
    void mesh_plates();
    void mesh_sheaves();
    [[nodiscard]] std::array<float, 3> point_of(const double* link, model::End end, double position) const;
    void show_links(const double* state, VtkFrame& frame);
    void show_sheaves(const double* state, VtkFrame& frame);
    void show_tips(const double* state, VtkFrame& frame);

    const model::Variator& variator_;
    model::Parameters parameters_;
    model::Observer observer_;
    const model::Observation* now_ = nullptr;
    std::vector<double> halves_;  ///< links of the state at hand, as those of halves
    VtkMesh mesh_;
};

}  // namespace cvtflow::tools
