#pragma once
/// Leapfrog with friction solved for where it acts: by a few implicit sweeps over the contacts of each joint and link, which begin with the
/// forces of the step before. It is backward Euler on velocities alone, nearly converged.
///
///     opening    joints and links with the forces of the step before, then plates and tips of each link
///     middle     joints, plates and tips once more, as often as the plan states
///     closing    joints; velocities and coordinates at the end
///
/// Forces that outlast a step belong to the state of the integration: they are saved. A first step has none: it takes `first_sweeps`.
///
/// Columns of links by segments, and what segments hand over. Columns of fields that outlast a step move with the borders of segments.
///
/// A segment needs the links beside it, its ghosts:
///
///     segment s          … 13 14 15 [16]          [16]: the first link of s + 1
///     segment s + 1            [15] 16 17 18 …    [15]: the last link of s
///
/// Their coordinates in the middle of a step: a GhostLink advances by itself, by velocities that its owner has handed over, to its owner's
/// bits. Their velocities after each pass: those that the joint between both depends on are handed over (SegmentEdges). So no segment reads
/// another's state, and no cache line has two writers.

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "model/contact/friction_operator.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

/// A ghost column of a segment, and the segment that holds its link.
struct GhostColumn {
    int column;
    int owner;  ///< segment
    int place;  ///< place among the columns that the owner hands over: 0, its first one, or 1, its last one
};

/// Columns of links in the fields of their segment, and the columns that neighbouring segments read.
///
/// With the columns of all links side by side, segments would share cache lines, and prefetching would steal lines from the segment that
/// writes them at every stage. So every segment has separate fields, ghost columns included, and what its neighbours need is handed over
/// in one piece.
class SegmentColumns {
public:
    /// Column of every segment's first link: there a cache line begins.
    static constexpr int first = 1;

    void lay_out(const Partition& partition);

    [[nodiscard]] int segments() const noexcept { return static_cast<int>(segments_.size()); }
    [[nodiscard]] const Segment& segment(int number) const noexcept { return segments_[static_cast<std::size_t>(number)]; }
    /// Columns of a segment's fields, ghosts included, and those before the first link.
    [[nodiscard]] int count(int number) const noexcept { return first + segment(number).size() + 1; }
    /// Offset from the number of a segment's link to its column.
    [[nodiscard]] int shift(int number) const noexcept { return first - segment(number).first; }
    /// One before its links and one behind them.
    [[nodiscard]] std::span<const GhostColumn> ghosts(int segment) const noexcept {
        return std::span(ghosts_).subspan(static_cast<std::size_t>(2 * segment), 2);
    }

private:
    std::vector<Segment> segments_;
    std::vector<GhostColumn> ghosts_;  ///< [segments][2]
};

/// Data of one field that segments exchange: its first and its last column, packed.
class SegmentEdges {
public:
    /// @param rows of fields: all of them
    explicit SegmentEdges(int rows);
    /// Rows of velocities of links that the joints between two segments depend on.
    explicit SegmentEdges(const model::ChainLayout& at);

    /// Makes room for `segments` segments. Allocates only if there were fewer before.
    void make_room(int segments);
    [[nodiscard]] std::size_t bytes() const noexcept { return packed_.size() * sizeof(float); }
    /// Copies a segment's first and last column of its field.
    void give(const SegmentColumns& columns, const model::FloatColumns& field, int segment) noexcept;
    /// Fills the ghost columns of a segment's field with what their owners gave.
    void take(const SegmentColumns& columns, model::FloatColumns& field, int segment) const noexcept;

private:
    [[nodiscard]] std::size_t place(int segment, int number) const noexcept {
        return static_cast<std::size_t>((2 * segment + number) * stride_);
    }

    explicit SegmentEdges(std::array<std::vector<int>, 2> rows);

    std::array<std::vector<int>, 2> rows_;  ///< rows of the first column, and of the last one
    int stride_ = 0;
    model::LineVector<float> packed_;  ///< [segments][2][stride]
};

