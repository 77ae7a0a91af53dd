"""The gap diagnosis compared with a plain search in scipy, on one core, and how its time grows.

`make bench` runs it. The record has 1,500 samples: a rig of two lags under levels, with a dead zone and a load that
sets in late, 1 % noise. labsid tries its whole table, then a second effect on top of the best three, and a third while
that gains; the figure is warm: a first run, which loads what is compiled, does not count. The second table has other
numbers of samples, of effects in the rig, and of families of effects that are tried.

The peer is written for this comparison, with care: `solve_ivp` from one change of the actuator's signal to the next
(where nothing jumps, so that its steps can be long), `least_squares` over the free-run error with the linear part free,
one start for each of the three cheapest effects (static curves of two numbers), gain and offset projected out. It tries
no pairs, takes no colour of the noise into account, holds nothing out and gives no standard errors. "rms" is what the
answer leaves: labsid's on samples that no fit has seen, the peer's on those that it was fitted to.
"""

import argparse
import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from unittest import mock

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Column, Table
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares
from scipy.signal import lfilter

from labsid.gap.diagnosis import diagnose
from labsid.gap.effects.families import CANDIDATES as FAMILIES
from labsid.records.record import Record

Array = NDArray[np.float64]

SAMPLES, HOLD, TS = 1500, 20, 0.5
EFFECTS = 2


