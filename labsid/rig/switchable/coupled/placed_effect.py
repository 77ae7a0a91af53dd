"""An effect at one signal of a rig, and what its draw needs to know of the rig."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from labsid._arrays import FloatArray
from labsid.rig.switchable.coupled.setup import CoupledSetup
from labsid.rig.switchable.coupled.units import Units


@dataclass(frozen=True, slots=True, eq=False)
class CoupledContext:
    """Information for drawing an effect: the rig without effects, its inputs, states and outputs.

    Attributes
    ----------
    setup : CoupledSetup
    v : ndarray, shape (N, nu)
        Commands.
    y : ndarray, shape (N, ny)
        Outputs of the rig without effects.
    states : ndarray, shape (N, n)
    time : float
        Time scale of the rig in samples.
    """

    setup: CoupledSetup
    v: FloatArray
    y: FloatArray
    states: FloatArray
    time: float


def _no_parameters(setup: CoupledSetup, units: Units) -> dict[str, Any]:
    return {}


@dataclass(frozen=True, slots=True, eq=False)
class PlacedEffect:
    """An effect, and the signal at which it acts.

    Attributes
    ----------
    apply : callable
        ``apply(setup, strength) -> setup`` with strength from 0, which changes nothing, to 1.
    signal : str or None
        Name of the input or output; None in the dynamics.
    also : tuple of (str or None)
        Other right answers to where it acts: a lag of one actuator is an effect of the dynamics at that input.
    name : str
    parameters : callable
        ``parameters(setup, units) -> dict``, the true parameters in the record's units and seconds.
    """

    apply: Callable[[CoupledSetup, float], CoupledSetup]
    signal: str | None
    also: tuple[str | None, ...] = ()
    name: str = ""
    parameters: Callable[[CoupledSetup, Units], dict[str, Any]] = field(default=_no_parameters)

    @property
    def signals(self) -> tuple[str | None, ...]:
        """All right answers to where it acts."""
        return (self.signal, *self.also)