/// Data that the tasks of segments write and read: contacts, fields of numbers of links by component, scratch. Fields that outlast a step
/// move with the borders of segments.
class SegmentFields {
public:
    using Columns = model::FloatColumns;

    /// Data of one segment. Column = link + shift of the segment.
    struct Fields {
        int width;  ///< columns
        model::ContactField contacts;
        Columns start, result;    ///< velocities at the step's start and at its end
        Columns mean_tip_forces;  ///< friction of the tips
        std::vector<Columns> of;  ///< [field] further ones of the method
        model::LineVector<float> scratch;
    };

    /// @param rows of each further field   @param outlasting fields that outlast a step, with equally many rows
    /// @param edges what segments hand over
    SegmentFields(const Workspace& workspace, const model::FrictionOperator& friction, std::vector<int> rows,
                  std::vector<std::size_t> outlasting, std::vector<SegmentEdges> edges);

    /// Memory of segments, after every change of the partition.
    void repartition(const Partition& partition);
    [[nodiscard]] const SegmentColumns& columns() const noexcept { return columns_; }
    [[nodiscard]] Fields& operator[](int segment) noexcept { return fields_[at(segment)]; }
    [[nodiscard]] const Fields& operator[](int segment) const noexcept { return fields_[at(segment)]; }
    /// Memory that a step touches [B]: no room for what borders move through, nothing that is computed on demand.
    [[nodiscard]] std::size_t bytes() const noexcept;

    /// Hands over a segment's part of a field to its neighbours.
    void give(std::size_t edge, const Columns& field, int segment) noexcept { edges_[edge].give(columns_, field, segment); }
    /// Takes over what its neighbours have given.
    void take(std::size_t edge, Columns& field, int segment) const noexcept { edges_[edge].take(columns_, field, segment); }

    /// The numbers of a field become zero, of all links.
    void clear(std::size_t field) noexcept;
    /// The numbers of a field, rows of all links one after the other.
    void visit(std::size_t field, std::string_view name, engine::Archive& archive);

private:
    [[nodiscard]] Fields make_fields(int width) const;
    void make_room();
    /// Sets the numbers of a field to what next() returns, rows of all links one after the other.
    template <class Next>
    void set(std::size_t field, const Next& next);
    /// Calls visit(number) for all numbers of a field, rows of all links one after the other.
    template <class Self, class Visit>
    static void for_numbers(Self& self, std::size_t field, const Visit& visit) {
        for (int row = 0; row < self.rows_[field]; ++row)
            for (int s = 0; s < self.columns_.segments(); ++s)
                for (int link = 0; link < self.columns_.segment(s).size(); ++link)
                    visit(*self[s].of[field].at(row, SegmentColumns::first + link));
    }

    const model::FrictionOperator& friction_;
    std::vector<int> rows_;                ///< [field] of further fields
    std::vector<std::size_t> outlasting_;  ///< fields
    SegmentColumns columns_;
    std::vector<Fields> fields_;       ///< [segment], or more
    std::vector<SegmentEdges> edges_;  ///< [edge]
    std::vector<float> moving_;        ///< [outlasting][rows][links] room for what borders move through
};

/// Setting that sweeps require and parameters do not have: pin halves, twelve pins, a friction law without a rounded corner and without
/// phases stick and slip, a run-out that leaves flanks where the record of contacts expects them. Empty: none.
[[nodiscard]] std::string_view missing_for_sweeps(const model::Parameters& parameters) noexcept;
/// In rings of few pins links meet at large angles, which magnify the rounding of a joint's depth in floats: a ring of five was off by 3 %,
/// one of twelve is right.
[[nodiscard]] inline bool has_few_pins(const model::Parameters& parameters) noexcept { return parameters.chain.pins < 12; }
/// Whether sweeps are the automatic choice: parameters have what they need, and friction does not saturate at so low a speed that more
/// sweeps would be needed than a step has.
[[nodiscard]] bool sweeps_suit(const model::Parameters& parameters);

