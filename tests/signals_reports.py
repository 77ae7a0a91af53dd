"""Hand-made reports of a diagnosis of several signals."""

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from gap_reports import effect, report, with_holdout, with_limits
from scipy.signal import lfilter

from labsid.gap.reports.quantities import with_units
from labsid.gap.reports.traces import packed

Named = tuple[str, str]  # a signal and its unit
INPUTS: tuple[Named, ...] = (("valve", "V"), ("heater", "%"))
OUTPUTS: tuple[Named, ...] = (("level", "cm"), ("temperature", ""))


def signals_report(
    *effects: tuple[str, str | None],
    verdict: str = "effect",
    probability: float = 0.99,
    inputs: Sequence[Named] = INPUTS,
    outputs: Sequence[Named] = OUTPUTS,
    holdout: bool = False,
) -> dict[str, Any]:
    """A report of these effects, each at a signal or in the dynamics, in the layout ``labsid.gap/4``."""
    base = report(*(name for name, _ in effects), verdict=verdict, probability=probability)
    base = with_holdout(base) if holdout else base
    units, named = dict((*inputs, *outputs)), [name for name, _ in outputs]
    worst, main = named[-1], inputs[(len(outputs) - 1) % len(inputs)][0]
    own = {name: _output(base, k, inputs[k % len(inputs)][0]) for k, name in enumerate(named)}
    errors = {"before": 6.4, "after": 6.4 if verdict in ("none", "unknown") else 1.02, "noise_floor": 1.0}
    return {
        **{key: base[key] for key in ("verdict", "record", "simulation", "next_experiment", "limits", "numbers")},
        "schema": "labsid.gap/4",
        "signals": {
            "inputs": [{"name": name, "unit": unit} for name, unit in inputs],
            "outputs": [{"name": name, "unit": unit} for name, unit in outputs],
        },
        "effects": [_effect(*one, probability, worst, main, units) for one in effects],
        "ambiguous": [],
        "ranking": [row | {"signal": main, "output": worst} for row in base["ranking"]],
        "where": base["where"]
        | {
            "operating": [cell | {"signal": main} for cell in base["where"]["operating"]],
            "output": worst,
            "outputs": {name: (k + 1) / sum(range(1, len(named) + 1)) for k, name in enumerate(named)},
        },
        "gap": base["gap"]
        | errors
        | {
            "outputs": {name: one["gap"] | {"sd": 0.7} for name, one in own.items()},
            "over_sd": {key: 0.01 * size for key, size in errors.items()},
            "mode": "free",
        },
        "noise": {},
        "reference": "inside",
        "unexplained": base["unexplained"] | {"output": worst},
        "couplings": [
            {"from": u, "to": y, "share": share}
            for k, y in enumerate(named)
            for share, u in zip((0.86, 0.14), _two(inputs, k), strict=False)
        ],
        "findings": [],
        "outputs": own,
    }


def _output(base: dict[str, Any], k: int, main: str) -> dict[str, Any]:
    """An output that is like the others, except for its size."""
    kept = ("verdict", "gap", "where", "unexplained", "screen", "traces", "holdout_traces")
    own = {key: base[key] for key in kept if base[key] is not None}
    scaled = {key: _scaled(base[key], 1.0 + k) for key in ("traces", "holdout_traces") if base[key] is not None}
    return {"main": main, **own, **scaled}


def _scaled(trace: dict[str, list[float]], by: float) -> dict[str, list[float]]:
    return {name: x if name in ("t", "u") else [by * value for value in x] for name, x in trace.items()}


def _two(inputs: Sequence[Named], k: int) -> list[str]:
    """The two inputs that move an output."""
    return list(dict.fromkeys(inputs[(k + step) % len(inputs)][0] for step in (0, 1)))


