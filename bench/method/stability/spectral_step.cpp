/// Methods that choose their table by the spectrum and the step.

#include "bench/method/fitted_method.hpp"
#include "bench/method/product_names.hpp"
#include "bench/method/stability/step_map.hpp"

namespace cvtflow::bench {

namespace {

/// The extents that such a method sees when it begins.
class Extents {
public:
    explicit Extents(const LinearChain& chain) : bound_(chain.variator()) {
        (void)bound_.estimate(chain.start().time, chain.start().state.data(), chain.start().phases.data());
    }
    [[nodiscard]] double real() const noexcept { return SpectralMethod::real_margin * bound_.real(); }
    [[nodiscard]] double imaginary() const noexcept { return SpectralMethod::imaginary_margin * bound_.imaginary(); }

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
