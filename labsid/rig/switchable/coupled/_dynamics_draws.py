"""Random draws of the effects in the dynamics, each at one place of the plant."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.rig.switchable.coupled.placed_effect import CoupledContext, PlacedEffect
from labsid.rig.switchable.coupled.setup import CoupledSetup, with_states
from labsid.rig.switchable.coupled.units import Units

DrawPlaced = Callable[[np.random.Generator, CoupledContext], PlacedEffect]


def _entry(array: FloatArray, place: int | tuple[int, int], value: float) -> FloatArray:
    """Copy of an array with one other entry."""
    changed = array.copy()
    changed[place] = value
    return changed


def _in_plant(setup: CoupledSetup, **arrays: Any) -> CoupledSetup:
    return replace(setup, plant=replace(setup.plant, **arrays))


def _tank(rng: np.random.Generator, at: CoupledContext) -> int:
    return int(rng.choice(np.flatnonzero(np.diag(at.setup.plant.flow))))


def _tank_name(at: CoupledContext, tank: int) -> str:
    """The output that shows the level of a tank, or ``above`` and the output of the tank that it fills."""
    p = at.setup.plant
    shown = [j for j, row in enumerate(p.C) if row[tank]]
    if shown:
        return at.setup.outputs[shown[0]]
    filled = np.flatnonzero(p.flow[:, tank] > 0.0)
    return f"above {at.setup.outputs[int(np.flatnonzero(p.C[:, filled[0]])[0])]}"


def _level(at: CoupledContext, tank: int, level: float, units: Units) -> float | None:
    """Level of a tank in units of the output that shows it; None if none does."""
    shown = np.flatnonzero(at.setup.plant.C[:, tank])
    return units.y0[shown[0]] + units.ys[shown[0]] * level if shown.size else None


def _sqrt_outflow(rng: np.random.Generator, at: CoupledContext) -> PlacedEffect:
    tank = _tank(rng, at)
    most = 0.95 / max(-float(at.states[:, tank].min()), 0.2)
    return PlacedEffect(
        lambda setup, s: _in_plant(setup, curvature=_entry(setup.plant.curvature, tank, s * most)) if s else setup,
        None,
        parameters=lambda setup, units: {
            "tank": _tank_name(at, tank),
            "zero": _level(at, tank, -1 / float(setup.plant.curvature[tank]), units),
        },
    )


def _overflow(rng: np.random.Generator, at: CoupledContext) -> PlacedEffect:
    tank = _tank(rng, at)
    top = float(at.states[:, tank].max())
    return PlacedEffect(
        lambda setup, s: _in_plant(setup, brim=_entry(setup.plant.brim, tank, top * (1 - 0.8 * s))) if s else setup,
        None,
        parameters=lambda setup, units: {
            "tank": _tank_name(at, tank),
            "level": _level(at, tank, float(setup.plant.brim[tank]), units),
        },
    )


def _joint(rng: np.random.Generator, at: CoupledContext) -> tuple[int, int, float]:
    """Position and speed of a joint, and acceleration per unit of its torque."""
    q = int(rng.choice(np.flatnonzero(at.setup.plant.speed_of >= 0)))
    w = int(at.setup.plant.speed_of[q])
    return q, w, float(at.setup.plant.B[w, q])


def _friction(rng: np.random.Generator, at: CoupledContext) -> PlacedEffect:
    q, w, per_torque = _joint(rng, at)
    most = 0.6 * float(np.std(at.v[:, q])) + 0.2
    return PlacedEffect(
        lambda setup, s: (
            _in_plant(setup, friction=_entry(setup.plant.friction, w, s * most * per_torque)) if s else setup
        ),
        None,
        parameters=lambda setup, units: {
            "joint": q + 1,
            "friction": float(setup.plant.friction[w]) / per_torque * abs(units.us[q]),
        },
    )


def _cubic(rng: np.random.Generator, at: CoupledContext) -> PlacedEffect:
    q, w, per_torque = _joint(rng, at)
    most = (3.0 if rng.random() < 0.7 else -0.12) / float(np.max(np.abs(at.states[:, q]))) ** 2
    return PlacedEffect(
        lambda setup, s: (
            _in_plant(setup, cubic=_entry(setup.plant.cubic, (w, q), -s * most * per_torque)) if s else setup
        ),
        None,
        parameters=lambda setup, units: {
            "joint": q + 1,
            "cubic": -float(setup.plant.cubic[w, q]) / per_torque / units.ys[q] ** 2,
        },
    )


def _end_stop(rng: np.random.Generator, at: CoupledContext) -> PlacedEffect:
    """One or two stops, which move towards the rest position as the strength grows."""
    q, _, _ = _joint(rng, at)
    sides = str(rng.choice(["low", "high", "both"]))
    reach = 0.85 * rng.uniform(0.6, 1.0, 2)
    x = at.states[:, q]
    margin = 0.1 * float(np.ptp(x))
    low, high = min(float(x.min()), -margin), max(float(x.max()), margin)

    def apply(setup: CoupledSetup, s: float) -> CoupledSetup:
        if s and sides != "high":
            setup = _in_plant(setup, stop_low=_entry(setup.plant.stop_low, q, low * (1 - s * reach[0])))
        if s and sides != "low":
            setup = _in_plant(setup, stop_high=_entry(setup.plant.stop_high, q, high * (1 - s * reach[1])))
        return setup

    def parameters(setup: CoupledSetup, units: Units) -> dict[str, float]:
        ends = {"low": setup.plant.stop_low[q], "high": setup.plant.stop_high[q]}
        levels = {name: units.y0[q] + units.ys[q] * float(end) for name, end in ends.items() if np.isfinite(end)}
        swapped = {"low": "high", "high": "low"}
        return levels if units.ys[q] > 0 else {swapped[name]: level for name, level in levels.items()}

    return PlacedEffect(apply, None, parameters=lambda setup, units: {"joint": q + 1, **parameters(setup, units)})


def _extra_lag(rng: np.random.Generator, at: CoupledContext) -> PlacedEffect:
    """A lag of one actuator or of one sensor."""
    signals = (*at.setup.inputs, *at.setup.outputs)
    place = int(rng.integers(len(signals)))
    longest = min(1.2 * at.time, 40.0)
    nu = len(at.setup.inputs)
    n = at.setup.plant.A.shape[0]

    def apply(setup: CoupledSetup, s: float) -> CoupledSetup:
        if not s:
            return setup
        lagged = with_states(setup, 1)
        p, rate = lagged.plant, 1 / (s * longest)
        A = _entry(p.A, (n, n), -rate)
        B, C = p.B.copy(), p.C.copy()
        if place < nu:
            A[:n, n] = B[:n, place]
            B[:, place] = 0.0
            B[n, place] = rate
        else:
            A[n, :n] = rate * C[place - nu, :n]
            C[place - nu] = 0.0
            C[place - nu, n] = 1.0
        return _in_plant(lagged, A=A, B=B, C=C)

    return PlacedEffect(
        apply,
        None,
        (signals[place],),
        parameters=lambda setup, units: {"tau": -units.Ts / float(setup.plant.A[n, n])},
    )


def _resonance(rng: np.random.Generator, at: CoupledContext) -> PlacedEffect:
    """A lightly damped mode in series with one input, or in parallel from one input to one output."""
    i = int(rng.integers(len(at.setup.inputs)))
    damping = float(np.exp(rng.uniform(np.log(0.01), np.log(0.08))))
    parallel = bool(rng.random() < 0.5)
    j, sign = int(rng.integers(len(at.setup.outputs))), float(rng.choice([-1.0, 1.0]))
    longest = max(min(2.0 * at.time, 45.0), 6.0)
    fixed_period = float(rng.uniform(4.0, longest))
    m = at.setup.plant.A.shape[0]

    def apply(setup: CoupledSetup, s: float) -> CoupledSetup:
        if not s:
            return setup
        period = fixed_period if parallel else 3.0 + s * (longest - 3.0)
        w = 2 * np.pi / period
        moded = with_states(setup, 2)
        p = moded.plant
        A, B, C = p.A.copy(), p.B.copy(), p.C.copy()
        A[m, m + 1], A[m + 1, m], A[m + 1, m + 1] = 1.0, -(w**2), -2 * damping * w
        if parallel:
            C[j, m] = 0.8 * s * sign
        else:
            A[:m, m] = B[:m, i]
            B[:, i] = 0.0
        B[m + 1, i] = w**2
        return _in_plant(moded, A=A, B=B, C=C)

    return PlacedEffect(
        apply,
        None,
        (at.setup.inputs[i], at.setup.outputs[j]) if parallel else (at.setup.inputs[i],),
        parameters=lambda setup, units: {
            "frequency": float(np.sqrt(-setup.plant.A[m + 1, m])) / (2 * np.pi * units.Ts),
            "damping": damping,
        },
    )


DYNAMICS_DRAWS: dict[str, DrawPlaced] = {
    "extra-lag": _extra_lag,
    "resonance": _resonance,
    "sqrt-outflow": _sqrt_outflow,
    "overflow": _overflow,
    "coulomb-friction": _friction,
    "cubic-stiffness": _cubic,
    "end-stop": _end_stop,
}
