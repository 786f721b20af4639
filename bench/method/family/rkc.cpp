#include "bench/method/family/families.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace cvtflow::bench {

namespace {

/// Chebyshev polynomials T_j and their first two derivatives at w0, j = 0 … degree.
struct Chebyshev {
    std::vector<double> value{1.0};
    std::vector<double> first{0.0};
    std::vector<double> second{0.0};

    Chebyshev(int degree, double w0) {
        value.push_back(w0);
        first.push_back(1.0);
        second.push_back(0.0);
        for (std::size_t j = 2; j <= static_cast<std::size_t>(degree); ++j) {
            value.push_back(2.0 * w0 * value[j - 1] - value[j - 2]);
            first.push_back(2.0 * value[j - 1] + 2.0 * w0 * first[j - 1] - first[j - 2]);
            second.push_back(4.0 * first[j - 1] + 2.0 * w0 * second[j - 1] - second[j - 2]);
        }
    }
};

/// The recurrence Y_j = (1 - mu - nu) Y_0 + mu Y_{j-1} + nu Y_{j-2} + h mu~ F_{j-1} + h gamma~ F_0; Y_{j-1} has been evaluated in stage j
/// - 1.
class Recurrence {
public:
    Recurrence(int stages, double damping)
        : w0_(1.0 + damping / (static_cast<double>(stages) * stages)),
          polynomials_(stages, w0_),
          w1_(polynomials_.first.back() / polynomials_.second.back()) {}

    /// b_j = T_j'' / T_j'^2; b_0 = b_1 = b_2.
    [[nodiscard]] double b(int j) const {
        const auto i = static_cast<std::size_t>(j < 2 ? 2 : j);
        return polynomials_.second[i] / (polynomials_.first[i] * polynomials_.first[i]);
    }

    [[nodiscard]] Stage row(int j) const {
        if (j == 1) return {{{0, 1.0}}, {{0, b(1) * w1_}}, state_slot(1), slope_slot(1)};
        const double mu = 2.0 * b(j) * w0_ / b(j - 1);
        const double nu = -b(j) / b(j - 2);
        const double mu_slope = 2.0 * b(j) * w1_ / b(j - 1);
        const double a = 1.0 - b(j - 1) * polynomials_.value[static_cast<std::size_t>(j - 1)];
        Stage stage{{}, {{0, -a * mu_slope}, {slope_slot(j - 1), mu_slope}}, state_slot(j), slope_slot(j)};
        if (j == 2) {
            stage.states = {{0, 1.0 - mu}, {state_slot(1), mu}};
        } else {
            stage.states = {{0, 1.0 - mu - nu}, {state_slot(j - 1), mu}, {state_slot(j - 2), nu}};
        }
        return stage;
    }

    [[nodiscard]] static int state_slot(int j) { return 1 + (j - 1) % 3; }
    [[nodiscard]] static int slope_slot(int j) { return 1 + (j - 1) % 2; }

private:
    double w0_;
    Chebyshev polynomials_;
    double w1_;
};

std::string name_of(int stages, double damping) {
    std::string name = "rkc-s" + std::to_string(stages);
    if (damping == rkc_damping) return name;
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), damping).ptr;
    return name + "-e" + std::string(digits.data(), end);
}

struct Request {
    int stages;
    double damping;
};

/// "rkc-s<stages>" or "rkc-s<stages>-e<damping>".
std::optional<Request> parse(std::string_view name) {
    constexpr std::string_view prefix = "rkc-s", infix = "-e";
    if (!name.starts_with(prefix)) return {};
    Request request{0, rkc_damping};
    const char* const end = name.data() + name.size();
    const auto [after, fault] = std::from_chars(name.data() + prefix.size(), end, request.stages);
    if (fault != std::errc()) return {};
    const std::string_view rest(after, static_cast<std::size_t>(end - after));
    if (rest.empty()) return request;
    if (!rest.starts_with(infix)) return {};
    const auto [stop, wrong] = std::from_chars(after + infix.size(), end, request.damping, std::chars_format::fixed);
    if (wrong != std::errc() || stop != end) return {};
    return request;
}

bool within_limits(const Request& request) {
    return request.stages >= min_rkc_stages && request.stages <= max_rkc_stages && request.damping >= 0.0 &&
           request.damping <= max_rkc_damping;
}

}  // namespace

StagePlan rkc(int stages, double damping) {
    if (!within_limits({stages, damping})) throw std::invalid_argument("RKC has 2 to 400 stages and a damping of 0 to 100");
    StagePlan plan{name_of(stages, damping),
                   "Runge-Kutta-Chebyshev, stabilised along the real axis",
                   "Sommeijer, Shampine, Verwer, J. Comput. Appl. Math. 88 (1998) 315-326",
                   4,
                   3,
                   {{{{0, 1.0}}, {}, -1, 0}},
                   {},
                   {}};
    const Recurrence recurrence(stages, damping);
    for (int j = 1; j <= stages; ++j) plan.stages.push_back(recurrence.row(j));
    const int end = Recurrence::state_slot(stages);
    plan.result = {{{end, 1.0}}, {}};
    plan.error = Combination{{{0, 0.8}, {end, -0.8}}, {{0, 0.4}, {Recurrence::slope_slot(stages), 0.4}}};
    return plan;
}

std::optional<StagePlan> rkc_by_name(std::string_view name) {
    const std::optional<Request> request = parse(name);
    if (!request || !within_limits(*request)) return {};
    return rkc(request->stages, request->damping);
}

double rkc_reach(int stages, double damping) {
    const double w0 = 1.0 + damping / (static_cast<double>(stages) * stages);
    const Chebyshev t(stages, w0);
    return (w0 + 1.0) * t.second.back() / t.first.back();
}

}  // namespace cvtflow::bench
