"""The slider: nothing is seen before a prediction, and then the verdict comes at the position that was asked for."""

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import ipywidgets
import nbformat
import pytest
from course_work import ROOT
from nbconvert import HTMLExporter

from labsid.hand_in.kernel import NotebookKernel
from labsid.predictions.display import has_widget, prediction_data
from labsid.predictions.places import PREDICTIONS, find_prediction
from labsid.predictions.prediction import Sources
from labsid.predictions.widgets import prediction_widget

RECORD = "SysIdenData_StudentVersion.mat"


@pytest.fixture
def box(sources: Callable[[str | None], Sources]) -> ipywidgets.VBox:
    prediction = find_prediction("row-of-phi")
    return prediction_widget(prediction, prediction.prepare(sources(None)))


def kinds(box: ipywidgets.VBox) -> list[str]:
    return [type(child).__name__ for child in box.children]


def test_the_slider_appears_when_a_prediction_is_committed(box: ipywidgets.VBox) -> None:
    assert kinds(box) == ["HTML", "RadioButtons", "Button"]
    _, choice, commit = box.children
    assert choice.value is None
    assert commit.disabled
    choice.value = 0
    assert not commit.disabled
    assert kinds(box) == ["HTML", "RadioButtons", "Button"]
    commit.click()
    assert kinds(box) == ["HTML", "RadioButtons", "HTML", "SelectionSlider", "HTML"]
    assert choice.disabled
    assert "Move the slider to +1." in box.children[2].value
    assert "data:image/png;base64," in box.children[4].value


def test_the_figure_moves_and_the_verdict_comes_once(box: ipywidgets.VBox) -> None:
    _, choice, commit = box.children
    choice.value = 0
    commit.click()
    slider, figure = box.children[3:5]
    first = figure.value
    slider.value = 0
    assert figure.value != first
    assert len(box.children) == 5
    slider.value = 2
    assert kinds(box)[5:] == ["HTML", "Textarea", "HTML"]
    assert "Your prediction did not hold. What happens: &quot;Much worse" in box.children[5].value
    assert "not marked and not saved" in box.children[5].value
    assert box.children[7].value.startswith("<details")
    assert "its own past outputs alone" in box.children[7].value
    slider.value = 1
    assert figure.value == first
    slider.value = 2
    assert len(box.children) == 8


def test_a_prediction_that_held_is_said_so(box: ipywidgets.VBox) -> None:
    _, choice, commit = box.children
    choice.value = 2
    commit.click()
    box.children[3].value = 2
    assert "Your prediction held." in box.children[5].value


@pytest.mark.parametrize("prediction_id", PREDICTIONS)
def test_a_notebook_gets_every_form_at_once(prediction_id: str, sources: Callable[[str | None], Sources]) -> None:
    data = prediction_data(prediction_id, sources(None))
    assert has_widget(data)
    assert set(data) == {"text/plain", "text/html", "application/vnd.jupyter.widget-view+json"}


@pytest.mark.parametrize("prediction_id", PREDICTIONS)
def test_each_slider_moves_its_figure_and_the_verdict_comes_where_it_is_asked(
    prediction_id: str, sources: Callable[[str | None], Sources]
) -> None:
    prediction = find_prediction(prediction_id)
    moved = prediction_widget(prediction, prediction.prepare(sources(None)))
    _, choice, commit = moved.children
    choice.value = len(prediction.options) - 1
    commit.click()
    slider, figure = moved.children[3:5]
    seen = set()
    others = [position for position in range(len(prediction.positions)) if position != prediction.asked]
    for position in (*others, prediction.asked):
        assert len(moved.children) == 5
        slider.value = position
        seen.add(figure.value)
    assert len(seen) == len(prediction.positions)
    assert "Your prediction " in moved.children[5].value


@pytest.mark.parametrize("prediction_id", PREDICTIONS)
def test_a_saved_notebook_without_the_state_of_its_widgets_shows_the_still_picture(
    prediction_id: str, sources: Callable[[str | None], Sources]
) -> None:
    output = nbformat.v4.new_output("display_data", data=prediction_data(prediction_id, sources(None)))
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell("", outputs=[output])])
    page, _ = HTMLExporter().from_notebook_node(notebook)
    assert '<summary style="display:list-item;cursor:pointer">Choose one first, then open this.</summary>' in page
    assert "widget-view" not in page


@pytest.mark.slow
def test_in_a_clean_run_it_is_harmless(tmp_path: Path) -> None:
    """As `labsid submit` runs a notebook: under the rules of grading, with no program that could show a widget."""
    shutil.copyfile(ROOT / "data" / RECORD, tmp_path / RECORD)
    setup = "import matplotlib.pyplot as plt\nfrom labsid.checks import notebook_checks\n"
    with NotebookKernel(tmp_path, as_graded=True) as kernel:
        assert kernel.run(f"{setup}check = notebook_checks('lab-identification', globals())", "a", 60).error == ""
        before = kernel.run("print(sorted(globals()))", None, 20).printed
        done = kernel.run("check.predict('row-of-phi')", "b", 60)
        assert (done.error, done.outcomes) == ("", ())
        assert "Predict, then see (unmarked): Suppose the rows" in done.printed
        assert kernel.run("check.predict('order')", "c", 60).error == ""
        after = kernel.run("print(sorted(globals()))", None, 20).printed
        assert [name for name in eval(after) if not name.startswith("_")] == [
            name for name in eval(before) if not name.startswith("_")
        ]
    assert sorted(os.listdir(tmp_path)) == [RECORD]
