"""The row `loop`: pendulums and an axis with their controller, with one effect or none."""

from dataclasses import replace

import numpy as np
from scipy.signal import cont2discrete, lfilter

from labsid._arrays import FloatArray
from labsid.blind.draws import log_uniform
from labsid.blind.exercised import is_exercised
from labsid.blind.experiment import OrdinaryCase
from labsid.blind.output_error import discrete_poles, projected_residual
from labsid.blind.placed_effects import placed_label
from labsid.blind.several_inputs import linear_error
from labsid.blind.signals import FEWEST_SAMPLES, MOST_LOUDER, MOST_SAMPLES, NOISE_SHARES, signal_files
from labsid.blind.strength import CLEAR_RATIOS, HARD_RATIOS, NEGLIGIBLE_RATIO, find_strength
from labsid.rig.ordinary.record_files import OrdinaryRecord
from labsid.rig.switchable.coupled.effects import draw_placed_effect
from labsid.rig.switchable.coupled.loop_rigs import UNBOUNDED_RIGS, Controller, draw_loop_rig
from labsid.rig.switchable.coupled.loop_simulation import LoopRun, simulate_loop
from labsid.rig.switchable.coupled.placed_effect import CoupledContext, PlacedEffect
from labsid.rig.switchable.coupled.plants import coupled_poles
from labsid.rig.switchable.coupled.setup import CoupledSetup, Plant, linearised
from labsid.rig.switchable.coupled.units import draw_units
from labsid.rig.switchable.inputs import RICH_INPUTS, draw_input
from labsid.rig.switchable.simulation import Noise, UnboundedOutputError

LOOP_EFFECTS = (
    *("coulomb-friction", "input-dead-zone", "none", "output-nonlinearity", "input-delay", "load-step"),
    *("input-saturation", "cubic-stiffness", "input-backlash", "none", "end-stop", "input-quantization"),
    *("input-nonlinearity", "output-saturation", "input-rate-limit", "extra-lag"),
)
"""Effects of the row, which take turns."""

RIG_ORDER = ("upright pendulum", "upright pendulum", "hanging pendulum", "upright pendulum", "axis")
"""Rigs of the row, which take turns."""

SLOWEST_OBSERVER = 40.0
"""Time constant in samples with which a stabilised run follows the output of an integrating rig."""


def draw_loop(rng: np.random.Generator, i: int, name: str) -> OrdinaryCase | None:
    """A rig held by its controller: the logged reference, input and output."""
    effect, rig = LOOP_EFFECTS[i % len(LOOP_EFFECTS)], RIG_ORDER[i % len(RIG_ORDER)]
    samples = int(rng.integers(FEWEST_SAMPLES, MOST_SAMPLES + 1))
    plain, controller = draw_loop_rig(rng, rig)
    time = float(1 / np.max(np.abs(coupled_poles(plain.plant))))
    r = draw_input(rng, str(rng.choice(RICH_INPUTS)), samples, time, True)
    quiet = simulate_loop(plain, controller, r, Noise(0.0))
    controller = replace(controller, limit=float(rng.uniform(0.85, 1.4) * np.max(np.abs(quiet.u))))
    spread = float(np.std(quiet.y))
    noise = Noise(log_uniform(rng, *NOISE_SHARES) * spread, seed=int(rng.integers(2**31)))
    if effect == "none":
        if linear_loop_gap(plain, simulate_loop(plain, controller, r, noise)) > NEGLIGIBLE_RATIO * noise.sd:
            return None
        return _complete(rng, plain, plain, controller, r, noise, name, None)
    context = CoupledContext(plain, quiet.u[:, np.newaxis], quiet.y[:, np.newaxis], quiet.states, time)
    placed = draw_placed_effect(rng, effect, context)

    def gap_at(s: float, thorough: bool) -> float:
        try:
            return linear_loop_gap(plain, simulate_loop(placed.apply(plain, s), controller, r, noise))
        except UnboundedOutputError:
            return np.inf

    share = noise.sd / spread
    ratio = log_uniform(rng, HARD_RATIOS[0] * 2, CLEAR_RATIOS[1])
    strength = find_strength(gap_at, spread, ratio, (0.95 * share, 1.05 * share), rng)
    if strength is None:
        return None
    setup, noise = placed.apply(plain, strength[0]), replace(noise, sd=strength[1])
    run = simulate_loop(setup, controller, r, noise)
    if not is_exercised(effect, setup, run.u[:, np.newaxis], run.states, run.clean[:, np.newaxis]):
        return None
    if linear_loop_gap(plain, run) < HARD_RATIOS[0] * noise.sd or np.std(run.clean) > MOST_LOUDER * spread:
        return None
    return _complete(rng, plain, setup, controller, r, noise, name, placed)


