"""Rigs in MuJoCo, diagnosed with a model of theirs that lacks the effect, and held to a second record."""

from collections.abc import Callable, Iterator

import numpy as np
from bars_grading_figures import Metric, at_most, every
from mujoco_rigs import EFFECTS, NOISE, SAMPLES, TS, angles, load_example, measured, torques

from labsid.gap.diagnosis import diagnose
from labsid.records.record import Record

START = 50  # samples that determine the initial state


def measure(say: Callable[[str], None]) -> Iterator[Metric]:
    """Diagnose a record of each rig; simulate another one of other torques and other noise, at the same instants."""
    model = load_example()
    t = TS * np.arange(SAMPLES)
    named, worst = 0, 0.0
    for what, effect in EFFECTS.items():
        u, other = torques(1), torques(2)
        found = diagnose(Record(t, u, measured(angles(model, u, effect), 5), TS), model.simulate)
        names = [one["name"] for one in found.report["effects"]]
        true = angles(model, other, effect)
        y = measured(true, 6)
        e = y - found.model.simulate(other, y, of_record=True)
        ratio = float(np.sqrt(np.mean(e[START:] ** 2)) / (NOISE * np.std(true)))
        runs = found.report["simulation"]["evaluations"]["runs"]
        chance = found.report["effects"][0]["probability"] if names else 0.0
        say(f"  {what}: {'+'.join(names)} {chance:.2f}, error on a second record {ratio:.3f} of the noise, {runs} runs")
        named, worst = named + (names == [effect.name]), max(worst, ratio)
    yield every("MuJoCo with a model that lacks the effect: named, and nothing else", named, len(EFFECTS))
    yield at_most("the same: largest error on a second record", worst, 1.1, 1.05, "times the noise")
