"""Coupled outputs, each explained through its own input and the measured other outputs, as the joints of an arm.

A mass that another one pulls moves as if the measured position of that one were a further input. Each output is then a
system of second order on its own, in which an effect can be found; the error is that of all of them simulated together.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.fits.fitting import Fit
from labsid.gap.model_file import export_model
from labsid.gap.record.data import Data
from labsid.gap.signals.input_responses import LinearParts
from labsid.gap.signals.roles import Signals

MOST_ROUNDS = 60  # of simulations of all outputs, each with the others of the round before; numerics
SETTLED = 1e-4  # change in a round, over the standard deviation of an output; numerics
DIVERGED = 1e3  # standard deviations of an output; numerics


@dataclass(frozen=True, slots=True, eq=False)
class Coupled:
    """One of several outputs that are simulated together.

    Attributes
    ----------
    signals : Signals
        The output, with its own input and the other outputs as inputs, of the fitted record.
    data : Data
    fit : Fit
    """

    signals: Signals
    data: Data
    fit: Fit


def own_input(parts: Sequence[LinearParts]) -> list[int] | None:
    """The input that moves each output most; None if two outputs have the same one."""
    strongest = [own.strongest for own in parts]
    return strongest if len(set(strongest)) == len(strongest) and len(strongest) > 1 else None


def with_neighbours(signals: Signals, j: int, main: int) -> Signals:
    """One output, with its own input and the other outputs as inputs."""
    others = [k for k in range(len(signals.outputs)) if k != j]
    return replace(
        signals,
        u=np.column_stack([signals.u[:, main], signals.y[:, others]]),
        y=signals.y[:, [j]],
        rows=signals.rows[:, [j]],
        inputs=(signals.inputs[main], *(signals.outputs[k] for k in others)),
        outputs=(signals.outputs[j],),
    )


def simulate_together(signals: Signals, outputs: Sequence[Coupled], elsewhere: bool = False) -> FloatArray | None:
    """Free run of all outputs: each is simulated with the others as simulated before, until nothing changes.

    Parameters
    ----------
    signals : Signals
        The measured outputs are the start.
    outputs : sequence of Coupled
    elsewhere : bool
        Whether `signals` are another record than the fitted one: initial states are then estimated from it.

    Returns
    -------
    ndarray, shape (N, ny), or None
        In the units of the record; None if it diverges or does not settle.
    """
    spread = np.std(signals.y, axis=0)
    runs = [_runner(signals, j, output, elsewhere) for j, output in enumerate(outputs)]
    y = signals.y
    for _ in range(MOST_ROUNDS):
        new = np.column_stack([run(y) for run in runs])
        if not np.all(np.abs(new - signals.y) < DIVERGED * spread):
            return None
        change = np.max(np.std(new - y, axis=0) / spread)
        y = new
        if change < SETTLED:
            return y
    return None


def _runner(signals: Signals, j: int, one: Coupled, elsewhere: bool) -> Callable[[FloatArray], FloatArray]:
    """One output as a function of all outputs."""
    main, *others = one.signals.inputs
    scales = dict(zip(others, one.signals.input_scales[1:], strict=True))
    u, measured = signals.u[:, signals.inputs.index(main)], signals.y[:, j]

    def run(y: FloatArray) -> FloatArray:
        further = {name: np.asarray(scale.of(y[:, signals.outputs.index(name)])) for name, scale in scales.items()}
        fit = replace(one.fit, hypothesis=one.fit.hypothesis.with_signals(further))
        if elsewhere:
            return export_model(one.data, fit).simulate(np.ascontiguousarray(u), np.ascontiguousarray(measured))
        output = fit.hypothesis.output(fit.theta, fit.gains, one.data.u)
        return np.asarray(one.data.y_scale.back(output))

    return run
