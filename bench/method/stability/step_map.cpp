#include "bench/method/stability/step_map.hpp"

#include <algorithm>

#include "bench/method/fitted_method.hpp"
#include "bench/method/product_names.hpp"
#include "engine/method/compiled_plan.hpp"
#include "tasks/method/friction/friction_leapfrog.hpp"

namespace cvtflow::bench {

// One-step methods: tables of stages, and those that solve for the whole state.

namespace {

/// (h v, h² a) of (q, h v).
void slope_of(const LinearChain& chain, double h, const double* from, double* slope) {
    const int n = chain.coordinates(), m = chain.velocities();
    std::copy_n(from + n, n, slope);
    std::fill_n(slope + n, m, 0.0);
    chain.add_elastic(h * h, from, slope + n);
    chain.add_damping(h, from + n, slope + n);
    chain.add_friction(h, from + n, slope + n);
}

class TableStep final : public StepMap {
public:
    TableStep(const LinearChain& chain, const engine::CompiledPlan& plan) : chain_(chain), plan_(plan), stage_(at(size())) {
        for (int slot = 0; slot < plan_.state_slots(); ++slot) states_.emplace_back(at(size()));
        for (int slot = 0; slot < plan_.slope_slots(); ++slot) slopes_.emplace_back(at(size()));
        for (auto& slot : states_) state_slots_.push_back(slot.data());
        for (auto& slot : slopes_) slope_slots_.push_back(slot.data());
    }
    bool prepare(double h) override {
        h_ = h;
        return true;
    }
    int size() const noexcept override { return chain_.coordinates() + chain_.velocities(); }
    void step(const double* from, double* to) override {
        const engine::SlotView view{state_slots_.data(), slope_slots_.data()};
        std::copy_n(from, size(), states_[0].begin());
        for (int stage = 0; stage < plan_.stages(); ++stage) {
            const engine::PlanStep row = plan_.stage(stage);
            engine::combine(row, 1.0, view, 0, size(), stage_.data());
            if (row.keep >= 0) std::copy(stage_.begin(), stage_.end(), states_[at(row.keep)].begin());
            slope_of(chain_, h_, stage_.data(), slopes_[at(row.slope)].data());
        }
        engine::combine(plan_.result(), 1.0, view, 0, size(), to);
    }

private:
    const LinearChain& chain_;
    const engine::CompiledPlan plan_;
    double h_ = 0.0;
    std::vector<std::vector<double>> states_, slopes_;
    std::vector<double*> state_slots_, slope_slots_;
    std::vector<double> stage_;
};

/// u of (1 - γ z) u = γ (z y + r), z = h J.
class LinearlyImplicit final : public StepMap {
public:
    LinearlyImplicit(const LinearChain& chain, LinearPlan plan)
        : chain_(chain), plan_(std::move(plan)), state_(at(size())), right_(at(size())) {
        increments_.assign(plan_.stages.size(), std::vector<double>(at(size())));
    }
    bool prepare(double h) override {
        h_ = h;
        solvers_.clear();
        for (std::size_t stage = 0; stage < plan_.stages.size(); ++stage) {
            const double gamma = plan_.stages[stage].gamma;
            const bool same = stage > 0 && gamma == plan_.stages[stage - 1].gamma;
            solvers_.push_back(same ? solvers_.back() : std::shared_ptr<LinearSolver>(chain_.whole_solver(gamma * h)));
        }
        return true;
    }
    int size() const noexcept override { return chain_.coordinates() + chain_.velocities(); }
    void step(const double* from, double* to) override {
        for (std::size_t stage = 0; stage < plan_.stages.size(); ++stage) {
            const LinearStage& row = plan_.stages[stage];
            std::copy_n(from, size(), state_.begin());
            add(row.states, state_.data());
            slope_of(chain_, h_, state_.data(), right_.data());
            add(row.right, right_.data());
            solve(stage, row.gamma, increments_[stage].data());
        }
        std::copy_n(from, size(), to);
        add(plan_.result, to);
    }

private:
    void add(const std::vector<engine::Term>& terms, double* out) const {
        for (const engine::Term& term : terms) {
            for (int k = 0; k < size(); ++k) out[k] += term.factor * increments_[at(term.slot)][at(k)];
        }
    }
    /// Coordinates eliminated: u_q = γ (r_q + u_v).
    void solve(std::size_t stage, double gamma, double* u) const {
        const int n = chain_.coordinates(), m = chain_.velocities();
        std::vector<double> right(right_.begin() + n, right_.end());
        for (double& number : right) number *= gamma;
        chain_.add_elastic(gamma * gamma * h_ * h_, right_.data(), right.data());
        solvers_[stage]->solve(right.data(), u + n);
        for (int k = 0; k < n; ++k) u[k] = gamma * (right_[at(k)] + u[n + k]);
        (void)m;
    }

