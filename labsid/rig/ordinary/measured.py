"""Measured records without a gap, and one kind with a clipping sensor."""

from collections.abc import Callable

import numpy as np
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.rig.ordinary.record_files import NONE, Bench, OrdinaryRecord, draw_bench, noisy, record_table
from labsid.rig.ordinary.signals import MANY_LEVELS, MOVING, SIGNALS, draw_signal
from labsid.rig.ordinary.systems import (
    System,
    draw_acceleration,
    draw_filtered_derivative,
    draw_first_order,
    draw_integrating,
    draw_lead,
    draw_proper_second_order,
    draw_pure_gain,
    draw_second_order,
    draw_washout,
    response,
)

DIRECT: dict[str, Callable[[np.random.Generator], System]] = {
    "direct-gain": draw_pure_gain,
    "direct-lead": draw_lead,
    "direct-washout": draw_washout,
    "direct-pd": draw_filtered_derivative,
    "direct-acceleration": draw_acceleration,
    "direct-second-order": draw_proper_second_order,
}
"""Systems whose output moves in the same sample as the input."""

_DIRECT_SIGNALS = ("multisine", "chirp", "steps", "ramps", "prbs")
_LATE_STARTS = 0.3  # share of the records that start at zero output while the input is elsewhere
_CLIPPED = (0.04, 0.25)  # share of the samples beyond each limit
_SLOW_SAMPLES, _SLOW_SHARE = 5.0, 0.25  # correlation time of slow noise, in samples and over the rig's slowest time
_DEPTH = 6.0  # rms of what is cut off there, over the noise


def draw_direct(rng: np.random.Generator, kind: str) -> OrdinaryRecord:
    """A system with a direct term.

    Parameters
    ----------
    rng : Generator
    kind : str
        One of `DIRECT`.
    """
    bench, system = draw_bench(rng), DIRECT[kind](rng)
    signal = str(rng.choice(_DIRECT_SIGNALS))
    between = "linear" if signal in MOVING and rng.random() < 0.5 else "held"
    u = bench.u0 + bench.us * draw_signal(rng, signal, bench.samples, system.time)
    y = response(system, u, settled=bool(rng.random() >= _LATE_STARTS), between=between)
    return _measured(rng, bench, u, y, {"signal": signal, "between": between})


def draw_plain(rng: np.random.Generator) -> OrdinaryRecord:
    """A strictly proper rig of the second order."""
    bench, system = draw_bench(rng), draw_second_order(rng)
    signal = str(rng.choice(SIGNALS))
    u = bench.u0 + bench.us * draw_signal(rng, signal, bench.samples, system.time)
    y = response(system, u, settled=bool(rng.random() >= _LATE_STARTS))
    return _measured(rng, bench, u, y, {"signal": signal})


def draw_integrator(rng: np.random.Generator) -> OrdinaryRecord:
    """A rig that integrates, under steps or random levels about zero."""
    bench, system = draw_bench(rng), draw_integrating(rng)
    signal = str(rng.choice(["steps", "levels", "prbs"]))
    v = draw_signal(rng, signal, bench.samples, system.time)
    u = bench.us * (v - np.mean(v))
    return _measured(rng, bench, u, response(system, u), {"signal": signal})


def draw_slow_noise(rng: np.random.Generator) -> OrdinaryRecord:
    """A plain rig whose noise is slow; it may be named where it is slow for the rig, too, and is no gap in any case."""
    bench = draw_bench(rng)
    system = (draw_first_order if rng.random() < 0.4 else draw_second_order)(rng)
    signal = str(rng.choice(SIGNALS))
    u = bench.u0 + bench.us * draw_signal(rng, signal, bench.samples, system.time)
    y = response(system, u, settled=True)
    least = max(_SLOW_SAMPLES, _SLOW_SHARE * system.time)
    time = least * (rng.uniform(0.3, 0.9) if rng.random() < 0.5 else np.exp(rng.uniform(np.log(1.2), np.log(8.0))))
    pole = np.exp(-1.0 / time)
    share = float(np.exp(rng.uniform(np.log(0.01), np.log(0.06))))
    settling = int(10.0 * time)
    e = lfilter([np.sqrt(1.0 - pole**2)], [1.0, -pole], rng.standard_normal(bench.samples + settling))[settling:]
    y = y + share * np.std(y) * e
    y, _ = noisy(rng, y, 0.1 * share)
    answers = (NONE, ("coloured-noise",)) if time > least else (NONE,)
    truth = {"signal": signal, "correlation_time": float(time) * bench.Ts, "noise": share}
    return OrdinaryRecord(answers, {".csv": record_table(bench, u, bench.y0 + y)}, truth)


def draw_clipped(rng: np.random.Generator, both: bool) -> OrdinaryRecord | None:
    """A sensor that stops at one limit or two; most often the noise, too, stops there.

    Parameters
    ----------
    rng : Generator
    both : bool
        Whether it stops at either end.
    """
    bench = draw_bench(rng)
    system = (draw_first_order if rng.random() < 0.4 else draw_second_order)(rng)
    signal = str(rng.choice([*MANY_LEVELS, "prbs"]))
    u = bench.u0 + bench.us * draw_signal(rng, signal, bench.samples, system.time)
    clean = response(system, u, settled=True)
    sides = rng.random() < 0.5
    shares = rng.uniform(*_CLIPPED, 2)
    low = float(np.quantile(clean, shares[0])) if both or sides else -np.inf
    high = float(np.quantile(clean, 1.0 - shares[1])) if both or not sides else np.inf
    sd = bench.noise * float(np.std(clean))
    depths = [(clean - high)[clean > high], (low - clean)[clean < low]]
    if high - low < 20.0 * sd or any(x.size and np.sqrt(np.mean(x**2)) < _DEPTH * sd for x in depths):
        return None
    if sum(x.size > 0 for x in depths) < 1 + both:
        return None
    e = sd * rng.standard_normal(bench.samples)
    y = np.clip(clean + e, low, high) if rng.random() < 0.75 else np.clip(clean, low, high) + e
    limits = {"low": bench.y0 + low, "high": bench.y0 + high}
    truth = {"signal": signal, **{name: level for name, level in limits.items() if np.isfinite(level)}}
    form = "%.6g" if rng.random() < 0.5 else "%.8g"
    return OrdinaryRecord((("output-saturation",),), {".csv": record_table(bench, u, bench.y0 + y, form)}, truth)


def _measured(
    rng: np.random.Generator, bench: Bench, u: FloatArray, y: FloatArray, truth: dict[str, str]
) -> OrdinaryRecord:
    y, _ = noisy(rng, y, bench.noise)
    return OrdinaryRecord((NONE,), {".csv": record_table(bench, u, bench.y0 + y)}, truth)
