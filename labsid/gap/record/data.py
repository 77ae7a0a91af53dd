"""The record as the search uses it: scaled, time in samples, with the rows that the fits may use."""

from dataclasses import dataclass, field, replace

import numpy as np

from labsid._arrays import FloatArray

FAR_FROM_ZERO = 4.0  # units of the scaled input, of a record whose command never comes near zero; set by hand
MAX_LAGS = 8  # of the model of the noise; set by hand
MIN_COMPLETE_SHARE = 0.1  # of the rows that count, with all lags; set by hand
MIN_COMPLETE = 20  # rows with all lags; set by hand


@dataclass(frozen=True, slots=True)
class Scale:
    """From the record's units to the search's: value = centre + unit * scaled.

    Attributes
    ----------
    centre, unit : float
        In the record's unit.
    """

    centre: float
    unit: float

    def of(self, values: FloatArray) -> FloatArray:
        """Into scaled units."""
        return (values - self.centre) / self.unit

    def back(self, scaled: FloatArray | float) -> FloatArray | float:
        """Into the record's unit."""
        return self.centre + self.unit * scaled


@dataclass(frozen=True, slots=True, eq=False)
class Data:
    """Scaled signals and the rows that count.

    Attributes
    ----------
    u, y : ndarray, shape (N,)
        Scaled input and output.
    rows : ndarray of bool, shape (N,)
        Samples that the cost counts.
    Ts : float
        Sampling time in seconds.
    u_scale, y_scale : Scale
        Back to the record's units.
    start : float
        Time of the first sample in seconds.
    by_free_run : bool
        Whether the score of a fit also counts its free-run error: where the innovations say too little about it.
    lattice : float
        Converter step in the scaled output; zero where there is none.
    pieces : tuple of (int, int)
        With several records, joined end to end: first sample of each and the one after its last; else empty.
    beside : tuple of (int, int)
        With several outputs of one simulation, joined end to end: first sample of each and the one after its last; else
        empty. The first one is that of the joint at which effects are searched.
    at_input : bool
        Whether the search tries effects at the input only.
    tried : frozenset of str
        Names of the effects that the search tries; all if empty.
    at : ndarray of int, shape (M,), optional
        The samples with a reading of a slow sensor; by default all.
    stride : int
        Samples from a reading to the one before, on which its noise may depend.
    lags : int
        The longest autoregression that the noise may have, in readings; 0 of readings at uneven distances.
    complete : ndarray of bool, shape (N,)
        Rows that count together with so many before them.
    """

    u: FloatArray
    y: FloatArray
    rows: np.ndarray
    Ts: float
    u_scale: Scale
    y_scale: Scale
    start: float = 0.0
    by_free_run: bool = False
    lattice: float = 0.0
    pieces: tuple[tuple[int, int], ...] = ()
    beside: tuple[tuple[int, int], ...] = ()
    at_input: bool = False
    tried: frozenset[str] = frozenset()
    at: np.ndarray | None = None
    stride: int = 1
    lags: int = field(init=False, repr=False)
    complete: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "lags", usable_lags(self.rows, self.stride))
        object.__setattr__(self, "complete", complete_rows(self.rows, self.lags, self.stride))

    @property
    def samples(self) -> int:
        """N."""
        return int(self.u.size)

    @property
    def zero_command(self) -> float:
        """The scaled input where the command is zero."""
        return float(self.u_scale.of(np.zeros(1))[0])

    def about_zero_command(self) -> "Data":
        """The same with a scaled input of zero where the command is zero; itself where that is far from the record.

        A given simulation has no free offset at its input: within a dead zone its command is zero.
        """
        if abs(self.u_scale.centre) > FAR_FROM_ZERO * self.u_scale.unit:
            return self
        zero = Scale(0.0, self.u_scale.unit)
        return replace(self, u=zero.of(np.asarray(self.u_scale.back(self.u))), u_scale=zero)

    @property
    def times(self) -> np.ndarray:
        """The number of each sample in its output, shape (N,); of one between two outputs 0."""
        found = np.zeros(self.samples, int)
        for start, stop in self.beside or ((0, self.samples),):
            found[start:stop] = np.arange(stop - start)
        return found

    @property
    def first_output(self) -> "Data":
        """The first of several outputs of one simulation; of a single one the record as it is."""
        if not self.beside:
            return self
        own = slice(*self.beside[0])
        return replace(self, u=self.u[own], y=self.y[own], rows=self.rows[own], beside=())

    @property
    def every(self) -> float:
        """Mean distance of the readings of the sensor, in samples."""
        return 1.0 if self.at is None else float(self.at[-1] - self.at[0]) / (self.at.size - 1)

    def readings(self, values: np.ndarray) -> np.ndarray:
        """Values or marks of all samples, at the readings of the sensor: all of them but for a slow one."""
        return values if self.at is None else values[self.at]

    def among_samples(self, marks: np.ndarray) -> np.ndarray:
        """Marks of the readings, as marks of all samples."""
        if self.at is None:
            return marks
        all_marks = np.zeros(self.samples, bool)
        all_marks[self.at] = marks
        return all_marks

    def planned_readings(self, samples: int) -> tuple[np.ndarray, np.ndarray | None]:
        """Rows that count and readings of another run, at even distances."""
        if self.at is None:
            return np.ones(samples, bool), None
        rows = np.arange(samples) % max(round(self.every), 1) == 0
        return rows, np.flatnonzero(rows)

    @property
    def sampled(self) -> tuple[FloatArray, FloatArray]:
        """Input and output at the readings of the sensor."""
        return self.readings(self.u), self.readings(self.y)

    def at_readings(self) -> "Data":
        """The record at the readings of the sensor alone."""
        u, y = self.sampled
        return replace(self, u=u, y=y, rows=self.readings(self.rows), Ts=self.every * self.Ts, at=None, stride=1)

    @property
    def longest(self) -> int:
        """Samples of the longest record."""
        return max((stop - start for start, stop in self.pieces or self.beside), default=self.samples)


