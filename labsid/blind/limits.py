"""Row `limits`: plant effects of the sizes that ``labsid gap limits`` states into rigs without one, and diagnose them.

``labsid gap blind --row limits`` and ``python -m labsid.blind.limits`` draw rigs without an effect, ask what their
records could have shown, and plant effects of the smallest named size, and of half of it, under new noise. They print
how many are named, and in how many records without a named effect the planted size is beyond what the report excludes;
the second one each planted effect, too.
"""

import argparse
import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from labsid.blind.draws import draw_experiment, log_uniform
from labsid.blind.experiment import Experiment, input_signal, run_experiment, to_record
from labsid.blind.metrics import Metric, rate, wilson
from labsid.blind.runner import run_folder
from labsid.blind.strength import STRONGEST_NOISE, WEAKEST_NOISE, clean_output, output_spread
from labsid.blind.suite import write_record
from labsid.rig.switchable.effects import supports_effect
from labsid.rig.switchable.inputs import RICH_INPUTS
from labsid.rig.switchable.plants import Scales
from labsid.rig.switchable.setup import Setup
from labsid.rig.switchable.simulation import Noise

ROW = "limits"
SEED = 20261
EFFECTS_A_RIG = 4
SIZES = {"named": 1.0, "half": 0.5}  # planted sizes over the smallest that is named
PLACES = "onset", "frequency", "tau"  # further parameters of which a limit depends
SAME_PLACE = 0.01  # relative difference of these
MIN_PROBABILITY = 0.5  # of a named effect
_SEVERAL = "import json, sys\nfrom labsid.cli.commands import main\nfor line in json.load(sys.stdin):\n    main(line)"
_PLANTED = {
    ("input-delay", "delay"),
    ("input-saturation", "high"),
    ("input-saturation", "low"),
    ("input-dead-zone", "width"),
    ("input-backlash", "width"),
    ("input-rate-limit", "rate"),
    ("input-nonlinearity", "c2"),
    ("extra-lag", "tau"),
    ("slow-mode", "share"),
    ("parameter-drift", "drift"),
    ("output-saturation", "high"),
    ("output-saturation", "low"),
    ("output-nonlinearity", "c2"),
    ("output-backlash", "width"),
    ("output-drift", "amplitude"),
    ("load-step", "size"),
    ("periodic-disturbance", "amplitude"),
}


@dataclass(frozen=True, slots=True, eq=False)
class Planting:
    """One record with a planted effect.

    Attributes
    ----------
    name : str
        Of the record.
    effect, parameter : str
    times : str
        Of `SIZES`.
    share : float
        Size of the effect, as the report states shares.
    value : float
        The same in the unit of the report.
    at : dict
        Other parameters of the effect.
    """

    name: str
    effect: str
    parameter: str
    times: str
    share: float
    value: float
    at: dict[str, float]


def planted_setup(setup: Setup, scales: Scales, row: dict[str, Any], value: float, gain: float) -> Setup:
    """The rig with one effect of a size.

    Parameters
    ----------
    setup : Setup
        The rig without effects.
    scales : Scales
    row : dict
        Of `limits` in the report.
    value : float
        The size, in the unit of the row.
    gain : float
        Output per unit of load, in rig units.
    """
    a, m, sensor, at = setup.actuator, setup.motion, setup.sensor, row["at"]
    us, ys = scales.us, scales.ys
    u, y = (value - scales.u0) / us, (value - scales.y0) / ys
    match row["name"], row["parameter"]:
        case "input-delay", _:
            return replace(setup, actuator=replace(a, delay=value / scales.Ts))
        case "input-saturation", side:
            return replace(setup, actuator=replace(a, low=u) if side == "low" else replace(a, high=u))
        case "input-dead-zone", _:
            middle = (0.5 * (at["low"] + at["high"]) - scales.u0) / us
            half = 0.5 * value / us
            return replace(setup, actuator=replace(a, dead_low=middle - half, dead_high=middle + half))
        case "input-backlash", _:
            return replace(setup, actuator=replace(a, backlash=value / us))
        case "input-rate-limit", _:
            return replace(setup, actuator=replace(a, slew=value * scales.Ts / us))
        case "input-nonlinearity", _:
            return replace(setup, actuator=replace(a, c2=value * us))
        case "extra-lag", _:
            return replace(setup, motion=m._replace(actuator_lag=value / scales.Ts))
        case "slow-mode", _:
            return replace(setup, motion=m._replace(slow_share=value, slow_time=at["tau"] / scales.Ts))
        case "parameter-drift", _:
            return replace(setup, actuator=replace(a, gain_change=value, zero=(at["middle"] - scales.u0) / us))
        case "output-saturation", side:
            side = side if ys > 0.0 else {"low": "high", "high": "low"}[side]
            return replace(setup, sensor=replace(sensor, low=y) if side == "low" else replace(sensor, high=y))
        case "output-nonlinearity", _:
            return replace(setup, sensor=replace(sensor, c2=value * ys))
        case "output-backlash", _:
            return replace(setup, motion=m._replace(play=value / abs(ys)))
        case "output-drift", _:
            return replace(setup, sensor=replace(sensor, drift=2.0 * value / abs(ys)))
        case "load-step", _:
            onset = at["onset"] / scales.Ts
            return replace(setup, load=replace(setup.load, onset=onset, size=value / (ys * gain)))
        case "periodic-disturbance", _:
            frequency = at["frequency"] * scales.Ts
            return replace(setup, sensor=replace(sensor, amplitude=value / abs(ys), frequency=frequency))
    raise ValueError(f"row must name an effect that can be planted; got {row['name']!r}. See _PLANTED.")