/// The friction of a step as forces that implicit sweeps find (model/contact/friction_operator.hpp), by segments. Both neighbours of a
/// border compute its joint, from what they have handed over; so the same bits come out for all segments.
class SweepSystem {
public:
    explicit SweepSystem(const Workspace& workspace);

    /// Memory that a step touches [B].
    [[nodiscard]] std::size_t bytes() const noexcept {
        return sizeof(*this) + normal_loads_.size() * sizeof(model::LinkLoad) + fields_.bytes();
    }
    /// Memory of segments, after every change of the partition.
    void repartition(const Partition& partition);
    [[nodiscard]] const SegmentColumns& columns() const noexcept { return fields_.columns(); }
    /// Sets all contact forces to zero (no previous step).
    void restart() noexcept;
    /// Begins a step: forces that outlast a step become those of the step before. @param nominal usual length of a step [s]
    void begin(double step, double nominal) noexcept;
    void end() noexcept {
        losses_ = Losses::to_be_found;
        handed_over_ = true;
    }

    // Bodies of tasks: each touches the columns of one segment only, and reads what its neighbours have handed over.

    /// Contacts of a segment's links at the stage state of workspace.step.row, all other forces there as accelerations, with those by
    /// friction that last, and velocities at the step's start. No mean forces of tips so far.
    /// @param search decides which tips touch; nullptr: they do as they did
    void record(Workspace& workspace, const model::ContactDrift& drift, int segment, model::TipSearch* search) noexcept;
    /// Pass `number` of the step, from 0 on. @param opening FrictionSweep::ahead
    void sweep(const Workspace& workspace, model::SweepPart part, double opening, int number, int segment) noexcept;
    /// Loads of a segment's links; their state at the step's end by the resulting velocities, and its secants.
    /// @return whether that state is sound
    bool finish(Workspace& workspace, int segment) const noexcept;

    /// Replaces the friction losses in the accounts of an observe cycle by the powers of the last step's forces. Called at rest.
    void enter_losses(Workspace& workspace) noexcept;

    /// Data that outlast a step: its forces, and their losses.
    void visit(engine::Archive& archive);

private:
    enum class Losses { none, to_be_found, known };
    /// Fields: accelerations by everything but friction; velocities; two of forces that outlast a step, kept_now() and kept_before().
    enum Further : std::size_t { base, velocity, kept };
    [[nodiscard]] std::size_t kept_now() const noexcept { return kept + now_; }
    [[nodiscard]] std::size_t kept_before() const noexcept { return kept + 1 - now_; }
    /// Edges of velocities after passes of even and of odd number, and at the end; of accelerations for the filter of waves.
    enum Edges : std::size_t { velocity_edges, result_edges = velocity_edges + 2, acceleration_edges };

    [[nodiscard]] static std::vector<int> rows_of_fields(const Workspace& workspace);
    void make_room();
    [[nodiscard]] GhostLink* find_ghosts(const Workspace& workspace, int segment) noexcept;
    void find_losses() const noexcept;

    model::FrictionOperator friction_;
    SegmentFields fields_;
    model::LineVector<model::LinkLoad> normal_loads_;  ///< [links]
    model::SweepResponses responses_;
    std::vector<GhostLink> ghosts_;  ///< [segments][2]
    // Computed on demand: for an observation, a checkpoint, or borders that move.
    mutable std::vector<model::FloatColumns> means_;  ///< [segment], or more: velocities of the step, when its losses are found
    mutable SegmentEdges mean_edges_;
    mutable std::vector<model::FrictionPowers> powers_;  ///< [links] of the last step
    // Written in every step: on a line apart from what tasks read.
    alignas(model::cache_line) std::size_t now_ = 0;  ///< number of the present step's kept field
    double step_before_ = 0.0;                        ///< length of the step before [s]
    bool handed_over_ = false;                        ///< the last step's velocities at the ends of segments are handed over
    bool follows_ = false;                            ///< the same when the present step began
    mutable Losses losses_ = Losses::none;
};

