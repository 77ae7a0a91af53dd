"""Predictions: exactly one option holds on each student's record, for the reason that is given."""

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from labsid.lab.arx import fit_arx
from labsid.lab.identification import identify
from labsid.plots.predictions import Curve, View, plot_view, view_png
from labsid.predictions.display import has_widget, prediction_data
from labsid.predictions.lab_data import LabData, fit, read_lab_data, simulate
from labsid.predictions.places import PREDICTIONS, find_prediction
from labsid.predictions.prediction import Outcome, Sources, verdict_text
from labsid.predictions.still import prediction_text, still_html

EXPECTED = {
    "row-of-phi": "Much worse",
    "sign-of-a": "It grows without end, with another sign",
    "offset-left-in": "Its slow pole moves toward 1",
    "initial-state": "As long as the start from rest",
    "pole-moved": "It gets about three times slower",
    "order": "It falls by less",
    "forgetting-factor": "About 3 times",
}
STUDENTS = (None, "ada", "ben", "cleo", "dan", "eve")

Made = Callable[[str | None], Sources]


def test_there_are_seven() -> None:
    assert set(PREDICTIONS) == set(EXPECTED)
    with pytest.raises(ValueError, match="there is no prediction 'x'; there are row-of-phi, "):
        find_prediction("x")


@pytest.mark.parametrize("student", STUDENTS)
@pytest.mark.parametrize("prediction_id", EXPECTED)
def test_the_same_option_holds_on_every_record(prediction_id: str, student: str | None, sources: Made) -> None:
    prediction = find_prediction(prediction_id)
    outcome = prediction.prepare(sources(student)).outcome()
    assert prediction.options[outcome.holds].startswith(EXPECTED[prediction_id])


@pytest.mark.parametrize("prediction_id", EXPECTED)
def test_every_position_can_be_drawn_in_the_same_limits(prediction_id: str, sources: Made) -> None:
    prediction = find_prediction(prediction_id)
    experiment = prediction.prepare(sources(None))
    views = [experiment.view(position) for position in range(len(prediction.positions))]
    assert len({view.ylim for view in views}) == 1
    assert len({view.said for view in views}) == len(views)
    assert len({view.title for view in views} | {view.curves[-1].y.tobytes() for view in views}) >= len(views)
    for view in views:
        assert view.curves[-1].role == "moved"
        assert all(np.isfinite(curve.y).all() for curve in view.curves)
    assert prediction.start != prediction.asked


def test_the_fit_and_the_simulation_are_those_of_the_lab(sources: Made) -> None:
    data = read_lab_data(sources(None))
    theta, error = fit(data.u[: data.half], data.y[: data.half], 2)
    half = fit_arx(data.u[: data.half], data.y[: data.half], data.Ts, order=2, start=7)
    assert theta == pytest.approx(half.fit.theta, rel=1e-9)
    assert error == pytest.approx(2 * half.fit.loss / (data.half - 7), rel=1e-9)
    record = sources(None).record
    assert record is not None
    whole = identify(record).verification.mse_all
    assert np.mean((data.y - simulate(theta, data.u)) ** 2) == pytest.approx(whole, rel=0.02)


# ---- the reasons, each with numbers of its own


def test_a_row_that_contains_the_output_itself_fits_perfectly_and_simulates_nothing(sources: Made) -> None:
    data = read_lab_data(sources(None))
    theta, error = fit(data.u[: data.half], data.y[: data.half], 2, shift=-1)
    assert theta == pytest.approx([1, 0, 0, 0], abs=1e-9)
    assert error < 1e-20
    assert np.abs(simulate(theta, data.u)).max() < 1e-6


def test_the_poles_of_the_wrong_signs() -> None:
    """By hand: theta = [1.3, -0.4] has the poles 0.8 and 0.5; with both signs wrong z^2 + 1.3 z - 0.4 has -1.556."""
    one = np.roots([1, -1.3, 0.4])
    other = np.roots([1, 1.3, -0.4])
    assert sorted(one) == pytest.approx([0.5, 0.8])
    assert min(other) == pytest.approx(-(1.3 + np.sqrt(1.69 + 1.6)) / 2)


def test_equal_and_opposite_starts_settle_at_the_same_time(sources: Made) -> None:
    experiment = find_prediction("initial-state").prepare(sources("ada"))
    said = experiment.outcome().said
    seconds = re.findall(r"matters for ([\d.]+) s|state for ([\d.]+) s", said)
    assert seconds[0][0] == seconds[1][1]
    right = experiment.view(2).curves
    assert right[-1].y == pytest.approx(right[1].y)


def test_a_pole_at_a_third_of_its_distance_is_three_times_as_slow(sources: Made) -> None:
    said = find_prediction("pole-moved").prepare(sources(None)).outcome().said
    before, after = map(float, re.search(r"time constant from ([\d.]+) s to ([\d.]+) s", said).groups())  # type: ignore[union-attr]
    assert after / before == pytest.approx(3, rel=0.03)


