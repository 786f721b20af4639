#pragma once
/// Runs a row of the catalogue of extremes and returns its result.

#include <memory>
#include <string>
#include <vector>

#include "bench/study/extremes/extreme.hpp"

namespace cvtflow::bench {

/// One method at one level of detail.
struct ExtremeCase {
    std::string method;
    std::string detail;
    Ending ending = Ending::wrong;
    tasks::Fault fault;
    std::string message;       ///< of the refusal or fault, or what is wrong
    double balance = 0.0;      ///< energy in less energy out less change, over the energy that passed [1]
    double refinement = 0.0;   ///< change of the state against half the step, over the change of the state [1]
    double step = 0.0;         ///< [s]
    double stable_step = 0.0;  ///< [s]
    long steps = 0;            ///< taken
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