def scaled(
    u: FloatArray,
    y: FloatArray,
    rows: np.ndarray,
    Ts: float,
    start: float = 0.0,
    scales: tuple[Scale, Scale] | None = None,
) -> Data:
    """Centre both signals and divide them by their spread.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
        Input and output in the record's units; neither is constant.
    rows : ndarray of bool, shape (N,)
        Samples that the cost counts.
    Ts : float
        Sampling time in seconds.
    start : float
        Time of the first sample in seconds.
    scales : tuple of Scale, optional
        Those of input and output that a simulation counts in, in the place of the record's own.

    Returns
    -------
    Data
    """
    own = Scale(float(np.mean(u)), _spread(u)), Scale(float(np.mean(y)), _spread(y))
    u_scale, y_scale = scales or own
    return Data(u_scale.of(u), y_scale.of(y), rows, Ts, u_scale, y_scale, start)


def _spread(values: FloatArray) -> float:
    """Standard deviation, also of numbers whose squares are too small or too large for floating point."""
    span = float(np.ptp(values))
    return span * float(np.std(values / span))


def usable_lags(rows: np.ndarray, stride: int = 1) -> int:
    """Largest order of the noise model: `MAX_LAGS`, or less if too few rows have as many counted rows before them."""
    lags = MAX_LAGS
    least = max(MIN_COMPLETE_SHARE * rows.sum(), MIN_COMPLETE)
    while lags > 0 and complete_rows(rows, lags, stride).sum() < least:
        lags //= 2
    return lags


def complete_rows(rows: np.ndarray, lags: int = MAX_LAGS, stride: int = 1) -> np.ndarray:
    """Rows that count together with the `lags` rows before them, each `stride` samples before the next."""
    complete = rows.copy()
    complete[: lags * stride] = False
    for lag in range(stride, lags * stride + 1, stride):
        complete[lag:] &= rows[:-lag]
    return complete
