"""An ordinary record as the files that a person would have, with the answers that are right."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from labsid._arrays import FloatArray

NONE: tuple[str, ...] = ()
UNKNOWN: tuple[str, ...] = ("unknown",)


@dataclass(frozen=True, slots=True)
class TrueNumbers:
    """What a record determines of the numbers of its simulation.

    Attributes
    ----------
    determined : dict
        True value by name.
    undetermined : tuple of str
        Names of the numbers that the record does not determine.
    combination : str
        ``a*b`` or ``a/b`` of two undetermined numbers that is determined; empty if there is none.
    value : float
        True value of the combination.
    """

    determined: dict[str, float]
    undetermined: tuple[str, ...] = ()
    combination: str = ""
    value: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class OrdinaryRecord:
    """Files of a record, and what is to be answered.

    Attributes
    ----------
    answers : tuple of tuple of str
        The right answers, each a tuple of effects: empty for ``none``, ``("unknown",)`` for ``unknown``.
    files : dict
        Text by the ending of the file's name; ``.csv`` is the record.
    truth : dict
        What the record was made with, in its own units.
    options : tuple of str
        Further words of the command line; ``NAME`` stands for the name of the record.
    numbers : TrueNumbers, optional
        Of a simulation with free numbers.
    """

    answers: tuple[tuple[str, ...], ...]
    files: dict[str, str]
    truth: dict[str, Any] = field(default_factory=dict)
    options: tuple[str, ...] = ()
    numbers: TrueNumbers | None = None


@dataclass(frozen=True, slots=True)
class Bench:
    """Length, sampling time and units of a record.

    Attributes
    ----------
    samples : int
    Ts : float
        Sampling time (s).
    u0, us : float
        Mean and amplitude of the input.
    y0 : float
        Reading of the sensor at zero output.
    noise : float
        Standard deviation of the noise, as a share of that of the output.
    """

    samples: int
    Ts: float
    u0: float
    us: float
    y0: float
    noise: float

    @property
    def t(self) -> FloatArray:
        """Times of the samples."""
        return self.Ts * np.arange(self.samples, dtype=np.float64)


def draw_bench(rng: np.random.Generator) -> Bench:
    """Draw length, sampling time, units and noise.

    Parameters
    ----------
    rng : Generator
    """
    us = float(f"{np.exp(rng.uniform(np.log(0.2), np.log(60.0))):.3g}")
    return Bench(
        samples=int(rng.integers(700, 2001)),
        Ts=float(rng.choice([0.001, 0.002, 0.004, 0.01, 0.02, 0.04, 0.05, 0.25, 0.5, 1.0, 2.0, 5.0, 15.0])),
        u0=0.0 if rng.random() < 0.5 else float(f"{us * rng.uniform(-2.0, 4.0):.3g}"),
        us=us,
        y0=0.0 if rng.random() < 0.5 else float(f"{np.exp(rng.uniform(np.log(0.1), np.log(30.0))):.3g}"),
        noise=float(np.exp(rng.uniform(np.log(0.003), np.log(0.025)))),
    )


def noisy(rng: np.random.Generator, y: FloatArray, share: float) -> tuple[FloatArray, float]:
    """Add white noise.

    Parameters
    ----------
    rng : Generator
    y : ndarray, shape (N,)
    share : float
        Standard deviation of the noise over that of `y`.

    Returns
    -------
    tuple of ndarray and float
        The noisy signal and the standard deviation of the noise.
    """
    sd = share * float(np.std(y))
    return y + sd * rng.standard_normal(y.size), sd


def table_text(header: str, form: str, *columns: FloatArray) -> str:
    """Text of a table.

    Parameters
    ----------
    header : str
    form : str
        A printf format of a number, or ``float32`` for single precision.
    *columns : ndarray
        The first one holds the times, which keep at least 10 digits, except in single precision.

    Returns
    -------
    str
    """
    if form == "float32":
        columns, form = tuple(column.astype(np.float32) for column in columns), "%.9g"
        of_time = form
    else:
        of_time = "%.17g" if form == "%.17g" else "%.10g"
    rows = zip(*(column.tolist() for column in columns), strict=True)
    lines = [",".join([of_time % t, *(form % value for value in others)]) for t, *others in rows]
    return "\n".join([header, *lines]) + "\n"


def record_table(bench: Bench, u: FloatArray, y: FloatArray, form: str = "%.8g") -> str:
    """Text of a record with the header ``t,u,y``."""
    return table_text("t,u,y", form, bench.t, u, y)