def size_at(row: dict[str, Any], share: float) -> float:
    """The size in the unit of the row, for a share: all are proportional, inverse, or a distance from an end."""
    value, own = row["named"], row["share"]["named"]
    if row["parameter"] == "rate":
        return float(value * own / share)
    if row["parameter"] in ("high", "low"):
        end = row["end"]
        return float(end + (value - end) * share / own)
    return float(value * share / own)


def draw_rig(rng: np.random.Generator) -> Experiment:
    """A rig without effects, a rich input and white noise."""
    experiment = draw_experiment(rng, "", int(rng.integers(800, 2001)), RICH_INPUTS)
    sigma = output_spread(experiment) * log_uniform(rng, WEAKEST_NOISE, STRONGEST_NOISE)
    return replace(experiment, noise=Noise(sigma, 0.0, 0.0, int(rng.integers(2**31))))


def limits_of(folder: Path, names: Sequence[str]) -> Iterator[dict[str, Any]]:
    """What ``labsid gap limits`` says of records, in a process of its own."""
    lines = [["gap", "limits", f"{name}.csv", "--json", f"{name}.limits.json"] for name in names]
    subprocess.run(
        [sys.executable, "-c", _SEVERAL], cwd=folder, input=json.dumps(lines), text=True, stdout=subprocess.DEVNULL
    )
    for name in names:
        yield json.loads((folder / f"{name}.limits.json").read_text(encoding="utf-8"))


def plant(
    folder: Path, rng: np.random.Generator, experiment: Experiment, name: str, limits: dict[str, Any]
) -> list[Planting]:
    """Write records of a rig with an effect of each of the `SIZES`, a few effects of those that it can have."""
    scales, made = experiment.scales, []
    v, y = input_signal(experiment), clean_output(experiment, experiment.plain)
    u, readings = scales.u0 + scales.us * v, scales.y0 + scales.ys * y
    loaded = replace(experiment.plain, load=replace(experiment.plain.load, onset=0.5 * v.size, size=0.01))
    gain = float(clean_output(experiment, loaded)[-1] - y[-1]) / 0.01
    rows = [
        row
        for row in limits["limits"]
        if (row["name"], row["parameter"]) in _PLANTED
        and row["named"] is not None
        and supports_effect(experiment.plain, row["name"])
    ]
    for i in rng.permutation(len(rows))[:EFFECTS_A_RIG]:
        row = rows[i]
        row["at"] |= {"middle": float(u.mean())}
        if row["parameter"] in ("high", "low"):
            signal = u if row["signal"] == "u" else readings
            row["end"] = float(signal.max() if row["parameter"] == "high" else signal.min())
        for times, factor in SIZES.items():
            share = factor * row["share"]["named"]
            value = size_at(row, share)
            setup = planted_setup(experiment.plain, scales, row, value, gain)
            again = replace(experiment, setup=setup, noise=replace(experiment.noise, seed=int(rng.integers(2**31))))
            planted = Planting(f"{name}-{i}-{times}", row["name"], row["parameter"], times, share, value, row["at"])
            write_record(folder / f"{planted.name}.csv", to_record(run_experiment(again), scales, planted.name))
            made.append(planted)
    return made


def judge(plantings: Sequence[Planting], results: dict[str, dict[str, Any]]) -> dict[str, tuple[int, int]]:
    """How many planted effects are named, by size, and how many sizes a report without effects excludes wrongly.

    Parameters
    ----------
    plantings : sequence of Planting
    results : dict
        Reports by name of the record.
    """
    counts = dict.fromkeys((*SIZES, "wrong", "excluded"), (0, 0))

    def count(what: str, right: bool) -> None:
        hits, of = counts[what]
        counts[what] = (hits + right, of + 1)

    for planting in plantings:
        result = results.get(planting.name)
        if result is None or result["verdict"] == "error":
            count(planting.times, False)
            continue
        probable = {effect["name"] for effect in result["effects"] if effect["probability"] >= MIN_PROBABILITY}
        count(planting.times, planting.effect in probable)
        count("wrong", bool(probable - {planting.effect}))
        stated = excluded_above(planting, result)
        if stated is not None:
            count("excluded", is_larger(planting.parameter, planting.value, stated))
    return counts