    const LinearChain& chain_;
    const LinearPlan plan_;
    double h_ = 0.0;
    std::vector<std::shared_ptr<LinearSolver>> solvers_;
    std::vector<std::vector<double>> increments_;
    std::vector<double> state_, right_;
};

}  // namespace

std::unique_ptr<StepMap> table_step(const LinearChain& chain, const engine::CompiledPlan& plan) {
    return std::make_unique<TableStep>(chain, plan);
}

std::unique_ptr<StepMap> implicit_step(const LinearChain& chain, const LinearPlan& plan) {
    return std::make_unique<LinearlyImplicit>(chain, plan);
}

/// (1 - z/2) u = z y: a linearly implicit step of one stage, u = 2 (1 - z/2)⁻¹ z/2 y.
std::unique_ptr<StepMap> trapezoidal_step(const LinearChain& chain) {
    return implicit_step(chain, {"trapezoidal", "", "", 2, {{0.5, {}, {}}}, {{0, 2.0}}});
}

// Methods that take friction apart.

namespace {

using Numbers = std::vector<double>;

void add(double factor, const double* from, int count, double* to) {
    for (int k = 0; k < count; ++k) to[k] += factor * from[k];
}

/// Input and result of one step of friction on the links' velocities.
struct LinkKick {
    const double* velocity;      ///< h v at the start
    const double* frictionless;  ///< h² a by everything but friction
    const double* change;        ///< change of frictionless since the step before
    const double* grip;          ///< h² a by friction, the part that is constant within the step
    const double* drift;         ///< change of h² a by friction over the step, by the sheaves' motion
    double* result;              ///< h v at the end
    double* mean;                ///< mean velocity in the sense of friction's impulse
    double mean_time = 0.0;      ///< mean time of friction's impulse, from the middle of the step
};

/// Friction of the present step.
class Kicker {
public:
    virtual ~Kicker() = default;
    [[nodiscard]] virtual bool prepare(const LinearChain& chain, double h) = 0;
    virtual void kick(LinkKick& kick) = 0;

protected:
    Kicker() = default;
    Kicker(const Kicker&) = default;
    Kicker& operator=(const Kicker&) = default;
};

class ExplicitKicker final : public Kicker {
public:
    explicit ExplicitKicker(const Kick& kick) : tables_(kick) {}
    bool prepare(const LinearChain& chain, double h) override {
        chain_ = &chain;
        h_ = h;
        table_ = tables_.reaching(FrictionLeapfrog::margin * chain.stiffest_friction() * h);
        for (Numbers& slot : states_) slot.resize(at(chain.link_velocities()));
        for (Numbers& slot : slopes_) slot.resize(at(chain.link_velocities()));
        return table_ != nullptr;
    }
    void kick(LinkKick& k) override {
        const int count = chain_->link_velocities();
        std::copy_n(k.velocity, count, states_[0].begin());
        std::fill_n(k.mean, count, 0.0);
        k.mean_time = 0.0;
        Numbers v(at(count));
        for (int stage = 0; stage < table_->plan.stages(); ++stage) {
            const engine::PlanStep row = table_->plan.stage(stage);
            combine(row, v.data());
            if (row.keep >= 0) states_[at(row.keep)] = v;
            Numbers& slope = slopes_[at(row.slope)];
            std::copy_n(k.frictionless, count, slope.begin());
            add(table_->extrapolation(row.time, 1.0), k.change, count, slope.data());
            add(1.0, k.grip, count, slope.data());
            add(row.time - 0.5, k.drift, count, slope.data());
            chain_->add_link_friction(h_, v.data(), slope.data());
            const double weight = table_->weights[at(stage)];
            add(weight, v.data(), count, k.mean);
            k.mean_time += weight * (row.time - 0.5);
        }
        combine(table_->plan.result(), k.result);
    }

private:
    void combine(const engine::PlanStep& row, double* out) const {
        const int count = chain_->link_velocities();
        std::fill_n(out, count, 0.0);
        for (const engine::Term& term : row.states) add(term.factor, states_[at(term.slot)].data(), count, out);
        for (const engine::Term& term : row.slopes) add(term.factor, slopes_[at(term.slot)].data(), count, out);
    }

