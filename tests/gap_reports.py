"""Hand-made reports of the gap diagnosis for every verdict and effect."""

import math
from typing import Any


def quantity(value: float, stderr: float, unit: str) -> dict[str, Any]:
    """One parameter's entry."""
    return {"value": value, "stderr": stderr, "unit": unit}


PARAMETERS: dict[str, dict[str, dict[str, Any]]] = {
    "input-delay": {"delay": quantity(0.43394, 0.00035, "s")},
    "input-saturation": {"low": quantity(-0.5115, 0.0007, "u"), "high": quantity(0.0897, 0.0005, "u")},
    "input-dead-zone": {"low": quantity(0.458, 0.0013, "u"), "high": quantity(0.8754, 0.0012, "u")},
    "input-backlash": {"width": quantity(0.32, 0.01, "u")},
    "input-rate-limit": {"rate": quantity(1.71, 0.02, "u/s")},
    "input-off": {
        "onset": quantity(72.0, 0.02, "s"),
        "end": quantity(90.0, 0.02, "s"),
        "level": quantity(0.01, 0.02, "u"),
    },
    "input-quantization": {"step": quantity(0.25, 0.001, "u")},
    "input-nonlinearity": {
        "c2": quantity(6.02e-5, 3.8e-6, "1/u"),
        "c3": quantity(3.4e-9, 1.4e-9, "1/u^2"),
        "centre": quantity(-1069.1, 0.0, "u"),
    },
    "extra-lag": {"tau": quantity(2.51, 0.03, "s")},
    "resonance": {"frequency": quantity(8.5788, 0.0021, "Hz"), "damping": quantity(0.0591, 0.00025, "1")},
    "sqrt-outflow": {"zero": quantity(-0.531, 0.0022, "u"), "empty": quantity(14.533, 0.024, "y")},
    "overflow": {"level": quantity(10.1, 0.06, "y"), "caught": quantity(0.31, 0.04, "1")},
    "coulomb-friction": {"friction": quantity(1.7018, 0.0032, "u")},
    "cubic-stiffness": {"cubic": quantity(-0.9375, 0.0027, "1/y^2")},
    "end-stop": {"low": quantity(-0.4998, 0.0006, "y"), "high": quantity(0.4502, 0.0005, "y")},
    "quadratic-drag": {"drag": quantity(0.166, 0.002, "u s^2/y^2")},
    "gravity": {
        "torque": quantity(0.3715, 0.0021, "u"),
        "angle": quantity(-0.0142, 0.0031, "y"),
        "per_radian": quantity(1.0, 0.0, "y"),
    },
    "force-limit": {"limit": quantity(0.4141, 0.0012, "u")},
    "slow-mode": {"tau": quantity(8.15, 0.3, "s"), "share": quantity(0.287, 0.006, "1")},
    "parameter-drift": {"drift": quantity(-0.597, 0.001, "1")},
    "output-drift": {"amplitude": quantity(0.07595, 0.00057, "y")},
    "output-saturation": {"high": quantity(243.712, 0.008, "y")},
    "output-nonlinearity": {
        "c2": quantity(-0.0795, 0.0004, "1/y"),
        "c3": quantity(0.1026, 0.0003, "1/y^2"),
        "centre": quantity(6.964, 0.0, "y"),
    },
    "output-backlash": {"width": quantity(0.299, 0.001, "y")},
    "output-quantization": {"step": quantity(0.01295, 0.0, "y")},
    "output-outliers": {"share": quantity(0.0072, 0.0, "1")},
    "output-dropout": {"share": quantity(0.1186, 0.0, "1")},
    "load-step": {"onset": quantity(374.25, 0.8, "s"), "size": quantity(-0.21, 0.004, "y")},
    "periodic-disturbance": {"frequency": quantity(0.0861, 0.0002, "Hz"), "amplitude": quantity(0.00467, 1e-5, "y")},
    "coloured-noise": {"amplitude": quantity(0.0454, 0.0022, "y"), "pole": quantity(0.94, 0.006, "1")},
    "coupling": {"gain": quantity(0.699, 0.0, "y/u")},
    "parameter-mismatch": {},
}

UNSIMULATED = ("output-dropout", "output-outliers", "output-quantization", "coloured-noise")

PATHS = {"load-step": "disturbance", "periodic-disturbance": "disturbance", "coloured-noise": "disturbance"}
DYNAMICS = (
    "extra-lag",
    "resonance",
    "sqrt-outflow",
    "overflow",
    "coulomb-friction",
    "cubic-stiffness",
    "end-stop",
    "quadratic-drag",
    "gravity",
    "force-limit",
    "slow-mode",
    "coupling",
    "parameter-drift",
)