def record(samples: int = SAMPLES, effects: int = EFFECTS) -> Record:
    """Two lags behind a dead zone from 1.9 to 2.6, the input between 1 and 4; a load begins at 70 % of the record.

    With three effects the sensor clips, too; with one there is the dead zone only.
    """
    rng = np.random.default_rng(0)
    u = w = np.repeat(rng.uniform(1.0, 4.0, -(-samples // HOLD)), HOLD)[:samples]
    if effects > 0:
        w = np.minimum(u - 1.9, 0.0) + np.maximum(u - 2.6, 0.0)
    if effects > 1:
        w = w - np.where(np.arange(samples) >= 0.7 * samples, 0.3, 0.0)
    y = w[0] + lfilter([0.0, 0.01], np.poly([0.95, 0.8]), w - w[0])
    if effects > 2:
        y = np.minimum(y, np.quantile(y, 0.85))
    y = np.asarray(y + 0.01 * np.std(y) * rng.standard_normal(samples), float)
    return Record(TS * np.arange(samples), u, y, TS, name=f"a rig with {effects} effects")


@dataclass(frozen=True)
class Candidate:
    """An effect of the plain search: its input and output maps, start values and bounds."""

    name: str
    start: Callable[[Record], list[float]]
    bounds: Callable[[Record], tuple[list[float], list[float]]]
    into: Callable[[Array, Array], Array] = lambda u, p: u
    out: Callable[[Array, Array], Array] = lambda y, p: y


def quantiles(x: Array, *shares: float) -> list[float]:
    """Start values inside the range of a signal."""
    return [float(np.quantile(x, share)) for share in shares]


def ends(x: Array, count: int) -> tuple[list[float], list[float]]:
    """Bounds: the range of a signal."""
    return [float(x.min())] * count, [float(x.max())] * count


CANDIDATES = (
    Candidate("none", lambda r: [], lambda r: ([], [])),
    Candidate(
        "input-saturation",
        lambda r: quantiles(r.u, 0.1, 0.9),
        lambda r: ends(r.u, 2),
        into=lambda u, p: np.clip(u, min(p), max(p)),
    ),
    Candidate(
        "input-dead-zone",
        lambda r: quantiles(r.u, 0.4, 0.6),
        lambda r: ends(r.u, 2),
        into=lambda u, p: np.minimum(u - min(p), 0.0) + np.maximum(u - max(p), 0.0),
    ),
    Candidate(
        "output-saturation",
        lambda r: quantiles(r.y, 0.05, 0.95),
        lambda r: ends(r.y, 2),
        out=lambda y, p: np.clip(y, min(p), max(p)),
    ),
)


def simulate(w: Array, c: float, k: float) -> Array:
    """Free run of x'' + c x' + k x = k w from rest, w held between samples; a stretch of equal w is one call."""
    state, x = np.array([w[0], 0.0]), np.empty(w.size)
    edges = [0, *(np.flatnonzero(np.diff(w)) + 1).tolist(), w.size]
    for start, stop in pairwise(edges):
        level, length = w[start], stop - start
        found = solve_ivp(
            lambda t, s, level=level: (s[1], k * (level - s[0]) - c * s[1]),
            (0.0, length),
            state,
            method="LSODA",
            t_eval=np.arange(length + 1.0),
            rtol=1e-6,
            atol=1e-8,
        )
        x[start:stop], state = found.y[0, :-1], found.y[:, -1]
    return x


def scipy_search(r: Record) -> tuple[int, str, float]:
    """Fit every candidate: their number, the name of the best by BIC, and its rms error."""
    scores = []
    for one in CANDIDATES:

        def error(theta: Array, one: Candidate = one) -> Array:
            c, k = np.exp(theta[:2])
            x = simulate(one.into(r.u, theta[2:]), c, k)
            Phi = np.column_stack([x, np.ones(x.size)])
            gains = np.linalg.lstsq(Phi, r.y, rcond=None)[0]
            return one.out(Phi @ gains, theta[2:]) - r.y

        low, high = one.bounds(r)
        start = np.array([np.log(0.3), np.log(0.02), *one.start(r)])
        bounds = ([-6.0, -9.0, *low], [2.0, 2.0, *high])
        e = least_squares(error, start, bounds=bounds, x_scale=[1.0, 1.0, *[np.std(r.u)] * len(low)]).fun
        scores.append((e.size * np.log(np.mean(e**2)) + start.size * np.log(e.size), one.name, np.sqrt(np.mean(e**2))))
    _, name, rms = min(scores)
    return len(CANDIDATES) - 1, name, float(rms)


def labsid_search(r: Record) -> tuple[int, str, float]:
    """The diagnosis: combinations tried, the effects it names, and the rms error on samples that no fit has seen."""
    report = diagnose(r).report
    names = "+".join(effect["name"] for effect in report["effects"]) or report["verdict"]
    return len(report["ranking"]), names, report["gap"]["after"]


def timed(search: Callable[[Record], tuple[int, str, float]], r: Record, runs: int) -> tuple[float, list[str]]:
    """Best time in seconds of the processor, whatever else it was doing, and the answer."""
    times = []
    for _ in range(runs):
        began = time.process_time()
        tried, names, rms = search(r)
        times.append(time.process_time() - began)
    return min(times), [str(tried), names, f"{rms:.4f}"]


def growth() -> Table:
    """Seconds of the diagnosis by samples, by effects in the rig, and by families of effects tried."""
    needed = ("input-dead-zone", "load-step")
    families = sorted(FAMILIES, key=lambda forms: forms[0].name not in needed)
    count = len(families)
    cases = {
        "samples": [(n, record(n), count) for n in (750, 1500, 3000, 6000, 10**6)],
        "effects in the rig": [(n, record(effects=n), count) for n in range(4)],
        "families tried": [(n, record(), n) for n in (count // 4, count // 2, count)],
    }
    table = Table("", "", "s", Column("answer", overflow="fold"), title_justify="left")
    table.title = f"Time of the diagnosis; otherwise {SAMPLES:,} samples, {EFFECTS} effects and {count} families"
    for what, group in cases.items():
        for number, r, tried in group:
            with mock.patch("labsid.gap.search.beam_search.CANDIDATES", tuple(families[:tried])):
                seconds, (_, names, _) = timed(labsid_search, r, 1)
            table.add_row(what, f"{number:,}", f"{seconds:.1f}", names)
        table.add_section()
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description="the gap diagnosis beside a search written with scipy")
    parser.add_argument("--samples", type=int, default=SAMPLES, help="length of the record")
    parser.add_argument("--runs", type=int, default=3, help="runs of the diagnosis; the best one counts")
    options = parser.parse_args()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    r = record(options.samples)
    labsid_search(record(min(options.samples, 600)))
    table = Table("", "s", "times", "tried", "answer", "rms", title_justify="left")
    table.title = f"Why a simulation misses a record of {len(r):,} samples"
    seconds, found = timed(labsid_search, r, options.runs)
    table.add_row("labsid", f"{seconds:.1f}", "1.0", *found)
    other, found = timed(scipy_search, r, 1)
    table.add_row("scipy", f"{other:.1f}", f"{other / seconds:.1f}", *found)
    Console().print(table)
    Console().print(growth())


if __name__ == "__main__":
    main()
