#pragma once
/// A one-step method as a table. A method is written as what each stage combines; stage times and the reuse of the last slope are derived
/// from the table. Order and reach are numbers beside it, which bench/method/analysis derives and a test compares to the last digit.
///
///     stage i:   Y   = Σ states.factor Y[states.slot] + h Σ slopes.factor K[slopes.slot]
///                Y[keep] = Y (if keep ≥ 0),   K[slope] = f(t + c h, Y),   c derived
///     result:    y(t + h) = Σ states + h Σ slopes,   error: y - ŷ in the same form (its states sum to 0)
///
/// State slot 0 holds y(t), slope slot 0 holds f(t, y(t)) = stage 0; both stay untouched for the whole step.

#include <optional>
#include <string>
#include <vector>

namespace cvtflow::engine {

struct Term {
    int slot;
    double factor;  ///< [1]
    bool operator==(const Term&) const = default;
};

struct Combination {
    std::vector<Term> states;  ///< Σ factor Y[slot]
    std::vector<Term> slopes;  ///< h Σ factor K[slot]
    bool operator==(const Combination&) const = default;
};

struct Stage {
    std::vector<Term> states;  ///< Σ factor Y[slot]; factors sum to 1
    std::vector<Term> slopes;  ///< h Σ factor K[slot]
    int keep = -1;             ///< state slot that stores Y, or -1
    int slope = 0;             ///< slope slot that receives f(t + c h, Y)
    bool operator==(const Stage&) const = default;
};

/// Limits of stability of a table on y' = λ y, |R(h λ)| ≤ 1 + 1e-6, and of its accuracy there.
struct StageReach {
    double oscillation;     ///< h |λ| on the ray of damping ratio 1e-3 [1]
    double decay;           ///< -h λ on the real axis [1]
    double accurate;        ///< h ω on the imaginary axis up to which it damps by less than 1e-4 h ω a step, at most `oscillation` [1]
    double lightly_damped;  ///< h |λ| on the ray of damping ratio 1e-2 [1]
    bool operator==(const StageReach&) const = default;
};

struct StagePlan {
    std::string name;         ///< name in scenes and on the command line
    std::string description;  ///< one line for users
    std::string source;       ///< paper
    int state_slots = 1;      ///< slot 0 included
    int slope_slots = 1;      ///< slot 0 included
    std::vector<Stage> stages;
    Combination result;
    std::optional<Combination> error;      ///< local error estimate y - ŷ
    int order = 0;                         ///< order of the result
    int embedded_order = 0;                ///< order of ŷ; 0 without an error estimate
    std::optional<StageReach> reach = {};  ///< nullopt: has yet to be derived
};

/// Plan of an explicit Butcher tableau: every stage from y, one slope slot per stage; zero entries are left out.
/// @param rows row i - 1 holds a_i0 … a_i,i-1 of stage i ≥ 1   @param weights b   @param embedded b̂ of the error estimate, empty: none
/// @throws std::invalid_argument if lengths do not match
[[nodiscard]] StagePlan butcher_plan(std::string name, std::string description, std::string source,
                                     const std::vector<std::vector<double>>& rows, const std::vector<double>& weights,
                                     const std::vector<double>& embedded = {});

}  // namespace cvtflow::engine
