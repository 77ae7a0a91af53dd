"""Faults of the command that its log does not show: it is switched off, or acts in coarse steps."""

from collections.abc import Iterable, Mapping

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics import _kernels
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects.base import Fitted, InputEffect, Value
from labsid.gap.effects.context import Context
from labsid.gap.effects.description import Description, Reported
from labsid.gap.effects.sketch import Seen, Sketch, same, stepped

INSTANTS = 48  # of the record, at which the command may be switched off and on again; numerics
SHORTEST = 8  # samples that it is off; set by hand
MIN_REMOVED = 0.1  # of the standard deviation of the command: rms change of it by being off, at least; set by hand
MIN_COMMANDED = 0.5
"""Of the range of the command: what it covers while it is off from the start of the record; set by hand."""
MAX_BEYOND = 0.1  # of the range of the command and zero: distance of the level from it; set by hand
SHARE = 2e-4  # of the record: derivative step of an instant; numerics
CHOSEN = 3  # start values; numerics
COARSEST = 1.5  # fewest steps in the range of the command; numerics
FINEST = 64.0  # most steps in the range of the command; numerics
STEP_RATIO = 1.01  # of two neighbouring steps that are tried; numerics
STEP_SHIFT = 0.2  # of a step: largest shift over the whole range between two neighbours that are tried; numerics
FINER = 21  # steps between two neighbours of the coarse grid, about the best ones; numerics
MAX_TRIED = 4000  # samples in which steps are compared; numerics
PARTS = 12  # in which they are compared, for the memory that their responses take; numerics
MIN_ACTING = 3  # levels that act; set by hand


def _switched_off(x: FloatArray, p: Mapping[str, float], seen: Seen) -> FloatArray:
    """The command, and the level that acts instead while it is not applied."""
    off = (x >= p.get("onset", -np.inf)) & (x < p.get("end", np.inf))
    return np.where(off, p["level"], np.interp(x, seen.t, seen.u))


