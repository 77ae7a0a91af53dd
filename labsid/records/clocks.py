"""Signals with times of their own, and signals at uneven times: both are brought to the times of one clock."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.records.even_times import MAX_JITTER
from labsid.records.reading import Reading
from labsid.records.resampling import band_limited_at, even_grid, held_at, is_held
from labsid.records.signals import Signals, is_input


def bring_together(signals: Signals, times: Mapping[str, FloatArray], how: Reading) -> Signals:
    """Signals with times of their own: inputs held, outputs where they were measured."""
    if min(t.size for t in times.values()) < 2:
        got = " and ".join(f"{t.size} of {signals.called(key)}" for key, t in times.items())
        raise ValueError(f"each signal must have at least 2 samples; got {got}.")
    start, stop = max(t[0] for t in times.values()), min(t[-1] for t in times.values())
    if how.resample is not None:
        t = even_grid(start, stop, how.resample)
        values, notes = resampled(t, {key: (times[key], x) for key, x in signals.values.items()}, signals)
        return replace(signals, t=t, values=values).said(*notes)
    inputs, outputs = [key for key in times if is_input(key)], [key for key in times if not is_input(key)]
    step_y = float(np.median(np.diff(times[outputs[0]])))
    steps = {key: float(np.median(np.diff(times[key]))) for key in inputs}
    is_fast = step_y <= 1.5 * min(steps.values())
    for keys in (outputs, [] if is_fast else inputs):
        for key in keys[1:]:
            if not np.array_equal(times[key], times[keys[0]]):
                raise ValueError(
                    f"{signals.called(key)} and {signals.called(keys[0])} have different times. Bring all signals to "
                    f"one sampling time with resample (--resample {step_y:g})."
                )
    if is_fast:
        return _inputs_at_outputs(signals, times, inputs, outputs, start)
    return _outputs_at_inputs(signals, times, inputs, outputs, start, stop)


def _inputs_at_outputs(
    signals: Signals, times: Mapping[str, FloatArray], inputs: Sequence[str], outputs: Sequence[str], start: float
) -> Signals:
    """Each input held at the times of the outputs, which are at least as fast."""
    t_y, y = times[outputs[0]], signals.called(outputs[0])
    inside, notes, values = t_y >= start, [], {}
    for key in inputs:
        t_u = times[key]
        step = float(np.median(np.diff(t_u)))
        if np.diff(t_u).max() <= 1.5 * step:  # a command that is sent when it changes is held on
            inside &= t_y < t_u[-1] + step
        if not np.array_equal(t_u, t_y):
            notes.append(f"{signals.called(key)} has times of its own, {step:g} s apart; held at those of {y}")
    t = t_y[inside]
    if t.size < 2:
        t_u, u = times[inputs[0]], signals.called(inputs[0])
        raise ValueError(f"{u} is there from {t_u[0]:g} to {t_u[-1]:g} s and {y} from {t_y[0]:g} to {t_y[-1]:g} s.")
    for key, x in signals.values.items():
        values[key] = held_at(t, times[key], x) if key in inputs else x[inside]
    left_out = _left_out(int(np.sum(~inside)), y, signals.called(inputs[0]))
    return replace(signals, t=t, values=values).said(*notes, *left_out)


def _outputs_at_inputs(
    signals: Signals,
    times: Mapping[str, FloatArray],
    inputs: Sequence[str],
    outputs: Sequence[str],
    start: float,
    stop: float,
) -> Signals:
    """Outputs at the nearest samples of the inputs, which are faster; missing between them."""
    t_u, t_y, u, y = times[inputs[0]], times[outputs[0]], signals.called(inputs[0]), signals.called(outputs[0])
    step_u, step_y = float(np.median(np.diff(t_u))), float(np.median(np.diff(t_y)))
    place = np.clip(np.searchsorted(t_u, t_y), 1, t_u.size - 1)
    place -= t_y - t_u[place - 1] < t_u[place] - t_y
    off = np.abs(t_u[place] - t_y)
    near = off <= MAX_JITTER * step_u
    if np.any(~near & (t_y >= start) & (t_y <= stop)):
        raise ValueError(
            f"{u} has a sample every {step_u:g} s and {y} every {step_y:g} s, not at the same times. Bring both to one "
            f"sampling time with resample (--resample {step_y:g})."
        )
    values = dict(signals.values)
    for key in outputs:
        values[key] = np.full(t_u.size, np.nan)
        values[key][place[near]] = signals.values[key][near]
    notes = [f"{signals.called(key)} has times of its own, {step_y:g} s apart; missing between them" for key in outputs]
    return replace(signals, t=t_u, values=values).said(*notes, *_left_out(int(np.sum(~near)), y, u))


def _left_out(count: int, y: str, u: str) -> tuple[str, ...]:
    samples = "1 sample" if count == 1 else f"{count} samples"
    return (f"{samples} of {y} before the first of {u} or after its last left out",) if count else ()


def resampled(
    t: FloatArray, samples: Mapping[str, tuple[FloatArray, FloatArray]], signals: Signals
) -> tuple[dict[str, FloatArray], tuple[str, ...]]:
    """Signals at even times: a held input held, anything else interpolated; and what is to be said of it."""
    Ts = float(t[1] - t[0])
    values, notes = {}, [f"resampled to {Ts:.9g} s, {t.size} samples"]
    for key, (stamps, x) in samples.items():
        name = signals.called(key)
        if is_input(key) and is_held(x):
            values[key] = held_at(t, stamps, x)
            notes.append(f"{name} held between its samples: a change acts up to one sample late, as a delay would")
        elif _coincide(t, stamps[np.isfinite(x)]):
            values[key] = held_at(t, stamps, x)
            notes.append(f"{name} taken at its own samples")
        else:
            values[key] = band_limited_at(t, stamps, x)
            notes.append(f"{name} interpolated, band-limited to {0.4 / Ts:.3g} Hz: what is faster is lost")
    return values, tuple(notes)


def _coincide(t: FloatArray, stamps: FloatArray) -> bool:
    """Whether a signal has a sample at each of these times, and none between them."""
    return stamps.size == t.size and bool(np.abs(stamps - t).max() <= 1e-3 * (t[1] - t[0]))
