#pragma once
/// Start states of the cases of a sweep: states read once, states settled once and shared by the cases that allow it.

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "engine/executor/tbb/job_pool.hpp"
#include "engine/record/run/state_file.hpp"
#include "model/start/start_state.hpp"
#include "tasks/batch/sweep/sweep.hpp"
#include "tasks/run/simulation.hpp"

namespace cvtflow::tasks {

/// A settling that was paused or failed: the case cannot begin now, or at all.
class StartFault : public SimulationError {
public:
    explicit StartFault(Fault why) : SimulationError("settling: " + why.message()), fault(why) {}
    Fault fault;
};

class StartStates {
public:
    using State = std::shared_ptr<const engine::SavedState>;
    using Placed = std::shared_ptr<const model::StartState>;

    /// @param folder  where settled states are kept, by the hash of all that they depend on; made when it is needed
    StartStates(const Sweep& sweep, std::filesystem::path folder);

    /// The state that a case begins with; nullptr: it settles by itself. Any thread. Allocates nothing for a state that is kept.
    /// @param scene of the case   @throws StartFault, engine::RecordError
    [[nodiscard]] State of_case(long number, const Scene& scene, const engine::Cancellation& cancel);
    /// The chain placed around the pulleys for a case; shared by all cases with the same relevant parameters. Any thread.
    /// @param scene of the case
    /// @throws std::invalid_argument if the chain does not close
    [[nodiscard]] Placed placed(long number, const Scene& scene);
    /// The first of all cases that begin with the same settled state; -1: the case shares none.
    [[nodiscard]] long first_settling_alike(long number) const noexcept;
    /// "scene", "geometric", "settled" or "shared". Any thread. @throws engine::RecordError
    [[nodiscard]] std::string_view kind(const Scene& scene);

private:
    [[nodiscard]] State file_state(const Scene& scene);
    [[nodiscard]] State from_file(const std::string& path);
    [[nodiscard]] State settled(const Scene& scene, const engine::Cancellation& cancel);
    [[nodiscard]] State shared_from_file(const std::string& path, std::uint64_t key);
    template <class Map>
    [[nodiscard]] typename Map::mapped_type kept(const Map& map, const typename Map::key_type& key);
    template <class Map>
    void keep(Map& map, const typename Map::key_type& key, typename Map::mapped_type made);
    [[nodiscard]] Scene settling_scene(long number, const Scene& scene) const;
    [[nodiscard]] bool matters(const Axis& axis) const noexcept;
    template <class Matters>
    [[nodiscard]] long first_alike(long number, const Matters& matters) const noexcept;

    const Sweep& sweep_;
    std::filesystem::path folder_;
    bool shareable_ = false;  ///< whether several cases of the sweep settle alike
    engine::Mutex mutex_;
    engine::OnceEach once_;
    std::map<std::string, State> of_file_;  ///< the latest few, by file
    std::map<long, State> of_settling_;     ///< the same, by the first case that settles alike
    std::map<long, Placed> placed_;         ///< geometric starts, by the first case that has the same
};

/// Turns a shaft with its sheaves, which are the same all round: a governor counts angles from t = 0. state [unknowns], shaft 0 or 1,
/// angle [rad]
void turn_shaft(double* state, const model::Parameters& parameters, int shaft, double angle);

/// Whether the course of settling depends on a key.
[[nodiscard]] bool matters_for_settling(std::string_view key) noexcept;
/// Whether the geometric start depends on it.
[[nodiscard]] bool matters_for_placing(const Parameter& parameter) noexcept;

}  // namespace cvtflow::tasks
