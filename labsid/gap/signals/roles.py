"""One output of a record seen through one input: effects are searched there, the other inputs are linear beside it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.responses import real_rates
from labsid.gap.effects.further_inputs import FurtherInput, SameEntry
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.record.data import Data, Scale, scaled
from labsid.gap.signals.given import GivenSystem, given_baseline
from labsid.gap.signals.input_responses import LinearParts, others_beside
from labsid.gap.simulations.baseline import Baseline, linear_structure, make_baseline

COUPLED_ORDER = 4  # of the model; definition: two coupled systems of second order
SMALL_GAIN = 0.3  # of a further input over that of the first one: a start value; numerics


@dataclass(frozen=True, slots=True, eq=False)
class Signals:
    """The signals of a record of several inputs or outputs.

    Attributes
    ----------
    t : ndarray, shape (N,)
    u : ndarray, shape (N, nu)
    y : ndarray, shape (N, ny)
        A straight line where an output is missing.
    rows : ndarray of bool, shape (N, ny)
        Samples that are fitted and scored.
    Ts : float
    inputs, outputs : tuple of str
        Names.
    name : str
        Of the record.
    given : GivenSystem or None
        A given simulation.
    """

    t: FloatArray
    u: FloatArray
    y: FloatArray
    rows: np.ndarray
    Ts: float
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    name: str = ""
    given: GivenSystem | None = None

    def data(self, i: int, j: int) -> Data:
        """Input i and output j as the search uses them; beside a simulation that is run, the input about its zero."""
        data = scaled(
            np.ascontiguousarray(self.u[:, i]),
            np.ascontiguousarray(self.y[:, j]),
            self.rows[:, j],
            self.Ts,
            float(self.t[0]),
        )
        return data if self.given is None or self.given.linear else data.about_zero_command()

    def scaled_inputs(self) -> FloatArray:
        """Every input, centred and divided by its spread, shape (N, nu)."""
        return np.column_stack([one.of(self.u[:, i]) for i, one in enumerate(self.input_scales)])

    @property
    def input_scales(self) -> tuple[Scale, ...]:
        """Those of `data`."""
        return tuple(self.data(i, 0).u_scale for i in range(len(self.inputs)))

    def __len__(self) -> int:
        return int(self.t.size)


@dataclass(frozen=True, slots=True, eq=False)
class Role:
    """An output and the input whose effects are searched.

    Attributes
    ----------
    output, main : int
        Which output and which input.
    data : Data
    base : Baseline
        The linear structure, with the responses to the other inputs, or a given simulation.
    kind : str
        How the other inputs act, as of `make_role`.
    rates : (float, float)
        c and k of the response to the main input.
    """

    output: int
    main: int
    data: Data
    base: Baseline
    kind: str = "apart"
    rates: tuple[float, float] = (0.5, 0.05)

    @property
    def further(self) -> tuple[str, ...]:
        """Names of the other inputs that move the output."""
        structure = self.base.structure
        found = [one.variant for one in structure.effects if isinstance(one, FurtherInput | SameEntry)]
        return (*found, *(() if structure.given is None else structure.given.simulation.others))


def make_role(
    signals: Signals,
    output: int,
    main: int,
    parts: LinearParts,
    order: int,
    kind: str = "apart",
    start: FloatArray | None = None,
    applied: Mapping[int, FloatArray] | None = None,
) -> Role:
    """See an output through one input.

    Parameters
    ----------
    signals : Signals
    output, main : int
    parts : LinearParts
        Of the output.
    order : int
        Of the linear model.
    kind : {"apart", "coupled", "same entry", "given"}
        As of `others_beside`; "given" for a simulation that is run.
    start : ndarray, optional
        Parameters of the structure.
    applied : mapping of int to ndarray, optional
        Scaled inputs after the actuator effects that were found at them, of other inputs than `main`.
    """
    data = signals.data(main, output)
    inputs = signals.scaled_inputs()
    as_recorded = inputs.copy()
    for i, w in (applied or {}).items():
        inputs[:, i] = w
    if signals.given is not None:
        ends = (main, output), signals.inputs, signals.input_scales, parts.rates[main]
        given = given_baseline(signals.given, data, signals.t, as_recorded, *ends)
        if kind == "given":
            structure = (
                given_baseline(signals.given, data, signals.t, inputs, *ends).structure if applied else given.structure
            )
            lacking = signals.given.lacking(output, inputs)
            given = replace(given, structure=_beside(structure, lacking))
            return Role(output, main, data, given, kind, parts.rates[main])
    further = others_beside(parts, main, inputs, signals.inputs, kind)
    base = make_baseline(data, signals.t, None, order)
    if kind == "coupled":
        base = replace(base, structure=linear_structure(COUPLED_ORDER), alternative=None, start=start)
    elif kind == "same entry":
        base = replace(base, alternative=None)
    alternative = None if base.alternative is None else _beside(base.alternative, further)
    structure = _beside(base.structure, further)
    if kind == "same entry":
        base = replace(base, start=_behind_first_state(structure, parts.rates[main]))
    if signals.given is not None:
        base = replace(base, before=given.before, simulate_record=given.simulate_record)
    base = replace(base, structure=structure, alternative=alternative)
    return Role(output, main, data, base, kind, parts.rates[main])


def _behind_first_state(structure: Hypothesis, rates: tuple[float, float]) -> FloatArray:
    """Start values with which further inputs act behind the faster pole of the first one."""
    slow, fast = real_rates(*rates)
    rates_of = {"log_c": np.log(slow + fast), "log_k": np.log(slow * fast)}
    of_a_way = {"gain": SMALL_GAIN, "lead": float(np.exp(-fast))}
    names = [parameter.name for parameter in structure.parameters]
    theta = [rates_of.get(name, of_a_way.get(name.partition(" ")[0], 0.0)) for name in names]
    return np.clip(np.array(theta), *structure.bounds)


def _beside(structure: Hypothesis, further: Sequence[FurtherInput | SameEntry]) -> Hypothesis:
    """A structure with the responses to further inputs."""
    return Hypothesis((*further, *structure.effects), structure.n_given + len(further), structure.given)
