"""Random draws of the effects at an input, at an output, and of the disturbances.

Those that act on one signal are drawn as on a rig of one input and one output.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from labsid.rig.switchable._effect_draws import DRAWS, EffectContext
from labsid.rig.switchable._motion import MASS
from labsid.rig.switchable.coupled.placed_effect import CoupledContext, PlacedEffect
from labsid.rig.switchable.coupled.setup import CoupledSetup, Plant
from labsid.rig.switchable.coupled.units import Units
from labsid.rig.switchable.setup import STEPS_PER_SAMPLE, Actuator, Load, Setup, plain_motion
from labsid.rig.switchable.truth import true_parameters

DrawPlaced = Callable[[np.random.Generator, CoupledContext], PlacedEffect]

_ALSO_MEASURED = ("input-delay", "input-saturation", "input-nonlinearity")
"""Effects that a measured disturbance may have; the others need an actuator."""


def _one_pair(setup: CoupledSetup, i: int, j: int) -> Setup:
    """Actuator, sensor and load of one input and one output; of the plant nothing."""
    return Setup("", plain_motion(MASS, 1.0, 1.0), setup.actuators[i], setup.load, setup.sensors[j])


def _put(parts: tuple[Any, ...], at: int, part: Any) -> tuple[Any, ...]:
    return (*parts[:at], part, *parts[at + 1 :])


def _context(at: CoupledContext, i: int, j: int) -> EffectContext:
    return EffectContext(_one_pair(at.setup, i, j), at.v[:, i], at.y[:, j], at.time)


def _parameters(name: str, i: int, j: int, samples: int) -> Callable[[CoupledSetup, Units], dict[str, Any]]:
    return lambda setup, units: true_parameters(name, _one_pair(setup, i, j), units.pair(i, j), samples)


def _at_input(
    name: str, draw: Callable[[np.random.Generator, EffectContext], Callable[[Setup, float], Setup]]
) -> DrawPlaced:
    def draw_placed(rng: np.random.Generator, at: CoupledContext) -> PlacedEffect:
        measured = at.setup.rig == "valve and supply pressure" and name not in _ALSO_MEASURED
        i = 0 if measured else int(rng.integers(len(at.setup.inputs)))
        one = draw(rng, _context(at, i, 0))

        def apply(setup: CoupledSetup, s: float) -> CoupledSetup:
            actuator = one(_one_pair(setup, i, 0), s).actuator
            return replace(setup, actuators=_put(setup.actuators, i, actuator))

        return PlacedEffect(apply, at.setup.inputs[i], parameters=_parameters(name, i, 0, at.v.shape[0]))

    return draw_placed


def _at_output(
    name: str, draw: Callable[[np.random.Generator, EffectContext], Callable[[Setup, float], Setup]]
) -> DrawPlaced:
    def draw_placed(rng: np.random.Generator, at: CoupledContext) -> PlacedEffect:
        j = int(rng.integers(len(at.setup.outputs)))
        one = draw(rng, _context(at, 0, j))

        def apply(setup: CoupledSetup, s: float) -> CoupledSetup:
            return replace(setup, sensors=_put(setup.sensors, j, one(_one_pair(setup, 0, j), s).sensor))

        return PlacedEffect(apply, at.setup.outputs[j], parameters=_parameters(name, 0, j, at.v.shape[0]))

    return draw_placed


def _quantization(rng: np.random.Generator, at: EffectContext) -> Callable[[Setup, float], Setup]:
    most = float(np.ptp(at.v)) / 3
    return lambda setup, s: replace(setup, actuator=replace(setup.actuator, step=s * most))


def _off(rng: np.random.Generator, at: EffectContext) -> Callable[[Setup, float], Setup]:
    """At strength 1 the command does not act in 15 to 40 % of the record; a level of rest or the last one acts."""
    n = at.v.size
    longest = rng.uniform(0.15, 0.4) * n
    to_the_end, holds = bool(rng.random() < 0.5), bool(rng.random() < 0.5)
    start = int(rng.uniform(0.2, 0.55) * n)

    def apply(setup: Setup, s: float) -> Setup:
        length = round(s * longest)
        if length < 1:
            return setup
        first = n - length if to_the_end else start
        actuator: Actuator = replace(
            setup.actuator,
            off_start=float(first),
            off_stop=np.inf if to_the_end else float(first + length),
            off_level=float(at.v[first - 1]) if holds else 0.0,
        )
        return replace(setup, actuator=actuator)

    return apply


def _output_backlash(rng: np.random.Generator, at: CoupledContext) -> PlacedEffect:
    j = int(rng.integers(len(at.setup.outputs)))
    most = 0.6 * float(np.ptp(at.y[:, j]))
    return PlacedEffect(
        lambda setup, s: replace(setup, plays=_put(setup.plays, j, s * most)),
        at.setup.outputs[j],
        parameters=lambda setup, units: {"width": setup.plays[j] * abs(units.ys[j])},
    )


def _load_ports(plant: Plant) -> list[int]:
    """States on which a load acts: speeds, tanks, and what an input heats or fills."""
    if np.any(plant.speed_of >= 0):
        return [int(k) for k in plant.speed_of if k >= 0]
    return [k for k in range(plant.A.shape[0]) if plant.flow[k, k] or np.any(plant.B[k])]


def _loaded(setup: CoupledSetup, load: Load, state: int) -> CoupledSetup:
    """With a load on one state; a load of one has about the effect of an input of one."""
    p = setup.plant
    gain = np.zeros(p.A.shape[0])
    gain[state] = np.abs(p.B[state]).sum() or abs(p.flow[state, state])
    return replace(setup, load=load, load_gain=gain)


def _inputs_at(setup: CoupledSetup, state: int) -> tuple[str, ...]:
    """Inputs that act on this state and no other, of which a load there cannot be told apart."""
    B = setup.plant.B
    return tuple(name for i, name in enumerate(setup.inputs) if np.flatnonzero(B[:, i]).tolist() == [state])


def _load_step(rng: np.random.Generator, at: CoupledContext) -> PlacedEffect:
    state = int(rng.choice(_load_ports(at.setup.plant)))
    onset = round(rng.uniform(0.2, 0.8) * at.v.shape[0] * STEPS_PER_SAMPLE) / STEPS_PER_SAMPLE
    size = float(rng.choice([-1.0, 1.0]))

    def apply(setup: CoupledSetup, s: float) -> CoupledSetup:
        return _loaded(setup, Load(onset=onset, size=s * size), state) if s else setup

    return PlacedEffect(
        apply,
        None,
        _inputs_at(at.setup, state),
        parameters=lambda setup, units: {"onset": onset * units.Ts},
    )


def _periodic(rng: np.random.Generator, at: CoupledContext) -> PlacedEffect:
    """A sinusoid of the load or of one sensor."""
    j = int(rng.integers(len(at.setup.outputs)))
    state = int(rng.choice(_load_ports(at.setup.plant)))
    apply_wave = DRAWS["periodic-disturbance"](rng, _context(at, 0, j))
    at_load = apply_wave(_one_pair(at.setup, 0, j), 1.0).load.amplitude != 0.0

    def apply(setup: CoupledSetup, s: float) -> CoupledSetup:
        pair = apply_wave(_one_pair(setup, 0, j), s)
        if at_load:
            return _loaded(setup, pair.load, state) if s else setup
        return replace(setup, sensors=_put(setup.sensors, j, pair.sensor))

    signal, also = (None, _inputs_at(at.setup, state)) if at_load else (at.setup.outputs[j], (None,))
    return PlacedEffect(apply, signal, also, parameters=_parameters("periodic-disturbance", 0, j, at.v.shape[0]))


_ONE_INPUT = ("delay", "saturation", "dead-zone", "backlash", "rate-limit", "nonlinearity")
_ONE_OUTPUT = ("saturation", "nonlinearity", "quantization", "dropout", "outliers", "drift")

INPUT_DRAWS: dict[str, DrawPlaced] = {
    **{f"input-{kind}": _at_input(f"input-{kind}", DRAWS[f"input-{kind}"]) for kind in _ONE_INPUT},
    "input-quantization": _at_input("input-quantization", _quantization),
    "input-off": _at_input("input-off", _off),
}
OUTPUT_DRAWS: dict[str, DrawPlaced] = {
    **{f"output-{kind}": _at_output(f"output-{kind}", DRAWS[f"output-{kind}"]) for kind in _ONE_OUTPUT},
    "output-backlash": _output_backlash,
}
DISTURBANCE_DRAWS: dict[str, DrawPlaced] = {"load-step": _load_step, "periodic-disturbance": _periodic}
