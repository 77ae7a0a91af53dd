"""Times and signals of a log on the way to a record, and the names of places in them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from labsid._arrays import FloatArray, stretches_of

PLACEHOLDERS = -99, -999, -9999, -99999, 999, 9999, 99999, -32768, 32767, 65535  # of loggers, for missing samples
FAR = 3.0  # ranges of the other samples


@dataclass(frozen=True, slots=True, eq=False)
class Signals:
    """Times and signals of a log on the way to a record.

    Attributes
    ----------
    t : ndarray, shape (N,), or None
        Times in seconds; None if the log has none.
    values : dict of str to ndarray, shape (N,)
        ``u``, ``y`` and others, with several ``u1``, ``u2`` and so on; NaN where a value is missing.
    notes : tuple of str
    jitter : float
        Root-mean-square deviation of the stamps from `t`, in sampling times.
    names : dict of str to str
        What the notes call a signal, if not by its key in `values`.
    """

    t: FloatArray | None
    values: Mapping[str, FloatArray]
    notes: tuple[str, ...] = ()
    jitter: float = 0.0
    names: Mapping[str, str] = field(default_factory=dict)

    def called(self, key: str) -> str:
        """Name of a signal in notes and messages."""
        return self.names.get(key, key)

    def rows(self, rows: np.ndarray) -> "Signals":
        """Only these rows, or the rows in this order."""
        t = None if self.t is None else self.t[rows]
        return replace(self, t=t, values={name: x[rows] for name, x in self.values.items()})

    def said(self, *notes: str) -> "Signals":
        """With more notes."""
        return replace(self, notes=(*self.notes, *notes))


def is_input(key: str) -> bool:
    """Whether a signal is a command: an input, or the reference."""
    return key.startswith("u") or key == "reference"


def without_placeholders(signals: Signals) -> Signals:
    """The signals, with outputs missing where the log holds a number for that, such as -999 far from all others.

    Parameters
    ----------
    signals : Signals
    """
    for key, x in signals.values.items():
        codes = [] if is_input(key) else [code for code in PLACEHOLDERS if (x == code).any()]
        rest = x[np.isfinite(x) & ~np.isin(x, codes)]
        far = [c for c in codes if rest.size > 1 and _distance(c, rest) > FAR * np.ptp(rest) > 0.0]
        for code in far:
            there = x == code
            x = np.where(there, np.nan, x)
            said = f"{signals.called(key)} holds {code} in {there.sum()} samples, far from all others: read as missing"
            signals = replace(signals, values={**signals.values, key: x}).said(said)
    return signals


def _distance(value: float, x: FloatArray) -> float:
    return float(max(x.min() - value, value - x.max()))


def name_places(stretches: Sequence[Sequence[int]]) -> str:
    """List the first few of some stretches (start, stop) of samples."""
    named = [f"{k}" if stop == k + 1 else f"{k} to {stop - 1}" for k, stop in stretches[:4]]
    return ", ".join(named) + (", and so on" if len(stretches) > 4 else "")


def stretches(mask: np.ndarray) -> list[list[int]]:
    """First index of each stretch of True, and the one after its last."""
    return stretches_of(mask)


def span_of_outputs(y: FloatArray) -> slice:
    """The samples from the first output to the last one, of any output of several; all if there are fewer than two."""
    known = np.flatnonzero(~np.isnan(np.atleast_2d(y.T)).all(axis=0))
    return slice(int(known[0]), int(known[-1]) + 1) if known.size > 1 else slice(0, len(y))


def missing_note(y: FloatArray, t: FloatArray | None, name: str = "y") -> tuple[str, ...]:
    """What is to be said of an output with missing samples (NaN)."""
    missing = np.isnan(y)
    if not missing.any() or missing.all():
        return ()
    known = np.flatnonzero(~missing)
    apart = np.unique(np.diff(known))
    if t is not None and t.size == y.size and known.size > 2 and apart.size == 1 and apart[0] > 1:
        step = float(t[known[1]] - t[known[0]])
        return (
            f"{name} has a reading at one sample in {apart[0]} only: a simulation is compared at these; several "
            f"outputs need one rate (--resample {step:.9g})",
        )
    return (
        f"{name} is missing in {missing.sum()} of {y.size} samples ({name_places(stretches(missing))}); these are "
        "neither fitted nor scored",
    )


def jitter_note(jitter: float, Ts: float | None) -> tuple[str, ...]:
    """What is to be said of stamps that deviate from even times by `jitter` sampling times (root mean square)."""
    if not jitter or Ts is None:
        return ()
    return (f"the stamps deviate by {jitter:.2g} of the sampling time (rms); samples taken as every {Ts:.9g} s",)
