"""Finds a sequence of two pitches whose chain sounds less tonal than one of equal links.

    quieter_pitches.py [SCENE] [--random 6] [--searched 4] [--moves 300] [--spread 0.08] [--threads 2]

Random sequences, simulated at `rigid`, show how forces on the bearings and torques on the shafts respond to impulses at the pins' places,
order by order of the chain's revolution. With this response a sum of impulses predicts the tonality of any sequence. A search exchanges
links as long as the prediction does not grow, and the results are simulated. Prints the best one as a setting.
"""

import argparse
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from scipy.stats import spearmanr

import cvtflow

INTERVAL, HARMONICS = 20e-6, 5  # outputs [s]; harmonics of the pin passing that spectra reach
FORCES = [f"shaft_{shaft}/bearing_force[{axis}]" for shaft in (1, 2) for axis in (0, 1)]
TORQUES = ["shaft_1/chain_torque", "shaft_2/chain_torque"]


def critical_bandwidth(frequency: Any) -> Any:
    """Width of the ear's critical band around a frequency [Hz]. (Zwicker and Terhardt 1980; ECMA-418-1)"""
    return 25.0 + 75.0 * (1.0 + 1.4 * (1e-3 * frequency) ** 2) ** 0.69


def other_edge(edge: Any, side: int) -> Any:
    """The other edge of the critical band that ends at `edge` [Hz]; side: -1 below, 1 above."""
    width = critical_bandwidth(edge)
    for _ in range(6):
        width = critical_bandwidth(np.sqrt(edge * np.maximum(0.0, edge + side * width)))
    return np.maximum(0.0, edge + side * width)