def _effect(
    name: str, signal: str | None, probability: float, worst: str, main: str, units: dict[str, str]
) -> dict[str, Any]:
    found = effect(name, probability) | {"signal": signal, "outputs": [worst]}
    u, y = units.get(signal or main, ""), units.get(signal or worst, "")
    return with_units({"effects": [found]}, u, y)["effects"][0] if u and y else found


def true_step(u: int, y: int, lag: np.ndarray) -> np.ndarray:
    """Height of output `y` after so many samples with one unit more of input `u`, of `with_details`."""
    gain, tau = (1.0 + u + 2.0 * y), 4.0 + 3.0 * u
    return gain * (1.0 - np.exp(-lag / tau))


def with_details(base: dict[str, Any], samples: int = 3000) -> dict[str, Any]:
    """The same report with limits of each output, and all samples and poles of first-order lags from every input.

    The inputs are alike in part. The simulation after leaves white noise, the one before has four fifths of the gains.
    """
    rng, outputs = np.random.default_rng(5), {}
    common, *own = np.repeat(rng.standard_normal((3, samples // 10)), 10, axis=1)
    inputs = {one["name"]: 40.0 + common + own[i % 2] for i, one in enumerate(base["signals"]["inputs"])}
    for j, (name, one) in enumerate(base["outputs"].items()):
        y = np.zeros(samples)
        for i, u in enumerate(inputs.values()):
            pole = np.exp(-1.0 / (4.0 + 3.0 * i))
            y += lfilter([0.0, (1.0 + i + 2.0 * j) * (1.0 - pole)], [1.0, -pole], u - 40.0)
        signals = {"y": y + 0.01 * rng.standard_normal(samples), "before": 0.8 * y, "after": y}
        part = {"start": 0.0, "Ts": 0.5, "fitted": [[0, samples]], "scored": []}
        part |= {"u": packed(inputs[one["main"]] - 40.0, "<f8")} | {key: packed(x) for key, x in signals.items()}
        scale = {"centre": 0.0, "unit": 1.0}
        root = {"value": [0.8, 0.0], "covariance": [[1e-4, 0.0], [0.0, 0.0]]}
        dynamics = {key: {"poles": [root], "zeros": [], "linearised": False} for key in ("before", "after")}
        replay = {"u_scale": scale | {"centre": 40.0}, "y_scale": scale, "record": part, "holdout": None}
        outputs[name] = one | {"replay": replay, "dynamics": dynamics}
    rows = [row | {"output": name} for name in outputs for row in with_limits({})["limits"]]
    packed_inputs = {name: packed(u, "<f8") for name, u in inputs.items()}
    return base | {"outputs": outputs, "limits": rows, "input_samples": packed_inputs}


def undrawn_signal_figures(report: dict[str, Any]) -> dict[str, dict[str, str]]:
    """In place of the encoded figures of a page without details, which take most of its time."""
    names = ("first", "signals", "zoom", "couplings", "where", "holdout", "experiment")
    return {name: {"wide": "", "narrow": ""} for name in names}


def undrawn_in_both_widths(figures: Iterable[str], report: dict[str, Any]) -> dict[str, dict[str, bytes]]:
    """In place of `page_figures.in_both_widths`: the names of the figures, and no pictures."""
    return {name: {"wide": b"", "narrow": b""} for name in figures}


def with_planned_inputs(base: dict[str, Any]) -> dict[str, Any]:
    """The same report with a proposed input; the other inputs rest."""
    first, *others = [one["name"] for one in base["signals"]["inputs"]]
    t = [0.5 * k for k in range(60)]
    moved = {first: [math.copysign(1.0, math.sin(0.3 * x)) for x in t]}
    planned = {
        "separates": ["input-delay", "extra-lag"],
        "why": "Steps of this length separate input-delay from extra-lag.",
        "t": t,
        "u": moved | {name: [0.25] * len(t) for name in others},
        "margin": 25.0,
    }
    return base | {
        "next_experiment": planned,
        "ambiguous": [{"name": "extra-lag", "signal": None}, {"name": "input-rate-limit", "signal": first}],
    }