def test_the_error_of_the_fit_falls_with_the_order(sources: Made) -> None:
    experiment = find_prediction("order").prepare(sources(None))
    errors = [float(re.search(r"fit ([\d.]+) V", experiment.view(k).said)[1]) for k in range(6)]  # type: ignore[index]
    assert errors == sorted(errors, reverse=True)


def test_the_deviation_grows_as_the_root_of_the_memory(sources: Made) -> None:
    experiment = find_prediction("forgetting-factor").prepare(sources(None))
    ratio = float(re.search(r"([\d.]+) times\. The memory", experiment.outcome().said)[1])  # type: ignore[index]
    theory = np.sqrt((0.1 / 1.9) / (0.01 / 1.99))
    assert ratio == pytest.approx(theory, rel=0.35)


def exact(sources: Made, theta: list[float], offset: float) -> Sources:
    """The input of the course's record with the output of a model, without noise."""
    record = sources(None).record
    assert record is not None
    return Sources(replace(record, y=offset + simulate(np.array(theta), record.u - record.u[0])))


def test_on_other_data_another_option_holds(sources: Made) -> None:
    fast = exact(sources, [0.5, -0.06, 0.3, 0.1], 2.0)  # poles 0.3 and 0.2; with wrong signs -0.6 and 0.1
    assert find_prediction("sign-of-a").prepare(fast).outcome().holds == 1
    assert find_prediction("offset-left-in").prepare(exact(sources, [1.3, -0.4, 0.1, 0.1], 0.0)).outcome().holds == 0
    third = exact(sources, [0, 0, -0.9, 0.1, 0, 0], 2.0)  # y(k) follows from y(k-3), which order 3 alone has
    assert find_prediction("order").prepare(third).outcome().holds == 0


# ---- what is said and shown


def test_a_verdict_says_whether_the_prediction_held() -> None:
    prediction = find_prediction("order")
    outcome = Outcome(1, "Because.")
    assert verdict_text(prediction, 1, outcome) == "Your prediction held."
    said = 'Your prediction did not hold. What happens: "It falls by less."'
    assert verdict_text(prediction, 2, outcome) == said


def test_a_size_of_the_output_is_readable() -> None:
    t = np.arange(3.0)
    volts, speed = LabData(1.0, t, t, t, 0.0), LabData(1.0, t, t, 120 * t, 0.0, "rpm")
    assert [volts.say(value) for value in (0.00412, 1.4, 1e30)] == ["0.0041 V", "1.4 V", "more than 1000 V"]
    assert (speed.say(4000.0), speed.say(1e30), speed.ylabel) == ("4e+03 rpm", "more than 100000 rpm", "Output y (rpm)")


def test_a_view_is_drawn_with_a_legend_and_its_limits() -> None:
    x = np.arange(5.0)
    view = View("Title", (Curve("measured", "Record", x, x), Curve("moved", "Model", x, 2 * x)), (0.0, 4.0), "said")
    ax = plot_view(view)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["Record", "Model"]
    assert ax.get_ylim() == (0.0, 4.0)
    ax.figure.draw_without_rendering()
    assert ax.get_legend().get_window_extent().y0 >= ax.bbox.y1  # a curve may run through every part of the axes
    assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_title()) == ("Time (s)", "Output y (V)", "Title")
    assert view_png(view).startswith(b"\x89PNG")


def test_the_still_picture_is_folded_away(sources: Made) -> None:
    prediction = find_prediction("row-of-phi")
    html = still_html(prediction, prediction.prepare(sources(None)))
    before, folded = html.split("<details>")
    assert "y(k−1)" in before
    assert "<img" not in before
    assert "data:image/png;base64," in folded
    assert 'alt="Rows of Φ 1 sample too late.' in folded
    assert "Much worse" in before
    assert "Much worse" in folded
    assert prediction_text(prediction).splitlines()[1] == "  a. About as well as before."


@pytest.mark.parametrize(
    ("prediction_id", "sources_given", "said"),
    [
        ("row-of-phi", Sources(None), "this notebook has no record"),
        ("forgetting-factor", Sources(None), "run the cell of step 4 that makes it"),
        ("forgetting-factor", Sources(None, {"u_61": [1], "y_61": [1], "theta_true": [1]}), "has been changed"),
        ("forgetting-factor", Sources(None, {"u_61": "x", "y_61": 1, "theta_true": None}), "is not there"),
    ],
)
def test_without_data_the_question_is_asked_all_the_same(prediction_id: str, sources_given: Sources, said: str) -> None:
    data = prediction_data(prediction_id, sources_given)
    assert list(data) == ["text/plain"]
    assert data["text/plain"].startswith("Predict, then see (unmarked): ")
    assert said in data["text/plain"].splitlines()[-1]


def test_without_ipywidgets_there_is_a_still_picture(sources: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("labsid.predictions.display.find_spec", lambda name: None)
    data = prediction_data("order", sources(None))
    assert set(data) == {"text/plain", "text/html"}
    assert not has_widget(data)
