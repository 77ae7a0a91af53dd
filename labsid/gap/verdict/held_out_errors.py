"""Free-run errors of fits on samples that no fit has used."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.record_start import RecordStart
from labsid.gap.fits.fitting import Fit, refit
from labsid.gap.fits.noise_model import noise_of
from labsid.gap.model_file import LEAST, export_model
from labsid.gap.record.data import Data
from labsid.gap.record.holdout import held_out_samples

PARTS = 12  # of the scored samples, in order of time, for paired comparisons; set by hand
MIN_T = 2.0  # standard errors; set by hand
MAX_FACTOR = 0.95  # rms error with an effect over that without it, above which it is too small to be named; set by hand
TOLERANCE_IN_TURN = 1e-4  # relative gain of the last step of a refit without one of several records; numerics
SETTLED = 1e-4  # of the error of the baseline: smaller differences of an error are of no interest; numerics

Refit = Callable[[Data, Fit], Fit]


@dataclass(frozen=True, slots=True)
class Reduction:
    """Paired comparison of two errors over the parts of the held-out samples.

    Attributes
    ----------
    factor : float
        Rms error after over that before, over all parts.
    t : float
        Mean over standard error of the logarithm of the ratio of the mean squares by part; positive for a reduction.
    """

    factor: float
    t: float

    @property
    def pays(self) -> bool:
        """Whether the error is smaller by more than chance, and by enough to be named."""
        return self.t > MIN_T and self.factor < MAX_FACTOR


@dataclass(frozen=True, slots=True, eq=False)
class HeldOut:
    """The samples on which fits are compared: another record, blocks of the record itself, or each of several records.

    Attributes
    ----------
    data : Data
        Its rows are those to fit.
    scored : ndarray of bool
        The held-out samples, of this record or of the other one.
    other : tuple of ndarray, optional
        Input and output of the other record, in the record's units.
    in_turn : dict, optional
        With several records, each left out in turn: the outputs of the fits to the others, by fit.
    start : RecordStart
        Which samples of another record determine its initial state: the same for all fits.
    further : dict, optional
        Further inputs of the other record by name, scaled.
    known : ndarray of bool, optional
        Samples of the other record that have an output; by default all.
    """

    data: Data
    scored: np.ndarray
    other: tuple[FloatArray, FloatArray] | None = None
    in_turn: dict[Fit, FloatArray] | None = None
    start: RecordStart = LEAST
    further: dict[str, FloatArray] | None = None
    known: np.ndarray | None = None

    @property
    def elsewhere(self) -> bool:
        """Whether the held-out samples are in records that are not fitted."""
        return self.other is not None or self.in_turn is not None

    def refit(self, fit: Fit) -> Fit:
        """The fit, repeated without the held-out samples."""
        return fit if self.elsewhere else refit(self.data, fit)

    def output(self, fit: Fit, again: Refit | None = None) -> FloatArray:
        """Scaled free-run output on the record that contains the held-out samples.

        `again` repeats the fit without one of several records; by default by output error.
        """
        if self.in_turn is not None:
            if fit not in self.in_turn:
                self.in_turn[fit] = _outputs_in_turn(self.data, fit, again or _refit_nearby, self.start)
            return self.in_turn[fit]
        if self.other is None:
            return fit.output
        if self.further:
            fit = replace(fit, hypothesis=fit.hypothesis.with_signals(self.further))
        u, y = self.other
        known = y if self.known is None else np.where(self.known, y, np.nan)
        return self.data.y_scale.of(export_model(self.data, fit, start=self.start).simulate(u, known))

    @property
    def measured(self) -> FloatArray:
        """Scaled measured output of the same record."""
        return self.data.y if self.other is None else self.data.y_scale.of(self.other[1])

    def on_other(self, fit: Fit) -> tuple[Data, Fit]:
        """The other record, with the rows that are scored, and a fit with its output there."""
        assert self.other is not None
        u, y = self.data.u_scale.of(self.other[0]), self.measured
        own = self.data
        at = None if own.at is None else np.flatnonzero(self.scored)
        data = Data(u, y, self.scored, own.Ts, own.u_scale, own.y_scale, lattice=own.lattice, at=at, stride=own.stride)
        output = self.output(fit)
        return data, replace(fit, output=output, noise=noise_of(data, y - output))

    def errors(self, fit: Fit, again: Refit | None = None) -> FloatArray:
        """Mean square error of a fit in each part of the held-out samples, shape (PARTS,)."""
        return self.in_parts(self.measured - self.output(fit, again))

    def expected(self, fit: Fit) -> float | None:
        """Mean square error to be expected on further samples of the fitted record, beside another record; else None.

        Source: the final prediction error of H. Akaike, "Fitting autoregressive models for prediction", Annals of the
        Institute of Statistical Mathematics 21 (1969) 243-247.
        """
        if self.other is None:
            return None
        count = int(self.data.rows.sum())
        return fit.free_run * (count + fit.n_free) / max(count - fit.n_free, 1)

    def in_parts(self, e: FloatArray) -> FloatArray:
        """Mean square of an error in each part of the held-out samples, shape (PARTS,); infinity if it diverges.

        A few samples are a part each.
        """
        rows = np.flatnonzero(self.scored)
        with np.errstate(over="ignore", invalid="ignore"):
            means = np.array([np.mean(e[part] ** 2) for part in np.array_split(rows, min(PARTS, rows.size))])
        return np.where(np.isfinite(means), means, np.inf)


def _refit_nearby(data: Data, fit: Fit) -> Fit:
    """Refit in a few steps: without one of several records the minimum has usually moved little."""
    return refit(data, fit, TOLERANCE_IN_TURN)


def _outputs_in_turn(data: Data, fit: Fit, again: Refit, begun: RecordStart) -> FloatArray:
    """Output of each of several records, simulated by a fit to the others."""
    output = fit.output.copy()
    for start, stop in data.pieces:
        rows = data.rows.copy()
        rows[start:stop] = False
        others = replace(data, rows=rows)
        model = export_model(others, again(others, fit), start=begun)
        u, y = data.u_scale.back(data.u[start:stop]), data.y_scale.back(data.y[start:stop])
        if data.at is not None:
            y = np.where(data.rows[start:stop], y, np.nan)
        output[start:stop] = data.y_scale.of(model.simulate(np.asarray(u), np.asarray(y)))
    return output


def hold_out(
    data: Data,
    other: tuple[FloatArray, FloatArray] | None,
    onset: float | None = None,
    measured: np.ndarray | None = None,
    begun: RecordStart = LEAST,
    further: dict[str, FloatArray] | None = None,
) -> HeldOut:
    """Choose the held-out samples.

    Parameters
    ----------
    data : Data
    other : tuple of ndarray or None
        Input and output of another record of the rig, in the record's units; its first samples determine the initial
        state and are not scored. None for blocks of the record itself.
    onset : float, optional
        Instant at which an effect begins, as a share of the record.
    measured : ndarray of bool, optional
        Samples of the other record that have an output; by default all.
    begun : RecordStart
        Which samples of another record determine its initial state.
    further : dict, optional
        Further inputs of the other record by name, scaled.
    """
    if other is not None:
        scored = np.arange(other[0].size) >= begun.samples(other[0].size)
        scored = scored if measured is None else scored & measured
        return HeldOut(data, scored, other, start=begun, further=further, known=measured)
    if data.pieces:
        scored = np.zeros(data.samples, bool)
        for start, stop in data.pieces:
            scored[start + begun.samples(stop - start) : stop] = True
        return HeldOut(data, scored & data.rows, in_turn={}, start=begun)
    times = data.times
    blocks = held_out_samples(int(times.max()) + 1, onset)[times]
    return HeldOut(replace(data, rows=data.rows & ~blocks), data.rows & blocks, start=begun)


def compare_errors(before: FloatArray, after: FloatArray) -> Reduction:
    """Compare two errors part by part.

    Parameters
    ----------
    before, after : ndarray, shape (PARTS,)
        From `HeldOut.errors`.
    """
    total = float(np.sum(before))
    if not np.isfinite(np.sum(after)):
        return Reduction(np.inf, -np.inf)
    if not np.isfinite(total):
        return Reduction(0.0, np.inf)
    floor = SETTLED**2 * max(total / before.size, 1e-300)
    ratios = np.log((before + floor) / (after + floor))
    spread = max(float(np.std(ratios, ddof=1)) / np.sqrt(ratios.size), 1e-9)
    return Reduction(float(np.sqrt(np.sum(after) / max(total, 1e-300))), float(np.mean(ratios)) / spread)
