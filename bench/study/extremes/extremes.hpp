#pragma once
/// The edges of every parameter, as a catalogue: each row contains a run and its allowed endings. A row is judged at several methods and
/// levels of detail; either the result is right within a bound, or the program states why not.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tasks/run/simulation.hpp"

namespace cvtflow::bench {

/// Possible endings of a row.
enum class Ending {
    right,      ///< finite, energy balance and agreement with half the step within the row's bound
    refused,    ///< the scene is not accepted, with a message
    fault,      ///< ended by a named fault within the steps of the row
    announced,  ///< not right, but the step exceeds the stability limit here, and the program reports that before it runs
    wrong,      ///< none of these
};

[[nodiscard]] std::string_view ending_name(Ending ending) noexcept;

struct Extreme {
    std::string group;
    std::string name;
    std::vector<std::string> settings;  ///< settings added to the scene `tiny`
    std::vector<Ending> allowed{Ending::right};
    std::vector<tasks::FaultKind> faults{};  ///< allowed faults; empty: any
    /// Largest relative error of the energy balance, and ten times less strict of the state against half the step.
    double bound = 1e-3;
    /// Additional error of the energy balance that leapfrogs are allowed, and ten times that against half the step. Their energy is that of
    /// a neighbouring system and swings about ours by (h omega)^2 / 4, and they lag by (h omega)^2 / 24 of the angle, 0.1 rad after 100
    /// steps of h omega = 0.28.
    double swing = 0.0;
    double step = 0.0;  ///< step [s]; 0: 50 ns, or a tenth of the stable step if that is less: the stiffest mode may hold all the energy
    long steps = 200;
    bool geometric = false;  ///< begins with the geometric start even where the settled state of `tiny` would fit
    /// Changes the start. The simulation is at the start. step [s]
    void (*prepare)(const tasks::Simulation& simulation, double step, tasks::IntegrationState& start) = nullptr;
    long min_transitions = 0;  ///< transitions below which the row proves nothing
    bool nightly = false;
};

/// All rows, group by group.
[[nodiscard]] const std::vector<Extreme>& extremes();

// Parts of the catalogue.
inline const std::vector<Ending> right_or_fault{Ending::right, Ending::fault};
void add_friction_rows(std::vector<Extreme>& rows);
void add_size_rows(std::vector<Extreme>& rows);
void add_operation_rows(std::vector<Extreme>& rows);
void add_contact_rows(std::vector<Extreme>& rows);
void add_step_rows(std::vector<Extreme>& rows);
void add_number_rows(std::vector<Extreme>& rows);
void add_limit_rows(std::vector<Extreme>& rows);

/// One method at one level of detail.
struct ExtremeCase {
    std::string method;
    std::string detail;
    Ending ending = Ending::wrong;
    tasks::Fault fault;
    std::string message;       ///< message of the refusal or fault, or reason for `wrong`
    double balance = 0.0;      ///< energy in less energy out less change, over the energy that passed [1]
    double refinement = 0.0;   ///< change of the state against half the step, over the change of the state [1]
    double step = 0.0;         ///< [s]
    double stable_step = 0.0;  ///< [s]
    long steps = 0;            ///< steps taken
    double wall = 0.0;         ///< [s]
};

struct ExtremeResult {
    const Extreme* row = nullptr;
    std::vector<ExtremeCase> cases;
    bool passed = false;
    /// "right: balance 2e-8, half step 3e-6 (9 cases)", "fault penetration after 3 steps at most (9)", …
    [[nodiscard]] std::string outcome() const;
};

/// Judges rows; keeps a settled state of each level of detail.
class ExtremeJudge {
public:
    /// @param tiny the scene of that name   @throws SimulationError if it does not settle
    explicit ExtremeJudge(const tasks::Scene& tiny);
    ~ExtremeJudge();
    ExtremeJudge(const ExtremeJudge&) = delete;
    ExtremeJudge& operator=(const ExtremeJudge&) = delete;

    [[nodiscard]] ExtremeResult judge(const Extreme& row);

private:
    struct Level;
    [[nodiscard]] ExtremeCase run(const Extreme& row, const Level& level, const std::string& method) const;

    std::vector<Level> levels_;
};

}  // namespace cvtflow::bench
