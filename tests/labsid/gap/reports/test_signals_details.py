"""Residual, poles, limits by output, and responses of pairs, on the page of several signals."""

import numpy as np
import pytest
from page_reader import Page
from signals_reports import signals_report, true_step, undrawn_in_both_widths, with_details

from labsid.gap.reports.signals_details import (
    MOST_OUTPUTS,
    MOST_PAIRS,
    detail_figures,
    detailed_outputs,
    output_details,
    paired_responses,
)
from labsid.gap.reports.signals_page import render_signals
from labsid.gap.reports.signals_text import format_signals, of_output

FOUND = with_details(signals_report(("input-dead-zone", "valve")))
MANY = tuple((f"y{k}", "") for k in range(6))


def test_the_responses_of_all_pairs_are_those_of_the_rig_although_the_inputs_are_alike() -> None:
    pairs = paired_responses(FOUND)
    assert [(pair["names"]["u"], pair["names"]["y"]) for pair in pairs] == [
        ("valve", "level"),
        ("heater", "level"),
        ("valve", "temperature"),
        ("heater", "temperature"),
    ]
    for k, pair in enumerate(pairs):
        step = pair["responses"].step
        true = true_step(k % 2, k // 2, np.round(step.x / 0.5) - 1.0)
        np.testing.assert_allclose(step.measured[-6:], true[-6:], rtol=0.03)
        np.testing.assert_allclose(step.before, 0.8 * step.after, rtol=1e-5)
        slow = pair["responses"].frequency
        assert abs(slow.measured[0]) == pytest.approx(1.0 + k % 2 + 2.0 * (k // 2), rel=0.1)
        assert pair["units"].get("u") == ("V", "%")[k % 2]


@pytest.mark.parametrize("verdict", ["none", "unknown"])
def test_the_text_has_the_limits_of_each_output_where_no_cause_is_known(verdict: str) -> None:
    lines = format_signals(FOUND | {"verdict": verdict, "effects": []}).splitlines()
    assert len([line for line in lines if line.startswith("limits ")]) == 1
    starts = [lines.index(f"{'':11}In {output}:") for output in ("level", "temperature")]
    for start, unit in zip(starts, "V%", strict=True):
        assert lines[start + 2].startswith("effect  ")
        assert f"0.0200 {unit} (0.40 %)" in lines[start + 3]
    assert "limits" not in format_signals(FOUND)


def test_pairs_are_only_those_in_which_the_input_moves_the_output() -> None:
    moving = [one for one in FOUND["couplings"] if (one["from"], one["to"]) != ("heater", "level")]
    assert len(paired_responses(FOUND | {"couplings": moving})) == 3
    assert paired_responses(FOUND | {"couplings": []}) == []
    older = {key: value for key, value in FOUND.items() if key != "input_samples"}
    assert paired_responses(older) == []


def test_an_output_has_its_own_limits_and_the_names_of_its_signals() -> None:
    view = of_output(FOUND, "level")
    assert {row["output"] for row in view["limits"]} == {"level"}
    assert view["names"] == {"u": "valve", "y": "level"}
    first, second = output_details(FOUND)
    assert (first["name"], second["name"]) == ("temperature", "level")  # the larger gap is first
    assert first["residual"]
    assert first["poles"].startswith("The longest time constant of the linear dynamics is 2.24 s")
    assert not first["limits"]["open"]
    cells = [cell for row in second["limits"]["rows"] for cell in row]
    assert any(" V (" in cell for cell in cells)
    assert not any(" u (" in cell or " y (" in cell for cell in cells)


@pytest.mark.parametrize(("verdict", "shown"), [("none", True), ("unknown", True), ("effect", False)])
def test_figures_of_the_limits_stand_where_nothing_is_named(
    verdict: str, shown: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    effects = [("input-dead-zone", "valve")] if verdict == "effect" else []
    if not (drawn := verdict == "none"):
        monkeypatch.setattr("labsid.plots.page_figures.in_both_widths", undrawn_in_both_widths)
    figures = detail_figures(with_details(signals_report(*effects, verdict=verdict), samples=400))
    expected = {f"{what} {i}" for what in ("residual", "poles") for i in (1, 2)} | {"step", "frequency"}
    assert set(figures) == expected | ({"limits 1", "limits 2"} if shown else set())
    pictures = [picture for screens in figures.values() for picture in screens.values()]
    assert not drawn or all(picture.startswith(b"\x89PNG") for picture in pictures)


def test_a_report_of_an_earlier_version_has_texts_and_no_figures(undrawn_signals: None) -> None:
    older = signals_report(("input-dead-zone", "valve"))
    assert detail_figures(older) == {}
    words = Page(render_signals(older)).words
    assert "Residual and dynamics" in words
    assert "What this record could have shown" not in words


def test_of_many_outputs_the_largest_gaps_are_shown(undrawn_signals: None) -> None:
    report = signals_report(("input-dead-zone", "valve"), outputs=MANY)
    assert detailed_outputs(report) == ["y5", "y4", "y3", "y2"]
    assert len(output_details(report)) == MOST_OUTPUTS
    assert f"Of 6 outputs, the {MOST_OUTPUTS} with the largest gap are shown." in Page(render_signals(report)).words
    assert len(paired_responses(with_details(report, samples=400))) <= MOST_PAIRS


def test_the_sections_stand_before_the_next_step() -> None:
    text = render_signals(FOUND)
    page = Page(text)
    titles = ("Residual and dynamics", "What this record could have shown", "Through valve in level", "Next step")
    places = [page.words.index(title) for title in titles]
    assert places == sorted(places)
    assert page.faults == []
    assert len(text) < 1_500_000