    const KickTables tables_;
    const LinearChain* chain_ = nullptr;
    const KickTable* table_ = nullptr;
    double h_ = 0.0;
    std::array<Numbers, kick_state_slots> states_;
    std::array<Numbers, kick_slope_slots> slopes_;
};

/// Backward Euler: the drift of the sheaves over half a step.
class BackwardEulerKicker final : public Kicker {
public:
    explicit BackwardEulerKicker(bool held) : held_(held) {}
    bool prepare(const LinearChain& chain, double h) override {
        chain_ = &chain;
        h_ = h;
        solver_ = chain.friction_solver(h, held_);
        right_.resize(at(chain.link_velocities()));
        return true;
    }
    void kick(LinkKick& k) override {
        const int count = static_cast<int>(right_.size());
        std::copy_n(k.velocity, count, right_.begin());
        if (held_) chain_->add_held(h_ * h_, k.velocity, right_.data());
        add(1.0, k.frictionless, count, right_.data());
        add(1.0, k.grip, count, right_.data());
        k.mean_time = 0.5;
        add(k.mean_time, k.drift, count, right_.data());
        solver_->solve(right_.data(), k.result);
        std::copy_n(k.result, count, k.mean);
    }

private:
    const bool held_;  ///< links are held over a step
    const LinearChain* chain_ = nullptr;
    double h_ = 0.0;
    std::unique_ptr<LinearSolver> solver_;
    Numbers right_;
};

/// (q, h v, h² a of the step before, frictionless of the step before, h v of the sheaves in its middle).
class Leapfrog final : public StepMap {
public:
    Leapfrog(const LinearChain& chain, std::unique_ptr<Kicker> kicker)
        : chain_(chain), kicker_(std::move(kicker)), n_(chain.coordinates()), m_(chain.velocities()), links_(chain.link_velocities()) {
        for (Numbers* field : {&middle_, &velocity_, &frictionless_, &change_, &grip_, &drift_, &surface_, &mean_, &pulleys_})
            field->assign(at(m_), 0.0);
    }
    bool prepare(double h) override {
        h_ = h;
        return kicker_->prepare(chain_, h);
    }
    int size() const noexcept override { return n_ + 2 * m_ + links_ + (m_ - links_); }
    void step(const double* from, double* to) override {
        const double *q = from, *v = from + n_, *rate = v + m_, *frictionless_before = rate + m_,
                     *sheaves_before = frictionless_before + links_;
        double *q_end = to, *v_end = to + n_, *rate_end = v_end + m_, *frictionless_end = rate_end + m_,
               *sheaves_end = frictionless_end + links_;
        for (int k = 0; k < n_; ++k) middle_[at(k)] = q[k] + 0.5 * v[k];
        for (int k = 0; k < m_; ++k) velocity_[at(k)] = v[k] + 0.5 * rate[k];
        forces_in_the_middle(frictionless_before, sheaves_before);
        LinkKick kick{v, frictionless_.data(), change_.data(), grip_.data(), drift_.data(), v_end, mean_.data()};
        kicker_->kick(kick);
        close(kick, v, v_end);
        for (int k = 0; k < n_; ++k) q_end[k] = q[k] + 0.5 * (v[k] + v_end[k]);
        for (int k = 0; k < m_; ++k) rate_end[k] = v_end[k] - v[k];
        std::copy_n(frictionless_.begin(), links_, frictionless_end);
        std::copy(velocity_.begin() + links_, velocity_.end(), sheaves_end);
    }

private:
    void forces_in_the_middle(const double* frictionless_before, const double* sheaves_before) {
        for (Numbers* field : {&frictionless_, &grip_, &drift_, &surface_}) std::fill(field->begin(), field->end(), 0.0);
        chain_.add_frictionless(h_ * h_, middle_.data(), frictionless_.data());
        chain_.add_damping(h_, velocity_.data(), frictionless_.data());
        for (int k = 0; k < links_; ++k) change_[at(k)] = frictionless_[at(k)] - frictionless_before[k];
        chain_.add_sliding(h_ * h_, middle_.data(), grip_.data());
        std::copy(velocity_.begin() + links_, velocity_.end(), surface_.begin() + links_);
        chain_.add_surface_friction(h_, surface_.data(), grip_.data());
        for (int k = links_; k < m_; ++k) surface_[at(k)] -= sheaves_before[k - links_];
        chain_.add_surface_friction(h_, surface_.data(), drift_.data());
    }
    /// Pulleys, with the mean reaction of friction.
    void close(const LinkKick& kick, const double* v, double* v_end) {
        std::fill(pulleys_.begin(), pulleys_.end(), 0.0);
        chain_.add_reaction(h_, mean_.data(), pulleys_.data());
        for (int k = links_; k < m_; ++k)
            v_end[k] = v[k] + frictionless_[at(k)] + grip_[at(k)] + kick.mean_time * drift_[at(k)] + pulleys_[at(k)];
    }

