"""The record at a glance: what the findings of the check say is marked where they say it, and nothing else."""

import numpy as np
import pytest

from labsid.lab.record_check import check_record
from labsid.plots.record_check import figure_check
from labsid.records.formats import RawRecord

N, TS = 900, 0.5


def record(change=lambda u, y: None, t=None) -> RawRecord:
    rng = np.random.default_rng(2)
    u = np.repeat(rng.choice([0.0, 1.0, 2.0, 3.0], N // 30), 30)
    u[:60] = 1.0
    y = np.zeros(N)
    for k in range(1, N):
        y[k] = 0.95 * y[k - 1] + 0.05 * (u[k - 1] - 1.0)
    y += 0.01 * rng.standard_normal(N)
    change(u, y)
    return RawRecord(TS * np.arange(N) if t is None else t, u, y)


def lanes(raw: RawRecord) -> dict[str, list[tuple[float, float]]]:
    """Ends of the bars of each lane of the figure."""
    ax = figure_check(raw, check_record(raw)).axes[-1]
    names = [label.get_text() for label in ax.get_yticklabels()]
    drawn = [[(p.vertices[:, 0].min(), p.vertices[:, 0].max()) for p in one.get_paths()] for one in ax.collections]
    return dict(zip(names, drawn, strict=True))


def test_a_sound_record_has_its_rest_and_nothing_else():
    assert list(lanes(record())) == ["at rest"]
    ((start, stop),) = lanes(record())["at rest"]
    assert (start, stop) == pytest.approx((0.0, 59 * TS))


def clip(u, y):
    np.clip(y, -0.5, 0.6, out=y)


def hold(u, y):
    y[200:212] = y[199]
    y[500:512] = y[499]


def spike(u, y):
    y[[305, 640]] += 0.9


def lose(u, y):
    y[350:360] = np.nan


def lose_long(u, y):
    y[560:] += y[399] - y[560]  # the line across the gap is level
    y[400:560] = np.nan


def stop_moving(u, y):
    y[400:560] = y[399] + 0.01 * np.random.default_rng(3).standard_normal(160)


@pytest.mark.parametrize(
    ("change", "name", "at"),
    [
        (hold, "held values", [(199, 211), (499, 511)]),
        (spike, "spikes", [(305, 305), (640, 640)]),
        (lose, "missing", [(350, 359)]),
        (lose_long, "missing", [(400, 559)]),
        (stop_moving, "flat while u moves", [(400, 559)]),
    ],
)
def test_a_fault_has_a_lane_at_its_samples(change, name, at):
    found = lanes(record(change))
    assert set(found) == {"at rest", name}
    middles = [0.5 * (low + high) / TS for low, high in found[name]]
    assert middles == pytest.approx([0.5 * (low + high) for low, high in at], abs=12)


def test_both_ends_of_a_clipped_output_are_told_apart():
    raw = record(clip)
    found = lanes(raw)
    assert set(found) == {"at rest", "clipped at its lowest", "clipped at its highest"}
    for name, extreme in (("lowest", -0.5), ("highest", 0.6)):
        inside = np.zeros(N, bool)
        for low, high in found[f"clipped at its {name}"]:
            inside |= (raw.t >= low - 1e-9) & (raw.t <= high + 1e-9)
        assert inside[raw.y == extreme].all()


def test_a_gap_of_the_log_is_marked_in_all_signals():
    t = TS * np.arange(N)
    t[450:] += 20.0
    raw = record(t=t)
    ((low, high),) = lanes(raw)["gaps of the log"]
    assert (low, high) == pytest.approx((t[449], t[450]))
    output, command, _ = figure_check(raw, check_record(raw)).axes
    assert len(output.patches) == len(command.patches) + 1 == 2  # the rest is that of the output


def test_pulses_of_the_input_and_an_oscillation_are_no_spikes():
    def pulses(u, y):
        u[[305, 640]] += 9.0
        y[[305, 640]] += 9.0

    def oscillate(u, y):
        y += 0.9 * (-1.0) ** np.arange(N)

    for change in (pulses, oscillate):
        assert "spikes" not in {finding.topic for finding in check_record(record(change)).findings}


def test_a_record_that_is_refused_is_drawn_over_its_samples(covered):
    t = TS * np.arange(N)
    t[300] = t[299]
    raw = record(t=t)
    figure = figure_check(raw, check_record(raw))
    assert figure.axes[-1].get_xlabel() == "Sample"
    assert figure.axes[0].get_title(loc="left").startswith("usable for the lab: no")
    assert covered(figure) == []


def test_several_signals_have_a_panel_each_and_lanes_with_their_names():
    one = record(clip)
    two = RawRecord(
        one.t,
        np.column_stack([one.u, one.u[::-1]]),
        np.column_stack([one.y, record().y]),
        inputs=("Q1", "Q2"),
        outputs=("T1", "T2"),
        units=("", "", "C", "C"),
    )
    figure = figure_check(two, check_record(two))
    assert [ax.get_ylabel() for ax in figure.axes[:-1]] == ["T1 (C)", "T2 (C)", "Q1", "Q2"]
    names = [label.get_text() for label in figure.axes[-1].get_yticklabels()]
    assert sum(name.startswith("T1: clipped") for name in names) == 2
    assert not any(name.startswith("T2: clipped") for name in names)
    assert "T1: clipped" in figure.alt