def linear_loop_gap(plain: CoupledSetup, run: LoopRun) -> float:
    """Rms error of the best linear model that is driven by the logged input, without the noise of the output.

    A stable rig runs freely. One that is unstable or integrates follows the output by an observer whose poles are
    those of the rig without effects, the unstable ones mirrored at the unit circle.

    Parameters
    ----------
    plain : CoupledSetup
        The rig without effects.
    run : LoopRun

    Returns
    -------
    float
    """
    if plain.rig not in UNBOUNDED_RIGS:
        start = discrete_poles(coupled_poles(plain.plant))
        return linear_error(run.u[:, np.newaxis], run.clean, start, delay=1)
    return stabilised_error(run.u, run.clean, observer(plain.plant))


def observer(plant: Plant) -> FloatArray:
    """Characteristic polynomial of the observer of a stabilised run, in powers of the delay operator.

    Parameters
    ----------
    plant : Plant

    Returns
    -------
    ndarray, shape (n + 1,)
    """
    A, B, C = linearised(plant)
    discrete, *_ = cont2discrete((A, B, C, np.zeros((1, 1))), 1.0)
    poles = np.linalg.eigvals(discrete).astype(complex)
    slowest = np.exp(-1 / SLOWEST_OBSERVER)
    mirrored = np.where(np.abs(poles) > 1 + 1e-9, 1 / poles.conj(), poles)
    return np.real(np.poly(np.where(np.abs(mirrored) > slowest, slowest, mirrored)))


def stabilised_error(u: FloatArray, y: FloatArray, F: FloatArray) -> float:
    """Rms of y - y_sim for the best ``F y_sim = B u + (F - A) y``, with offset and free initial state.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
    F : ndarray, shape (n + 1,)
        Polynomial of the observer.

    Returns
    -------
    float

    Notes
    -----
    ``y - y_sim = (A y - B u) / F`` is linear in the coefficients of A and B.
    """
    n = F.size - 1
    impulse = np.zeros(y.size)
    impulse[0] = 1.0
    filtered_u, filtered_y, free = (lfilter([1.0], F, x) for x in (u - u[0], y - y[0], impulse))
    columns = [_late(filtered_y, k) for k in range(1, n + 1)] + [_late(filtered_u, k) for k in range(1, n + 2)]
    columns += [_late(free, k) for k in range(n)] + [np.ones(y.size)]
    residual = projected_residual(np.column_stack(columns), filtered_y, np.ones(y.size))
    return float(np.sqrt(np.mean(residual**2)))


def _late(x: FloatArray, samples: int) -> FloatArray:
    return np.concatenate([np.zeros(samples), x[: x.size - samples]])


def _complete(
    rng: np.random.Generator,
    plain: CoupledSetup,
    setup: CoupledSetup,
    controller: Controller,
    r: FloatArray,
    noise: Noise,
    name: str,
    placed: PlacedEffect | None,
) -> OrdinaryCase:
    run = simulate_loop(setup, controller, r, noise)
    units = draw_units(rng, 1, 1)
    t = units.Ts * np.arange(r.size, dtype=np.float64)
    columns = [
        units.y(r[:, np.newaxis])[:, 0],
        units.u(run.u[:, np.newaxis])[:, 0],
        units.y(run.y[:, np.newaxis])[:, 0],
    ]
    options = ("--reference", "r")
    effects = [] if placed is None else [placed_label(placed, setup, units, {"y": np.inf})]
    truth = {
        "effects": effects,
        "ratio": linear_loop_gap(plain, run) / noise.sd,
        "noise": {"y": abs(units.ys[0]) * noise.sd},
        "mode": "stabilised" if plain.rig in UNBOUNDED_RIGS else "free",
        "samples": r.size,
        "Ts": units.Ts,
    }
    made = OrdinaryRecord(
        answers=(tuple(effect["name"] for effect in effects),),
        files=signal_files(("r", "u", "y"), t, columns, options),
        truth=truth,
        options=options,
    )
    return OrdinaryCase(name=name, row="loop", kind=plain.rig, made=made)