class Tonality:
    """Largest prominence ratio of a critical band over its two neighbours [dB], after ECMA-418-1, section 12, simplified. Bands are
    centred at every order from half of the pin passing to 3.5 times of it, except those 20 dB weaker than the strongest; a background of
    -60 dB is added. round_: frequency of order 1 [Hz]."""

    def __init__(self, round_: float, pins: int) -> None:
        middle = np.arange((pins + 1) // 2, 7 * pins // 2 + 1) * round_
        width = critical_bandwidth(middle)
        lower = -0.5 * width + np.sqrt(0.25 * width**2 + middle**2)
        upper = lower + width
        self.edges = np.array([other_edge(lower, -1), lower, upper, other_edge(upper, 1)]) / round_

    def __call__(self, powers: Any) -> float:
        """powers: mean squares at orders 0, 1, … up to 5 times the pin passing; each line is spread over one order."""
        sums = np.concatenate([[0.0], np.cumsum(powers)])
        below, middle, above = np.diff(np.interp(self.edges + 0.5, np.arange(len(sums)), sums), axis=0)
        strongest = middle.max()
        loud = middle >= 0.01 * strongest
        return float(10.0 * np.log10((middle / np.maximum(0.5 * (below + above), 1e-6 * strongest))[loud].max()))


def impulses(steps: Any, spread: float) -> Any:
    """Powers of equal impulses at the pins' places, by order, relative to those of a uniform chain at multiples of the pin passing.
    steps: 1 for a long link, -1 for a short one."""
    places = np.concatenate([[0.0], np.cumsum(1.0 + spread * steps)[:-1]]) / len(steps)
    orders = np.arange(HARMONICS * len(steps) + 1)
    return np.abs(np.exp(2j * np.pi * np.outer(orders, places)).mean(axis=1)) ** 2


def powers_of(signal: Any, turns: Any, last: int) -> Any:
    """Mean squares by order of one revolution, without the straight line from the first value to the last."""
    even = np.linspace(0.0, 1.0, 16 * last, endpoint=False)
    values = np.interp(even, turns, signal) - np.interp(even, [0.0, 1.0], np.interp([0.0, 1.0], turns, signal))
    powers = 2.0 * np.abs(np.fft.rfft(values, norm="forward")[: last + 1]) ** 2
    powers[0] = 0.0
    return powers


def simulated(scene: cvtflow.Scene, steps: Any, spread: float) -> tuple[float, Any]:
    """Frequency of the chain's revolution [Hz], and powers by order of the forces and of the torques [2][orders]."""
    pins, mean = len(steps), float(np.mean(scene["chain.pitch"]))
    simulation = cvtflow.Simulation(scene.with_({"chain.pitch": [float(pitch) for pitch in mean * (1.0 + spread * steps)]}))
    simulation.advance_to(0.0)
    until = 1.3 * mean * pins / float(simulation.channel("chain_speed")[0])
    rows = cvtflow.run(simulation, until, channels=["followed_pin/position", *FORCES, *TORQUES], interval=INTERVAL)
    pin = rows["followed_pin/position"]
    arms = (pin[:, 0] - np.median(pin[:, 0])) + 1j * (pin[:, 1] - 0.5 * (pin[:, 1].min() + pin[:, 1].max()))
    turns = np.abs(np.unwrap(np.angle(arms / arms[0]))) / (2.0 * np.pi)
    end = float(np.interp(1.0, turns, rows["time"]))
    share = (rows["time"] - rows["time"][0]) / (end - rows["time"][0])
    last = HARMONICS * pins
    powers = [sum(powers_of(rows[name], share, last) for name in names) for names in (FORCES, TORQUES)]
    return 1.0 / (end - rows["time"][0]), np.array(powers)


def climbed(steps: Any, expected: Any, moves: int, chance: Any) -> Any:
    """Exchanges two links at a time as long as the expected tonality does not grow."""
    lowest = expected(steps)
    for first, second in chance.integers(len(steps), size=(moves, 2)):
        changed = steps.copy()
        changed[[first, second]] = steps[[second, first]]
        if steps[first] != steps[second] and (now := expected(changed)) <= lowest:
            steps, lowest = changed, now
    return steps


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?", default="baseline")
    for name, default in (("random", 6), ("searched", 4), ("moves", 300), ("threads", 2), ("seed", 1)):
        parser.add_argument(f"--{name}", type=int, default=default)
    parser.add_argument("--spread", type=float, default=0.08, help="difference of the pitches from their mean, as a share of it")
    parser.add_argument("--settling", default="20 ms")
    options = parser.parse_args()
    scene = cvtflow.Scene.ready(options.scene).with_detail("rigid").with_({"start.state": "", "start.settling_time": options.settling})
    chance, pins = np.random.default_rng(options.seed), int(scene["chain.pins"])
    with ThreadPoolExecutor(options.threads) as pool:
        def spectra(sequences: Any) -> Any:
            return list(pool.map(lambda steps: simulated(scene, steps, options.spread), sequences))

        round_, uniform = spectra([np.zeros(pins)])[0]
        tonality = Tonality(round_, pins)
        links = np.repeat([-1.0, 1.0], pins // 2)  # an even number of pins
        mixed = [chance.permutation(links) for _ in range(options.random)]
        found = spectra(mixed)
        response = sum(powers for _, powers in found) / sum(impulses(steps, options.spread) for steps in mixed)

        def expected(steps: Any) -> float:
            return max(tonality(signal) for signal in response * impulses(steps, options.spread))

        searched = [climbed(chance.permutation(links), expected, options.moves, chance) for _ in range(options.searched)]
        all_, found = mixed + searched, found + spectra(searched)
    tones = [max(tonality(signal) for signal in powers) for _, powers in found]
    best = int(np.argmin(tones))
    passing = 10.0 * np.log10(found[best][1][:, pins] / uniform[:, pins])
    print(f"uniform: tonality {max(tonality(signal) for signal in uniform):.1f} dB; {len(mixed)} random: "
          f"{np.mean(tones[: len(mixed)]):.1f} dB in the mean; best of {len(searched)} searched: {min(tones[len(mixed):]):.1f} dB")
    print(f"best of all: {tones[best]:.1f} dB; passing pins {passing[0]:+.1f} dB (force), {passing[1]:+.1f} dB (torque); "
          f"ranks of prediction and simulation agree by {spearmanr([expected(steps) for steps in all_], tones)[0]:.2f}")
    pitches = np.mean(scene["chain.pitch"]) * (1.0 + options.spread * all_[best])
    print(f"--set chain.pitch=[{','.join(f'{pitch:.7g}' for pitch in pitches)}]")


main()