def excluded_above(planting: Planting, result: dict[str, Any]) -> float | None:
    """The size of the planted effect that a report of no gap excludes; None without one."""
    for row in result["limits"] if result["verdict"] == "none" else ():
        same = (row["name"], row["parameter"]) == (planting.effect, planting.parameter)
        if same and row["excluded_above"] is not None and is_same_place(planting.at, row["at"]):
            return float(row["excluded_above"])
    return None


def is_same_place(planted: dict[str, float], stated: dict[str, float]) -> bool:
    """Whether a limit is about the effect that was planted, and not about a wave of another frequency, for example."""
    shared = {name for name in PLACES if name in planted and name in stated}
    return all(np.isclose(planted[name], stated[name], rtol=SAME_PLACE) for name in shared)


def is_larger(parameter: str, value: float, other: float) -> bool:
    """Whether an effect with one value of its parameter is larger than with another one."""
    return value < other if parameter in ("high", "rate") else value > other


def plant_and_diagnose(rigs: int, seed: int, jobs: int) -> tuple[list[Planting], dict[str, dict[str, Any]]]:
    """Draw rigs, ask for their limits, plant effects, and diagnose the records.

    Parameters
    ----------
    rigs : int
        Number of rigs; a few have a gap without an effect by chance, and get none.
    seed : int
    jobs : int
        Number of parallel processes.

    Returns
    -------
    list of Planting
    dict
        Reports by name of the record.
    """
    with TemporaryDirectory(prefix="labsid-blind-") as scratch:
        drawn, planted = Path(scratch, "rigs"), Path(scratch, "planted")
        drawn.mkdir()
        planted.mkdir()
        rng = np.random.default_rng(seed)
        experiments = {f"r{number:03d}": draw_rig(rng) for number in range(rigs)}
        for name, experiment in experiments.items():
            write_record(drawn / f"{name}.csv", to_record(run_experiment(experiment), experiment.scales, name))
        plantings: list[Planting] = []
        for (name, experiment), stated in zip(experiments.items(), limits_of(drawn, list(experiments)), strict=True):
            if stated["verdict"] == "none":
                plantings += plant(planted, rng, experiment, name, stated)
        results, _ = run_folder(planted, jobs, count=len(plantings))
    return plantings, results


def limit_metrics(per_row: int, seed: int, jobs: int) -> list[Metric]:
    """Metrics of the row.

    Parameters
    ----------
    per_row : int
        Planted effects of each of the `SIZES`, rounded up to whole rigs.
    seed : int
    jobs : int
    """
    counts = judge(*plant_and_diagnose(-(-per_row // EFFECTS_A_RIG), seed, jobs))
    named, half, wrong, excluded = ([True] * hits + [False] * (of - hits) for hits, of in counts.values())
    return [
        rate("limits: planted at the size `named`: named", named, (0.85, 0.95), (0.88, 0.92)),
        rate("limits: planted at half of it: named", half, 0.15, 0.15, below=True),
        rate("limits: planted, and another effect named", wrong),
        rate("limits: larger than what a report without effects excludes", excluded, 0.05, 0.05, below=True),
    ]


def main() -> None:
    """Draw, plant, diagnose, and print the counts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rigs", type=int, default=8)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--jobs", type=int, default=1)
    asked = parser.parse_args()
    plantings, results = plant_and_diagnose(asked.rigs, asked.seed, asked.jobs)
    for planting in plantings:
        result = results.get(planting.name, {"verdict": "missing", "effects": []})
        said = ", ".join(f"{effect['name']} {effect['probability']:.2f}" for effect in result["effects"])
        limits = f"{planting.value:10.4g} (excluded: {excluded_above(planting, result) or '-'})"
        which = f"{planting.effect:<22}{planting.parameter:<10}{planting.times:<7}{planting.share:8.4f}"
        print(f"{which}{limits}  {result['verdict']}: {said}")
    for what, (hits, of) in judge(plantings, results).items():
        low, high = wilson(hits, of) if of else (0.0, 1.0)
        print(f"{what:<10}{hits:4d} of {of:<4d} {100.0 * low:5.1f} to {100.0 * high:5.1f} %")


if __name__ == "__main__":
    main()