class Off(InputEffect):
    """The command is logged and not applied: `level` acts instead from an instant on; with `variant` "while" up to
    another one, with "before" from the start of the record up to an instant. A set point that is frozen, a drive that
    has tripped, or that is not enabled yet.
    """

    name = "input-off"
    description = Description(
        path="input",
        noun="a command that is not applied",
        clauses=(
            "From {onset} to {end}, {level} acts instead of the command in the log",
            "From {onset} on, {level} acts instead of the command in the log",
            "For a part of the record the command is logged but not applied",
        ),
        meaning=(
            "The log goes on with the command, and the rig does not get it: a drive that has tripped, an emergency "
            "stop, a loose cable, a set point that is frozen. Check the state of the drive during this time."
        ),
        excited_by="A command that goes on changing while it is off.",
        parameters={
            "onset": Reported("start", "s", position=True),
            "end": Reported("end of it", "s", position=True),
            "level": Reported("command that acts", "u", position=True),
        },
        confused_with=("load-step", "output-dropout", "parameter-drift"),
        of_one_record=True,
        sketch=Sketch(
            "Time",
            "t",
            "Command",
            "u",
            _switched_off,
            lambda x, p, seen: np.interp(x, seen.t, seen.u),
            ("level",),
            ("onset", "end"),
        ),
    )
    least_levels = 2
    position = -1
    variants = ("", "while", "before")

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Shares of the record, zero for a command that is never off, and the level."""
        left = Parameter("off_left", 0.0, 1.0, SHARE, leap=0.004)
        times = (
            Parameter("off_start", 0.0, 1.0, SHARE, leap=0.004),
            Parameter("off_length", 0.0, 1.0, SHARE, leap=0.004),
        )
        until = Parameter("off_until", 0.0, 1.0, SHARE, leap=0.004)
        own = {"": (left,), "while": times, "before": (until,)}[self.variant]
        return (*own, Parameter("off_level", -60.0, 60.0))

    @property
    def instants(self) -> tuple[str, ...]:
        """Beginning, end or length of the time in which the command is not applied."""
        return {"": ("off_left",), "while": ("off_start", "off_length"), "before": ("off_until",)}[self.variant]

    def _span(self, own: FloatArray, span: int) -> tuple[float, float]:
        """Start and end in samples; infinite without one."""
        if self.variant == "while":
            return own[0] * span, (own[0] + own[1]) * span
        if self.variant == "before":
            return 0.0, own[0] * span
        return (1.0 - own[0]) * span, np.inf

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """The command with the level in place of what is not applied."""
        if self.variant == "while":
            return _kernels.switched_off(w, own[0] * span, (own[0] + own[1]) * span, own[2])
        if own[0] == 0.0:
            return w
        if self.variant == "before":
            return _kernels.switched_off(w, 0.0, own[0] * span, own[1])
        return _kernels.switched_off(w, (1.0 - own[0]) * span, w.size + 1.0, own[1])

    def starts(self, context: Context) -> list[FloatArray]:
        """Times and levels that reduce the residual most, through the parent's linear dynamics."""
        samples = context.data.samples
        return [
            np.array([*self._times(start / samples, stop / samples), level])
            for start, stop, level in _best_spans(context, self.variant)
        ]

    def _times(self, start: float, stop: float) -> tuple[float, ...]:
        """Parameters of an interval, in shares of the record."""
        if self.variant == "while":
            return start, stop - start
        return (stop,) if self.variant == "before" else (1.0 - start,)

    def is_plausible(self, fit: Fitted) -> bool:
        """Require a stretch inside the record in which being off matters, and a level that the drive can have.

        From the start of the record on, a dead zone does the same as being off as long as the command stays in it. So
        the command must have moved over a large part of its range: a dead zone as wide acts later in the record, too.
        """
        own, data = fit.theta_of(self), fit.data
        start, stop = self._span(own, data.samples)
        off = self.active_samples(fit)
        last = data.samples - SHORTEST
        inside = SHORTEST < stop < last if self.variant == "before" else SHORTEST < start < last
        inside = inside and min(stop, data.samples) - start > SHORTEST
        if not inside or not off.any():
            return False
        zero = data.zero_command
        low, high = min(float(data.u.min()), zero), max(float(data.u.max()), zero)
        beyond = MAX_BEYOND * (high - low)
        if self.variant == "before" and np.ptp(data.u[off]) < MIN_COMMANDED * np.ptp(data.u):
            return False
        moved = float(np.sqrt(np.mean((data.u[off] - own[-1]) ** 2)))
        return low - beyond < own[-1] < high + beyond and moved > MIN_REMOVED * float(np.std(data.u))

    def active_samples(self, fit: Fitted) -> np.ndarray:
        """The samples at which the command is not applied."""
        start, stop = self._span(fit.theta_of(self), fit.data.samples)
        at = np.arange(fit.data.samples)
        return (at >= start) & (at < stop)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`onset` and `end` in seconds, and the `level` that acts."""
        data, own = fit.data, fit.theta_of(self)
        start, stop = self._span(own, data.samples)
        ends = {"onset": start, "end": stop}
        times = {name: Value(at * data.Ts + data.start, "s") for name, at in ends.items() if np.isfinite(at)}
        return times | {"level": Value(fit.u(float(own[-1])), "u")}


class Quantization(InputEffect):
    """The command acts in coarse steps that its log does not have; it is rounded, to multiples of the step."""

    name = "input-quantization"
    description = Description(
        path="input",
        noun="a command that acts in coarse steps",
        clauses=(
            "The command acts in steps of {step}, which its log does not have",
            "The command acts in coarse steps",
        ),
        meaning=(
            "The command is rounded between the log and the rig. Look for a converter with few bits, a number that is"
            " sent as an integer, or a valve with notches."
        ),
        excited_by="A slow ramp of the command, or many of its levels.",
        parameters={"step": Reported("step of the command that acts", "u")},
        confused_with=("input-nonlinearity", "input-dead-zone", "coloured-noise"),
        shape_of_input=True,
        sketch=Sketch(
            "Command",
            "u",
            "Command that acts",
            "u",
            stepped,
            same,
            ("step",),
        ),
    )
    position = 8

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Logarithm of the step in the scaled input, and the share of a step by which the lattice is shifted."""
        return (Parameter("log_step", -7.0, 3.0, 2e-3, leap=6e-4), Parameter("phase", -1.0, 1.0, 1e-2, leap=5e-3))

    def applies(self, context: Context) -> bool:
        """Whether more levels are logged than the coarsest steps leave."""
        return context.levels.size > MIN_ACTING

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """The rounded command."""
        return _kernels.in_steps(w, np.exp(own[0]), own[1])

    def starts(self, context: Context) -> list[FloatArray]:
        """Steps whose rounding, of a lattice about zero or halfway between, reduces the residual most."""
        return _best_steps(context)

    def is_plausible(self, fit: Fitted) -> bool:
        """Require several levels that act, and fewer of them than are logged."""
        acting = np.unique(np.round(self.apply(fit.data.u, fit.theta_of(self), fit.data.samples), 9)).size
        return MIN_ACTING <= acting < np.unique(np.round(fit.data.u, 9)).size

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`step` in the unit of the input."""
        return {"step": Value(float(np.exp(fit.theta_of(self)[0])) * fit.data.u_scale.unit, "u")}


class _Screen:
    """Through the parent's linear dynamics, how much of its residual a change of the command explains."""

    def __init__(self, context: Context, samples: int) -> None:
        self.plant, self.samples = Plant(), samples
        self.rates = np.log(context.highpass_rates)
        rows = context.data.rows[:samples]
        self.rows, actuator = slice(None) if rows.all() else rows, context.actuator[:samples]
        basis = np.hstack([self.plant.columns(self.rates, actuator, samples), np.ones((samples, 1))])[self.rows]
        self.basis = np.linalg.qr(basis)[0]
        self.e = self._apart(context.data.y[:samples, None][self.rows])[:, 0]
        self.actuator = actuator

    def _apart(self, columns: FloatArray) -> FloatArray:
        return columns - self.basis @ (self.basis.T @ columns)

    def responses(self, signals: Iterable[FloatArray]) -> FloatArray:
        """Columns of the responses, two for each signal, less what the parent can explain."""
        columns = [self.plant.load_response(self.rates, signal)[self.rows] for signal in signals]
        return self._apart(np.hstack(columns))