/// The part of the step outside friction: the middle of the step, where contacts and all other forces are taken, by extrapolation, and its
/// end; and data of the step before: its mean acceleration, the motion of the sheaves in its middle, its length.
class LeapfrogFrame {
public:
    /// Slots of the workspace that it uses.
    static constexpr int state_slots = 2, slope_slots = 3;

    explicit LeapfrogFrame(Workspace& workspace) : w_(workspace) {}

    /// Forgets the previous step.
    void restart() noexcept { continues_ = false, length_ = 0.0; }
    /// Whether there is a step before the one that begins.
    [[nodiscard]] bool continues() const noexcept { return continues_; }
    /// Data of the step before become history; workspace.step.row for the middle of the step, and the sheaves there.
    void begin();
    /// Pulleys, from what the chain does to them; workspace.step.row for the result, whose links are in state slot 1.
    void end(const model::SheaveForces& chain);

    [[nodiscard]] const model::ContactDrift& drift() const noexcept { return drift_; }

    void visit(engine::Archive& archive);

private:
    void extrapolate();

    Workspace& w_;
    bool continues_ = false;  ///< whether a step precedes the present one
    double length_ = 0.0;     ///< length of the present step [s]
    alignas(model::cache_line) model::ContactDrift drift_;
    model::SheaveMotion sheaves_before_[4]{};
};

/// The method: a record in the middle of the step, passes of friction, the end (see above).
class SweepLeapfrog final : public StepMethod {
public:
    /// Slots of the workspace that the method uses.
    static constexpr int state_slots = LeapfrogFrame::state_slots, slope_slots = LeapfrogFrame::slope_slots;
    /// Sweeps of a step without a step before.
    static constexpr int first_sweeps = 30;

    /// Requires parameters with nothing missing_for_sweeps().
    explicit SweepLeapfrog(Workspace& workspace);

    [[nodiscard]] CycleSequence step() override;
    void add_tasks(engine::TaskGraph& graph) override;
    void repartitioned() override { system_.repartition(w_.partition); }
    /// Contact begins with no force at all, so the record decides it in the middle of the step.
    [[nodiscard]] AtTransition at_transition() const noexcept override { return AtTransition::inside; }
    [[nodiscard]] long observation_stride() const noexcept override { return 5; }
    void restart() noexcept override;
    void phases_changed() noexcept override {}  // forces stay good: that of a tip that has just landed is zero
    void visit(engine::Archive& archive) override;

    [[nodiscard]] std::optional<std::size_t> bytes() const noexcept override { return system_.bytes(); }

    // Bodies of tasks.
    void record(int segment) noexcept;
    void sweep(int item) noexcept;                                          ///< item = pass of the cycle × segments + segment
    void enter_losses(int /*item*/) noexcept { system_.enter_losses(w_); }  ///< by friction in an observe cycle, after all else

private:
    void add_passes(engine::TaskGraph& graph, int cycle, int passes);
    /// Takes the next cycle: of four passes as long as they fill one, then of one. @return its number
    [[nodiscard]] int next_passes() noexcept;
    void begin();
    [[nodiscard]] Fault finish();

    Workspace& w_;
    LeapfrogFrame frame_;
    SweepSystem system_;
    const int usual_passes_;                 ///< of a step
    int passes_ = 0, begun_ = 0, next_ = 0;  ///< of the present step; the first of the present cycle; those in no cycle yet begin here
    double length_ = 0.0;                    ///< length of the last step [s]
    double nominal_ = 0.0;                   ///< usual length of steps: the longest, or the last as long as the one before [s]
    bool cold_ = true;                       ///< no step precedes the present one: forces begin at zero, and it takes first_sweeps
};

}  // namespace cvtflow::tasks
