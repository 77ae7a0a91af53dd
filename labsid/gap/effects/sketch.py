"""Sketches of effects for figures: curves made from the parameters that the report states."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray

POINTS = 400  # of a curve; numerics
FAR = 3.0  # ranges of a signal, beyond which a place is not drawn; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What the record shows around an effect.

    Attributes
    ----------
    t, u, y : ndarray, shape (N,)
        Times, and the signals between which the effect acts.
    units : dict
        Unit of each parameter, in terms of u and y.
    """

    t: FloatArray
    u: FloatArray
    y: FloatArray
    units: Mapping[str, str]


Curve = Callable[[FloatArray, Mapping[str, float], Seen], FloatArray]
"""Heights at the points, by the parameters and what was seen."""
Reach = Callable[[Mapping[str, float], Seen], tuple[float, float]]
"""Ends of the horizontal axis."""


@dataclass(frozen=True, slots=True, eq=False)
class Sketch:
    """A curve that shows what an effect does.

    Attributes
    ----------
    across : str
        Label of the horizontal axis.
    over : str
        What it measures: the signal "u" or "y", the time "t" of the record, the time "s" after a change, or "" for a
        share.
    label : str
        Label of the vertical axis.
    unit : str
        Unit of the vertical axis: "u", "y", the name of a parameter that has this unit, or "" for a share.
    curve : callable
        With the effect.
    plain : callable
        Without it.
    needs : tuple of str
        Parameters without any of which nothing is drawn.
    marks : tuple of str
        Parameters that are places on the horizontal axis.
    reach : callable, optional
        Ends of the horizontal axis; by default those of what it measures.
    loop : bool
        Whether the points go up, down and up again.
    """

    across: str
    over: str
    label: str
    unit: str
    curve: Curve
    plain: Curve
    needs: tuple[str, ...]
    marks: tuple[str, ...] = ()
    reach: Reach | None = None
    loop: bool = False

    def points(self, parameters: Mapping[str, float], seen: Seen) -> FloatArray:
        """Points of the horizontal axis."""
        signal = {"u": seen.u, "y": seen.y}.get(self.over, seen.t)
        x = np.linspace(*(self.reach(parameters, seen) if self.reach else ends_of(signal)), POINTS + 1)
        return np.concatenate([x, x[::-1], x]) if self.loop else x

    def is_drawn(self, parameters: Mapping[str, float]) -> bool:
        """Whether a parameter that it needs is known."""
        return any(name in parameters for name in self.needs)


def ends_of(signal: FloatArray, margin: float = 0.0, places: tuple[float, ...] = ()) -> tuple[float, float]:
    """Range of a signal with a margin, as a share of it, and with the places that are not far from it."""
    low, high = float(np.nanmin(signal)), float(np.nanmax(signal))
    span = high - low
    near = [place for place in places if low - FAR * span < place < high + FAR * span]
    return min([low, *near]) - margin * span, max([high, *near]) + margin * span


def same(x: FloatArray, p: Mapping[str, float], seen: Seen) -> FloatArray:
    """The signal as it is."""
    return x


def nothing(x: FloatArray, p: Mapping[str, float], seen: Seen) -> FloatArray:
    """Zero."""
    return np.zeros(x.size)


def step(x: FloatArray, p: Mapping[str, float], seen: Seen) -> FloatArray:
    """A unit step at zero."""
    return np.where(x >= 0.0, 1.0, 0.0)


def clipped(x: FloatArray, p: Mapping[str, float], seen: Seen) -> FloatArray:
    """Within the limits `low` and `high`, as far as they are known."""
    return np.clip(x, p.get("low", -np.inf), p.get("high", np.inf))


def bent(x: FloatArray, p: Mapping[str, float], seen: Seen) -> FloatArray:
    """d + c2 d^2 + c3 d^3 about the `centre`."""
    d = x - p["centre"]
    return np.asarray(p["centre"] + d + p["c2"] * d**2 + p["c3"] * d**3)


def stepped(x: FloatArray, p: Mapping[str, float], seen: Seen) -> FloatArray:
    """The nearest multiple of the `step`."""
    return np.asarray(p["step"] * np.round(x / p["step"]))


def some_steps(p: Mapping[str, float], seen: Seen) -> tuple[float, float]:
    """Some steps of the converter, about the median of y."""
    middle = float(np.nanmedian(seen.y))
    return middle - 3.0 * p["step"], middle + 3.0 * p["step"]


def around_y(p: Mapping[str, float], seen: Seen) -> tuple[float, float]:
    """Somewhat more than the range of y."""
    return ends_of(seen.y, 0.15)


def after_a_step(name: str, before: float, after: float) -> Reach:
    """From `before` to `after` a step, as multiples of the time `name`."""
    return lambda p, seen: (-before * p[name], after * p[name])
