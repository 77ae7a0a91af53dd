"""Share of the gap that the diagnosis and the refitted true structure close on the held-out samples."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from labsid._arrays import FloatArray
from labsid.blind.experiment import Case, Experiment, input_signal, run_experiment, to_record
from labsid.blind.output_error import LinearFit
from labsid.records.record import Record
from labsid.rig.switchable._motion import HEATED_FAR, HEATED_NEAR, MASS
from labsid.rig.switchable.setup import Setup
from labsid.rig.switchable.simulation import Noise, UnboundedOutputError, simulate_setup

INITIAL_SAMPLES = 50
"""Leading samples of a second record, used to estimate its initial state and excluded from the score."""

CLOSES_NOTHING = {"coloured-noise", "output-outliers"}
"""Effects that no free run can reproduce, even with the true structure."""

_MOTION = (
    *("T0", "T1", "damping", "coupling", "actuator_lag", "sensor_lag"),
    *("outflow_curvature", "brim_upper", "brim_lower", "dry_friction", "cubic"),
    *("drag", "stop_low", "stop_high", "restitution", "slow_time", "slow_share", "play"),
    *("friction_back", "friction_peak", "friction_speed"),
)
_MODE = ("mode_frequency", "mode_damping", "mode_share")
_ACTUATOR = ("low", "high", "dead_low", "dead_high", "dead_jump", "backlash", "slew", "c2", "c3", "gain_change")
_LOAD = ("size", "leak", "amplitude", "frequency", "phase", "pole_change")
_SENSOR = ("c2", "c3", "fold", "drift", "amplitude", "frequency", "phase", "low", "high")


@dataclass(frozen=True, slots=True)
class Closure:
    """Closed share of the gap on held-out samples.

    Attributes
    ----------
    diagnosed : float
        Share closed by the diagnosis, relative to the true noise.
    possible : float
        Share closed by the true structure, refitted on the same samples.
    """

    diagnosed: float
    possible: float


def closed_share(before: float, after: float, floor: float) -> float | None:
    """Share of a gap that is closed, or None if there is no gap before.

    Parameters
    ----------
    before, after, floor : float
        Root mean square errors; `floor` is that of the noise.

    Returns
    -------
    float or None
    """
    gap = before**2 - floor**2
    if gap <= 0:
        return None
    return 1.0 - float(np.sqrt(max(after**2 - floor**2, 0.0) / gap))


def compare_closure(case: Case, result: dict[str, Any]) -> Closure | None:
    """Compute the shares of the gap closed by a diagnosis and by the true structure.

    Parameters
    ----------
    case : Case
    result : dict
        The diagnosis.

    Returns
    -------
    Closure or None
        None if no free run can close the gap, or the result does not state the held-out samples.
    """
    if not case.labels or set(case.labels) & {"unknown", "parameter-mismatch", *CLOSES_NOTHING}:
        return None
    scored = held_out_samples(case, result)
    gap = result.get("gap") or {}
    if scored is None or gap.get("before") is None or gap.get("after") is None:
        return None
    experiment = case.experiment
    clean = to_record(run_experiment(experiment), experiment.scales, case.name, clean=True)
    floor = _rms((case.record.y - clean.y)[scored])
    y = refit_true_structure(case, ~scored)
    diagnosed = closed_share(gap["before"], gap["after"], floor)
    possible = closed_share(gap["before"], _rms((case.record.y - y)[scored]), floor)
    return None if diagnosed is None or possible is None else Closure(diagnosed, possible)


def held_out_samples(case: Case, result: dict[str, Any]) -> NDArray[np.bool_] | None:
    """Samples that the diagnosis states it held out.

    Parameters
    ----------
    case : Case
    result : dict

    Returns
    -------
    ndarray of bool, shape (N,), or None
        None if it held out a second record or stated no plausible intervals.
    """
    blocks = (result.get("gap") or {}).get("holdout")
    if case.holdout is not None or not blocks:
        return None
    t = case.record.t
    scored = np.zeros(t.size, dtype=bool)
    for begin, end in blocks:
        scored |= (t >= begin - 1e-9 * abs(t[-1])) & (t < end - 1e-9 * abs(t[-1]))
    return scored if 0.1 * t.size < scored.sum() < 0.9 * t.size else None


def refit_true_structure(case: Case, counts: NDArray[np.bool_]) -> FloatArray:
    """Fit the parameters of the true structure and simulate the record.

    Parameters
    ----------
    case : Case
    counts : ndarray of bool, shape (N,)
        Samples to fit.

    Returns
    -------
    ndarray, shape (N,)
        Free run over the whole record, in the record's units.
    """
    experiment, y = case.experiment, case.record.y
    names = free_parameters(experiment)
    truth = np.array([_get(experiment.setup, part, name) for part, name in names])
    spread = np.maximum(np.abs(truth), 1e-3)
    v = input_signal(experiment)

    def run(theta: FloatArray) -> FloatArray:
        away = theta - 1.0  # theta is near one because scipy's difference steps are relative to it
        start = (experiment.start[0] + away[-2], experiment.start[1] + away[-1])
        values = truth + spread * away[:-2]
        setup = experiment.setup
        for (part, name), value in zip(names, values, strict=True):
            setup = _set(setup, part, name, float(value))
        shown = simulate_setup(setup, v, Noise(0.0), start).clean
        basis = np.column_stack([shown, np.ones(shown.size)])
        return basis @ np.linalg.lstsq(basis[counts], y[counts], rcond=None)[0]

    def residual(theta: FloatArray) -> FloatArray:
        try:
            return (run(theta) - y)[counts] / case.sigma
        except UnboundedOutputError:
            return np.full(int(counts.sum()), 1e3)

    first = np.ones(len(names) + 2)
    fitted = least_squares(residual, first, diff_step=1e-3, x_scale=0.02, max_nfev=6)
    return run(fitted.x)


def free_parameters(experiment: Experiment) -> list[tuple[str, str]]:
    """Parameters of a rig and its effects that the refit estimates, as (part, name).

    Parameters
    ----------
    experiment : Experiment

    Returns
    -------
    list of (str, str)
    """
    kind = experiment.plain.motion.kind
    absent = {"T1"} if kind == MASS else set()
    absent |= set() if kind in (HEATED_FAR, HEATED_NEAR) else {"coupling"}
    modes = _MODE if experiment.setup.motion.mode else ()
    names = [("motion", name) for name in (*_MOTION, *modes) if name not in absent]
    names += [("actuator", name) for name in _ACTUATOR]
    names += [("load", name) for name in _LOAD] + [("sensor", name) for name in _SENSOR]
    values = [(part, name, _get(experiment.setup, part, name)) for part, name in names]
    return [(part, name) for part, name, value in values if value != 0.0 and np.isfinite(value)]


def simulate_linear_fit(fit: LinearFit, u_mean: float, record: Record) -> FloatArray:
    """Simulate a linear fit on another record, with the initial state estimated from the first samples.

    Parameters
    ----------
    fit : LinearFit
    u_mean : float
        Mean of the input that it was fitted on, which it was taken about.
    record : Record

    Returns
    -------
    ndarray, shape (N,)
    """
    from scipy.signal import lfilter

    num = np.concatenate([[0.0], fit.b])
    forced = fit.offset + lfilter(num, fit.a, record.u - u_mean)
    impulse = np.zeros(len(record))
    impulse[0] = 1.0
    free = lfilter([1.0], fit.a, impulse)
    basis = np.column_stack([free, np.concatenate([[0.0], free[:-1]])])
    state = np.linalg.lstsq(basis[:INITIAL_SAMPLES], (record.y - forced)[:INITIAL_SAMPLES], rcond=None)[0]
    return np.asarray(forced + basis @ state)


def pooled_closure(clean: Sequence[FloatArray], before: Sequence[FloatArray], after: Sequence[FloatArray]) -> float:
    """Closure over several fresh records, relative to their noise-free outputs.

    Parameters
    ----------
    clean, before, after : sequence of ndarray
        Noise-free outputs, and the simulations without and with the effect.

    Returns
    -------
    float
    """

    def error(runs: Sequence[FloatArray]) -> float:
        return _rms(np.concatenate([(y - x)[INITIAL_SAMPLES:] for x, y in zip(runs, clean, strict=True)]))

    return 1.0 - error(after) / error(before)


def _get(setup: Setup, part: str, name: str) -> float:
    return float(getattr(getattr(setup, part), name))


def _set(setup: Setup, part: str, name: str, value: float) -> Setup:
    old = getattr(setup, part)
    new = old._replace(**{name: value}) if part == "motion" else replace(old, **{name: value})
    return replace(setup, **{part: new})


def _rms(x: FloatArray) -> float:
    return float(np.sqrt(np.mean(x**2)))
