#pragma once
/// Forces on the housing and torque of the shafts by orders of the chain's revolution, of a simulation.

#include <string>

#include "bench/study/noise/tonality.hpp"
#include "engine/executor/cancellation.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::bench {

inline constexpr int noise_harmonics = 5;  ///< of the pin passing, up to which spectra reach

struct NoiseSpectrum {
    std::string fault;         ///< why there is no spectrum of a simulation; empty: there is one
    double round = 0.0;        ///< turns of the chain per second [Hz]
    OrderPowers force;         ///< radial forces of both shafts on their bearings, sum of the squares [N²]
    OrderPowers torque;        ///< of the chain on both shafts, sum of the squares [N² m²]
    double force_tone = 0.0;   ///< tonality() of both [dB]
    double torque_tone = 0.0;  ///< likewise [dB]
    double wall = 0.0;         ///< [s]

    [[nodiscard]] bool simulated() const noexcept { return wall > 0.0; }
    [[nodiscard]] bool usable() const noexcept { return simulated() && fault.empty(); }
    /// The larger of both [dB].
    [[nodiscard]] double tone() const noexcept { return force_tone > torque_tone ? force_tone : torque_tone; }
};

/// Settles the scene's chain if its start is geometric, then takes `rounds` whole revolutions of its first pin.
[[nodiscard]] NoiseSpectrum measure_noise(tasks::Scene scene, int rounds, const engine::Cancellation& cancel);

}  // namespace cvtflow::bench
