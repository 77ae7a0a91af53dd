"""Commands that are logged otherwise than they act."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.rig.ordinary.record_files import NONE, UNKNOWN, OrdinaryRecord, draw_bench, record_table
from labsid.rig.ordinary.signals import MANY_LEVELS, MOVING, SIGNALS, draw_signal
from labsid.rig.ordinary.systems import draw_first_order, draw_second_order, response

_CLEAR = 6.0  # rms change of the output where it changes, over the noise


def draw_coarse_log(rng: np.random.Generator) -> OrdinaryRecord | None:
    """The command acts as it was, and is logged in coarse steps."""
    return _stepped(rng, (0.3, 4.0), acts=False, answers=(NONE, UNKNOWN, ("input-quantization",)))


def draw_coarse_command(rng: np.random.Generator) -> OrdinaryRecord | None:
    """The command acts in coarse steps that the log does not have."""
    return _stepped(rng, (3.5, 20.0), acts=True, answers=(("input-quantization",),))


def draw_command_off(rng: np.random.Generator, for_a_while: bool) -> OrdinaryRecord | None:
    """From some instant on, zero, the last value or another level acts, while the command goes on in the log.

    Parameters
    ----------
    rng : Generator
    for_a_while : bool
        Whether the command acts again before the end of the record.
    """
    bench = draw_bench(rng)
    system = (draw_first_order if rng.random() < 0.5 else draw_second_order)(rng)
    signal = str(rng.choice(SIGNALS))
    u = bench.u0 + bench.us * draw_signal(rng, signal, bench.samples, system.time)
    onset = int(rng.uniform(0.2, 0.7) * bench.samples)
    end = onset + int(rng.uniform(0.1, 0.25) * bench.samples) if for_a_while else bench.samples
    level = float((0.0, u[onset - 1], bench.u0 + bench.us * rng.uniform(-1.0, 1.0))[rng.choice(3, p=[0.6, 0.25, 0.15])])
    acting = u.copy()
    acting[onset:end] = level
    y = response(system, acting, settled=True)
    sd = bench.noise * float(np.std(y))
    away = y - response(system, u, settled=True)
    moves = np.count_nonzero(np.diff(u[onset:end])) >= 4 and np.std(u[onset:end]) > 0.3 * np.std(u)
    if not moves or _rms(away[onset:end]) < _CLEAR * sd:
        return None
    y = bench.y0 + y + sd * rng.standard_normal(bench.samples)
    truth = {
        "signal": signal,
        "onset": onset * bench.Ts,
        "end": end * bench.Ts if for_a_while else None,
        "level": level,
    }
    return OrdinaryRecord((("input-off",),), {".csv": record_table(bench, u, y)}, truth)


def _stepped(
    rng: np.random.Generator, ratios: tuple[float, float], acts: bool, answers: tuple[tuple[str, ...], ...]
) -> OrdinaryRecord | None:
    """A command that is rounded, where it acts or in the log; by how much, relative to the noise, is in `ratios`."""
    bench = draw_bench(rng)
    system = (draw_first_order if rng.random() < 0.5 else draw_second_order)(rng)
    signal = str(rng.choice(MOVING if acts else MANY_LEVELS))
    u = bench.u0 + bench.us * draw_signal(rng, signal, bench.samples, system.time)
    rough = float(np.ptp(u)) / rng.uniform(6.0, 120.0)
    decade = 10.0 ** np.floor(np.log10(rough))
    step = float(decade * rng.choice([1.0, 2.0, 5.0]))
    rounded = step * (np.rint(u / step) if rng.random() < 0.7 else np.floor(u / step))
    if np.unique(rounded).size < 5:
        return None
    acting, logged = (rounded, u) if acts else (u, rounded)
    y = response(system, acting, settled=True)
    sd = bench.noise * float(np.std(y))
    logged_response = response(system, logged, settled=True)
    if not ratios[0] < np.std(y - logged_response) / sd < ratios[1]:
        return None
    y = bench.y0 + y + sd * rng.standard_normal(bench.samples)
    return OrdinaryRecord(answers, {".csv": record_table(bench, logged, y)}, {"signal": signal, "step": step})


def _rms(x: FloatArray) -> float:
    return float(np.sqrt(np.mean(x**2)))
