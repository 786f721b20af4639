#include "bench/parts/link_parts.hpp"

#include "model/kernels/lane_pass.hpp"

namespace cvtflow::bench {

namespace {

using namespace cvtflow::model;

constexpr int width = native_lanes;
using Pass = LanePass<width>;
using V = Lanes<width>;
constexpr int size = Pass::size;

/// Forces of W links, cleared, filled and written out.
class Forces {
public:
    explicit Forces(double* out) noexcept : out_(out) { f_.fill(V(0.0)); }
    [[nodiscard]] V* data() noexcept { return f_.data(); }
    void write(int start, int count) const noexcept {
        std::array<double*, width> to;
        for (int lane = 0; lane < count; ++lane) to[static_cast<std::size_t>(lane)] = out_ + (start + lane) * Pass::block;
        store_rows<width, size>(f_.data(), to, count);
    }

private:
    std::array<V, size> f_;
    double* out_;
};

void joints(const Pass& pass, int start, int count, const Pass::Columns& before, const Pass::Columns& here, double* out) noexcept {
    const Pass::Joints joint = pass.joints_between(before, here);
    Forces forces(out);
    joint.on_front.apply(1.0, forces.data(), End::front);
    forces.data()[link_layout.x(End::rear, 0)] = joint.before;
    forces.data()[link_layout.y(End::rear, 0)] = joint.after;
    forces.write(start, count);
}

void others(int part, const Pass& pass, int start, int count, const Pass::Columns& columns, double* out, LinkLoad* loads) noexcept {
    Forces forces(out);
    V moment(0.0);
    NoBooks none;
    if (part == 1) moment = pass.inner(pass.kinds(start, count), start, count, columns, forces.data(), none);
    if (part == 2) pass.plates(pass.kinds(start, count), columns, forces.data(), none);
    if (part == 4) pass.tips(start, count, columns, forces.data(), moment, loads);
    add_moment(columns.frame, moment, forces.data());
    forces.write(start, count);
}

/// Velocities represent forces.
void solve(const Pass& pass, int start, int count, const Pass::Columns& columns) noexcept {
    std::array<V, size> f;
    std::copy_n(columns.v(), size, f.begin());
    pass.solve(start, count, columns, f.data());
}

std::size_t lane_memory(int links) {
    return sizeof(Pass::Columns) / sizeof(double) * static_cast<std::size_t>((links + width - 1) / width + 1);
}

void run(int part, const ChainModel& model, const ChainRange& range, double* lanes, double* out, LinkLoad* loads) {
    const Pass pass(model, range, out, loads);
    auto* columns = reinterpret_cast<Pass::Columns*>(lanes) + 1;  // before them those of the link before the first
    const int links = range.last - range.first;
    if (part == 0) pass.read(-width, columns[-1]);
    for (int start = 0; start < links; start += width) {
        const int count = std::min(width, links - start), group = start / width;
        if (part == 0)
            pass.read(start, columns[group]);
        else if (part == 3)
            joints(pass, start, count, columns[group - 1], columns[group], out);
        else if (part == 5)
            solve(pass, start, count, columns[group]);
        else
            others(part, pass, start, count, columns[group], out, loads);
    }
}

}  // namespace

template <>
LinkParts link_parts<compiled_isa>() {
    return {lane_memory, run};
}

}  // namespace cvtflow::bench