def _best_spans(context: Context, variant: str) -> list[tuple[float, float, float]]:
    """Start and end in samples, and level, of commands that are off and reduce the residual most."""
    samples = context.data.samples
    screen = _Screen(context, samples)
    at = np.unique(np.linspace(0.0 if variant == "before" else 0.02, 0.98, INSTANTS) * samples).astype(int)
    later = [np.arange(samples) >= k for k in at]
    steps = screen.responses(signal * on for on in later for signal in (screen.actuator, np.ones(samples)))
    gram = steps.T @ steps
    cross = steps.T @ screen.e
    # What lasts for a stretch is the difference of two steps, with four columns each.
    G = gram.reshape(at.size, 4, at.size, 4).swapaxes(1, 2)
    b = cross.reshape(at.size, 4)
    if variant:
        i, j = np.triu_indices(at.size, 1)
        i, j = (i[i == 0], j[i == 0]) if variant == "before" else (i, j)
        G, b = G[i, i] + G[j, j] - G[i, j] - G[j, i], b[i] - b[j]
    else:
        i, j = np.arange(at.size), None
        G = G[i, i]
    G += (1e-9 * np.trace(G, axis1=1, axis2=2) + 1e-12)[:, None, None] * np.eye(4)
    x = np.linalg.solve(G, b[:, :, None])[:, :, 0]
    removed, added = -x[:, :2].sum(axis=1), x[:, 2:].sum(axis=1)
    level = np.clip(np.divide(added, removed, out=np.zeros(removed.size), where=removed != 0.0), -8.0, 8.0)
    best: list[tuple[float, float, float]] = []
    zero = context.data.zero_command
    for rank in np.argsort(-(b * x).sum(axis=1), kind="stable")[:CHOSEN]:
        span = float(at[i[rank]]), float(samples if j is None else at[j[rank]])
        best += [(*span, float(level[rank])), (*span, zero)]
    return best


def _best_steps(context: Context) -> list[FloatArray]:
    """Logarithm and phase of the steps that reduce the residual most."""
    samples = min(context.data.samples, MAX_TRIED)
    screen = _Screen(context, samples)
    u, parent = context.data.u[:samples], context.parent
    span = float(np.ptp(u))
    if span == 0.0:
        return []
    zero = context.data.zero_command

    def tried(steps: FloatArray, shift: float) -> list[tuple[float, float, float, float]]:
        """How much of the residual each explains, and the step with its shift and its phase."""
        phases = np.mod(zero / steps + shift + 0.5, 1.0) - 0.5
        acting = (_kernels.in_steps(u, step, phase) for step, phase in zip(steps, phases, strict=True))
        columns = screen.responses(parent.hypothesis.driven(parent.theta, w) - screen.actuator for w in acting)
        pairs = columns.T.reshape(steps.size, 2, -1)
        gram = pairs @ pairs.swapaxes(1, 2)
        gram += (1e-9 * np.trace(gram, axis1=1, axis2=2) + 1e-12)[:, None, None] * np.eye(2)
        cross = pairs @ screen.e
        explained = (cross * np.linalg.solve(gram, cross[:, :, None])[:, :, 0]).sum(axis=1)
        return [(float(x), float(step), shift, float(p)) for x, step, p in zip(explained, steps, phases, strict=True)]

    wide = span / min(STEP_SHIFT / (STEP_RATIO - 1.0), FINEST)  # finer steps differ by less than the ratio
    steps = np.geomspace(wide, span / COARSEST, int(np.log(span / COARSEST / wide) / np.log(STEP_RATIO)))
    fine = span / np.arange(FINEST, span / wide, -STEP_SHIFT)
    steps = np.concatenate([fine, steps])
    coarse = [step for some in np.array_split(steps, PARTS) for shift in (0.0, 0.5) for step in tried(some, shift)]
    best = sorted(coarse, reverse=True)[:CHOSEN]
    near = STEP_RATIO ** np.linspace(-1.0, 1.0, FINER)
    refined = [max(tried(step * near, shift)) for _, step, shift, _ in best]
    return [np.array([np.log(step), phase]) for _, step, _, phase in [*refined, *best]]
