#pragma once
/// The edges of every key, drawn from the table of keys: each row contains a run and its allowed endings. A row is judged at several
/// methods and levels of detail; either the result is right within a bound, or the program states why not.

#include <string>
#include <string_view>
#include <vector>

#include "tasks/run/simulation.hpp"

namespace cvtflow::bench {

/// Possible endings of a row.
enum class Ending {
    right,      ///< finite, energy balance and agreement with half the step within the bound
    refused,    ///< the scene is not accepted, with a message
    fault,      ///< ended by a named fault within the steps of the row
    announced,  ///< not right, but the step exceeds the largest one that the program states before it runs
    wrong,      ///< none of these
};

[[nodiscard]] std::string_view ending_name(Ending ending) noexcept;

struct Extreme {
    std::string group;                  ///< section of the key
    std::string name;                   ///< "key = value"
    std::vector<std::string> settings;  ///< settings added to the scene `tiny`
    std::vector<Ending> allowed{Ending::right, Ending::refused, Ending::fault};
    double step = 0.0;  ///< step [s]; 0: 50 ns, or a tenth of the stable step if that is less: the stiffest mode may hold all the energy
    double velocity = 0.0;  ///< replaces a velocity of a link at the start, unless it is 0 [m/s]
    long steps = 100;
    bool nightly = false;
};

/// Of every key but those of runs and records: both limits, beyond them, no number, every word of a choice, a jump within a step where a
/// table is accepted; steps from 1 ps to 10 ms; states without sense; ten thousand pins.
[[nodiscard]] const std::vector<Extreme>& extremes();

/// One method at one level of detail.
struct ExtremeCase {
    std::string method, detail;
    Ending ending = Ending::wrong;
    std::string message{};    ///< message of the refusal or fault, or reason for `wrong`
    double balance = 0.0;     ///< energy in less energy out less change, over the energy that passed [1]
    double refinement = 0.0;  ///< change of the state against half the step, over the change of the state [1]
    double step = 0.0;        ///< [s]
    double wall = 0.0;        ///< [s]
};

struct ExtremeResult {
    std::vector<ExtremeCase> cases;
    bool passed = false;
    /// "3 right; 9 refused (first message)".
    [[nodiscard]] std::string outcome() const;
};

/// Judges rows; keeps a settled state of each level of detail.
class ExtremeJudge {
public:
    /// @param tiny the scene of that name   @throws SimulationError if it does not settle
    explicit ExtremeJudge(const tasks::Scene& tiny);

    [[nodiscard]] ExtremeResult judge(const Extreme& row) const;

private:
    struct Level {
        std::string name;
        tasks::Scene scene;
        tasks::IntegrationState settled;
    };
    [[nodiscard]] static ExtremeCase run(const Extreme& row, const Level& level, const std::string& method);

    std::vector<Level> levels_;
};

}  // namespace cvtflow::bench