def path_of(name: str) -> str:
    """The path on which an effect acts."""
    if name == "parameter-mismatch":
        return "parameters"
    return "dynamics" if name in DYNAMICS else PATHS.get(name, name.split("-")[0])


def effect(name: str, probability: float = 0.999, closed: float | None = 0.97) -> dict[str, Any]:
    """An effect with plausible parameters."""
    parameters = {key: dict(entry) for key, entry in PARAMETERS.get(name, {}).items()}
    return {
        "name": name,
        "path": path_of(name),
        "parameters": parameters,
        "probability": probability,
        "closed": closed,
    }


SEEN = {"overflow": {"level": 4.5}, "output-saturation": {"high": 4.5}, "load-step": {"onset": 60.0}}
"""Values of parameters that lie within the record of `report`."""


def seen_effect(name: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """A report of one effect that acts within its record, and the effect."""
    shown = report(name)
    (found,) = shown["effects"]
    for parameter, value in SEEN.get(name, {}).items():
        found["parameters"][parameter]["value"] = value
    return shown, found


def report(*names: str, verdict: str = "effect", probability: float = 0.999) -> dict[str, Any]:
    """A report of these effects, or of none, in the layout ``labsid.gap/4``."""
    n, Ts = 240, 0.5
    t = [Ts * k for k in range(n)]
    u = [float(k // 20 % 4) for k in range(n)]
    y = [4.0 + math.sin(0.11 * k) for k in range(n)]
    before = [value + (0.4 if 60 <= k < 90 else 0.05) * math.cos(0.7 * k) for k, value in enumerate(y)]
    plain, unchanged = verdict == "none", verdict in ("none", "unknown")
    after = before if unchanged else [value + 0.01 * math.cos(1.9 * k) for k, value in enumerate(y)]
    first = names[0] if names else "input-delay"
    simulated = [name for name in names if name not in UNSIMULATED]
    tried = ["+".join(simulated) or first, "resonance", "extra-lag", "input-backlash+output-drift"]
    chances = (0.0,) * 4 if verdict == "unknown" else (0.99, 0.007, 0.002, 0.001)
    effects = [effect(name, probability) for name in names] if verdict in ("effect", "partial") else []
    given = verdict == "effect" and "parameter-mismatch" in names
    return {
        "schema": "labsid.gap/4",
        "verdict": verdict,
        "effects": effects,
        "ambiguous": [],
        "ranking": [
            {"name": name, "probability": p, "rmse": 0.01 * k, "closed": None if plain else 0.98 - 0.3 * k, "bic": -9.0}
            for k, (name, p) in enumerate(zip(tried, chances, strict=True), 1)
        ],
        "where": {
            "path": effects[0]["path"] if effects else verdict,
            "time": [[0.0, 30.0, 0.1], [30.0, 45.0, 0.8], [45.0, 120.0, 0.1]],
            "band_hz": [[0.0, 0.25, 0.1], [0.25, 0.5, 0.7], [0.5, 1.0, 0.2]],
            "operating": [
                {"signal": "u", "low": 0.0, "high": 1.0, "share": 0.05, "time": 0.25},
                {"signal": "u", "low": 1.0, "high": 2.0, "share": 0.05, "time": 0.25},
                {"signal": "u", "low": 2.0, "high": 3.0, "share": 0.9, "time": 0.5},
            ],
            "map": {"u": [0.0, 1.0, 2.0, 3.0], "y": [3.0, 4.0, 5.0], "rms": [[0.1, None], [0.2, 0.3], [0.4, 0.2]]},
        },
        "gap": {
            "before": 0.0102 if plain else 0.0644,
            "after": 0.0644 if verdict == "unknown" else 0.0102,
            "noise_floor": 0.01,
            "closed": None if plain else 0.0 if unchanged else 0.969,
            "ci95": None if plain else [0.0, 0.0] if unchanged else [0.939, 0.998],
            "holdout": [[20.0, 40.0], [80.0, 100.0]],
        },
        "unexplained": {
            "share": 0.0 if verdict in ("none", "effect") else 1.0 if unchanged else 0.031,
            "whiteness_p": 0.73,
            "input_correlation_p": 0.42,
            "path": None,
            "kinds": None,
            "rms": 0.0101,
            "colour": 1.0,
            "repeats": 0.0,
        },
        "limits": [],
        "next_experiment": None,
        "record": {"name": "rig-7", "samples": n, "Ts": Ts},
        "simulation": {
            "given": given,
            "output_only": False,
            "closed": False,
            "output": None,
            "model": None if given else {"method": "output error", "observed": True},
        },
        "numbers": [],
        "screen": [],
        "record_findings": [],
        "plateaus": None,
        "traces": {"t": t, "u": u, "y": y, "before": before, "after": after},
        "holdout_traces": None,
    }


def limits_row(name: str, **changes: Any) -> dict[str, Any]:
    """A row of limits of one effect."""
    return {
        "name": name,
        "signal": "u",
        "parameter": "width",
        "unit": "u",
        "detect": 0.02,
        "named": 0.05,
        "rival": "coulomb-friction",
        "excluded_above": 0.01,
        "why": None,
        "tested": None,
        "share": {"detect": 0.004, "named": 0.01, "excluded_above": 0.002},
        "of": "u",
        "at": {},
    } | changes


def with_limits(base: dict[str, Any]) -> dict[str, Any]:
    """The same report with an effect that is told from others, one that is only visible, and one that is neither."""
    looks = "It looks like dry friction here, at every size that was tried. Needed: Other inputs."
    none = {"detect": None, "named": None, "excluded_above": None}
    share = {"detect": 0.3, "named": None, "excluded_above": 0.2}
    rows = [
        limits_row("input-backlash"),
        limits_row("input-saturation", parameter="high", rival=None),
        limits_row(
            "input-saturation", parameter="low", share=share | {"excluded_above": None}, **none | {"detect": 1.5}
        ),
        limits_row("input-delay", parameter="delay", unit="s", of="time", named=None, share=share, why=looks),
        limits_row("slow-mode", parameter="share", unit="1", of="gain", signal=None),
        limits_row("extra-lag", signal=None, share=None, why="The input has two levels only.", **none),
    ]
    rows[-1] |= {"parameter": None, "unit": None, "of": None, "rival": None}
    return base | {"limits": rows}


KINDS = {"linear": 0.1, "input": 0.0, "output": 0.03, "nonlinear": 0.07, "time": 0.0, "disturbance": 0.2}


def with_rest(base: dict[str, Any], kind: str) -> dict[str, Any]:
    """The same report, of which the rest is no noise and mainly of one kind."""
    kinds = KINDS | {kind: 0.0}
    kinds[kind] = 1.0 - sum(kinds.values())
    path = "dynamics" if kind in ("linear", "nonlinear") else kind
    rest = {"whiteness_p": 1e-9, "input_correlation_p": 1e-6, "kinds": kinds, "path": path}
    return base | {"unexplained": base["unexplained"] | rest}


def with_holdout(base: dict[str, Any]) -> dict[str, Any]:
    """The same report, scored on another record, which begins at 500 s."""
    other = {name: list(values) for name, values in base["traces"].items()}
    other["t"] = [500.0 + t for t in other["t"]]
    return base | {"holdout_traces": other, "gap": base["gap"] | {"holdout": [[525.0, 620.0]]}}


def with_plateaus(base: dict[str, Any], left: float) -> dict[str, Any]:
    """The same report for a record whose levels do not repeat; `left` is the part not explained."""
    finding = {"level": "note", "topic": "plateaus", "text": "y does not come back to the same level. It should."}
    seen = {"repeat": False, "largest": 0.09, "scatter": 0.05, "missed": 0.04, "of_gap": 0.8, "left": left}
    return base | {"record_findings": [finding], "plateaus": seen}


def with_experiment(base: dict[str, Any]) -> dict[str, Any]:
    """The same report with a rival and the experiment that separates it."""
    ours = "+".join(entry["name"] for entry in base["effects"]) or "input-delay"
    rival = f"{ours}+output-drift"
    experiment = {
        "separates": [ours, rival],
        "why": f"On ramps, {rival} cannot follow what {ours} does.",
        "t": [0.0, 0.5, 1.0, 1.5],
        "u": [0.0, 3.0, 1.0, 2.0],
        "margin": 41.0,
    }
    return base | {"next_experiment": experiment, "ambiguous": ["output-drift"]}


def undrawn_figures(report: dict[str, Any]) -> dict[str, dict[str, str]]:
    """In place of the encoded figures, which take most of the time of a page."""
    return {name: {"wide": "", "narrow": ""} for name in ("first", "simulations", "where", "experiment", "limits")}