    const LinearChain& chain_;
    const std::unique_ptr<Kicker> kicker_;
    const int n_, m_, links_;
    double h_ = 0.0;
    Numbers middle_, velocity_, frictionless_, change_, grip_, drift_, surface_, mean_, pulleys_;
};

}  // namespace

std::unique_ptr<StepMap> leapfrog_step(const LinearChain& chain, const Kick& kick) {
    return std::make_unique<Leapfrog>(chain, std::make_unique<ExplicitKicker>(kick));
}

std::unique_ptr<StepMap> backward_euler_leapfrog_step(const LinearChain& chain) {
    return std::make_unique<Leapfrog>(chain, std::make_unique<BackwardEulerKicker>(false));
}

std::unique_ptr<StepMap> held_leapfrog_step(const LinearChain& chain) {
    return std::make_unique<Leapfrog>(chain, std::make_unique<BackwardEulerKicker>(true));
}

// Methods that choose their table by the spectrum and the step.

namespace {

/// Extents of the spectrum for such a method at its start.
class Extents {
public:
    explicit Extents(const LinearChain& chain) : bound_(chain.variator()) {
        (void)bound_.estimate(chain.start().time, chain.start().state.data(), chain.start().phases.data());
    }
    [[nodiscard]] double real() const noexcept { return SpectralChoice::real_margin * bound_.real(); }
    [[nodiscard]] double imaginary() const noexcept { return SpectralChoice::imaginary_margin * bound_.imaginary(); }

private:
    SpectralBound bound_;
};

/// A step of the table that is chosen.
class ChosenStep : public StepMap {
public:
    explicit ChosenStep(const LinearChain& chain) : chain_(chain), extents_(chain), size_(chain.coordinates() + chain.velocities()) {}
    bool prepare(double h) final {
        const auto plan = chosen(extents_, h);
        if (!plan) return false;
        table_ = table_step(chain_, *plan);
        return table_->prepare(h);
    }
    int size() const noexcept final { return size_; }
    void step(const double* from, double* to) final { table_->step(from, to); }

protected:
    [[nodiscard]] virtual std::optional<engine::CompiledPlan> chosen(const Extents& extents, double h) const = 0;

private:
    const LinearChain& chain_;
    const Extents extents_;
    const int size_;
    std::unique_ptr<StepMap> table_;
};

class LadderStep final : public ChosenStep {
public:
    LadderStep(const LinearChain& chain, Ladder ladder) : ChosenStep(chain), ladder_(std::move(ladder)) {}

private:
    [[nodiscard]] std::optional<engine::CompiledPlan> chosen(const Extents& extents, double h) const override {
        return ladder_[table_for(ladder_, extents.real() * h)].plan;
    }
    const Ladder ladder_;
};

class FittedStep final : public ChosenStep {
public:
    using ChosenStep::ChosenStep;

private:
    [[nodiscard]] std::optional<engine::CompiledPlan> chosen(const Extents& extents, double h) const override {
        const auto plan = fitted_plan(fit_headroom * extents.real() * h, fit_headroom * extents.imaginary() * h);
        if (!plan) return {};
        return engine::CompiledPlan(*plan);
    }
};

}  // namespace

std::unique_ptr<StepMap> dumka3_step(const LinearChain& chain) { return std::make_unique<LadderStep>(chain, dumka3_ladder()); }
std::unique_ptr<StepMap> rkc_step(const LinearChain& chain) { return std::make_unique<LadderStep>(chain, rkc_ladder()); }
std::unique_ptr<StepMap> rock2_step(const LinearChain& chain) { return std::make_unique<LadderStep>(chain, rock2_ladder()); }
std::unique_ptr<StepMap> fitted_step(const LinearChain& chain) { return std::make_unique<FittedStep>(chain); }

}  // namespace cvtflow::bench
