"""The effects that the diagnosis names, on rigs of several signals: each at one signal or place in the dynamics."""

from dataclasses import replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.rig.switchable.coupled._dynamics_draws import DYNAMICS_DRAWS
from labsid.rig.switchable.coupled._signal_draws import DISTURBANCE_DRAWS, INPUT_DRAWS, OUTPUT_DRAWS
from labsid.rig.switchable.coupled.loop_rigs import LOOP_RIGS
from labsid.rig.switchable.coupled.placed_effect import CoupledContext, PlacedEffect
from labsid.rig.switchable.coupled.plants import RIGS, coupled_time_scale
from labsid.rig.switchable.coupled.setup import CoupledSetup
from labsid.rig.switchable.coupled.simulation import plant_outputs, plant_states
from labsid.rig.switchable.setup import STEPS_PER_SAMPLE

_DRAWS = INPUT_DRAWS | DYNAMICS_DRAWS | OUTPUT_DRAWS | DISTURBANCE_DRAWS

EFFECTS = (
    *("input-saturation", "coulomb-friction", "output-saturation", "load-step"),
    *("input-dead-zone", "sqrt-outflow", "input-delay", "output-nonlinearity"),
    *("input-backlash", "overflow", "output-dropout", "periodic-disturbance"),
    *("input-rate-limit", "extra-lag", "output-backlash", "input-off"),
    *("input-nonlinearity", "end-stop", "output-drift", "input-quantization"),
    *("cubic-stiffness", "output-quantization", "resonance", "output-outliers"),
)
"""The order determines the cases of the sealed check."""

_JOINTS, _TANKS = ("two joints", *LOOP_RIGS), ("two pairs of tanks", "valve and supply pressure")
_RIGS_OF = {
    "sqrt-outflow": _TANKS,
    "overflow": _TANKS,
    "coulomb-friction": _JOINTS,
    "cubic-stiffness": _JOINTS,
    "end-stop": _JOINTS,
    "resonance": _JOINTS,
}


def rigs_with(effect: str) -> tuple[str, ...]:
    """Rigs of several signals on which an effect is physically possible.

    Parameters
    ----------
    effect : str
        One of `EFFECTS`.

    Returns
    -------
    tuple of str
    """
    return tuple(rig for rig in RIGS if _supports(rig, effect))


def _supports(rig: str, effect: str) -> bool:
    return rig in _RIGS_OF.get(effect, (rig,))


def coupled_context(setup: CoupledSetup, v: FloatArray) -> CoupledContext:
    """Run the rig without effects and collect the information for drawing an effect.

    Parameters
    ----------
    setup : CoupledSetup
    v : ndarray, shape (N, nu)

    Returns
    -------
    CoupledContext
    """
    states = plant_states(setup, v)[::STEPS_PER_SAMPLE]
    return CoupledContext(
        setup=setup, v=v, y=plant_outputs(setup, v), states=states, time=coupled_time_scale(setup.plant)
    )


def draw_placed_effect(rng: np.random.Generator, name: str, context: CoupledContext) -> PlacedEffect:
    """Draw an effect and the signal or the place in the dynamics at which it acts.

    Parameters
    ----------
    rng : Generator
    name : str
        One of `EFFECTS`.
    context : CoupledContext

    Returns
    -------
    PlacedEffect

    Raises
    ------
    ValueError
        If there is no such effect, or the rig does not support it.
    """
    if name not in _DRAWS:
        raise ValueError(f"name must be one of {', '.join(EFFECTS)}; got {name!r}. Name one of these.")
    if not _supports(context.setup.rig, name):
        raise ValueError(f"a rig of {context.setup.rig} cannot have {name}. Draw another rig.")
    return replace(_DRAWS[name](rng, context), name=name)
