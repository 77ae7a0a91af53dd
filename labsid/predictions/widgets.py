"""A prediction with a slider, which appears when the student has chosen. Needs ipywidgets."""

from functools import cache
from html import escape
from typing import Any

import ipywidgets

from labsid.predictions.prediction import Experiment, Prediction, verdict_text
from labsid.predictions.still import question_html, view_html

_WIDE = {"description_width": "initial"}
_CSS = (
    "<style>.labsid-prediction .widget-html-content{line-height:1.45}"
    ".labsid-prediction .widget-html-content p{margin:.3em 0}"
    ".labsid-prediction .widget-radio-box,.labsid-prediction .widget-radio-box label"
    "{height:auto;line-height:1.45;white-space:normal;margin-bottom:.2em}</style>"
)
"""Widgets of ipywidgets have lines of a fixed height, in which the lines of a longer text would overlap."""
_TEXT = "max-width:760px"
_WHY = "One sentence: why? (For yourself. It is not marked and not saved, and you may skip it.)"


def prediction_widget(prediction: Prediction, experiment: Experiment) -> Any:
    """The question with its options; then the slider and the figure; then whether the prediction held.

    Parameters
    ----------
    prediction : Prediction
    experiment : Experiment

    Returns
    -------
    ipywidgets.VBox
    """
    options = [(option, index) for index, option in enumerate(prediction.options)]
    choice = ipywidgets.RadioButtons(options=options, value=None, layout={"width": "auto", "max_width": "760px"})
    one_line = {"width": "auto", "align_self": "flex-start"}
    commit = ipywidgets.Button(description="This is my prediction", disabled=True, layout=one_line)
    box = ipywidgets.VBox([ipywidgets.HTML(_CSS + question_html(prediction)), choice, commit])
    box.add_class("labsid-prediction")
    figure = ipywidgets.HTML()
    slider = ipywidgets.SelectionSlider(
        options=[(text, index) for index, text in enumerate(prediction.positions)],
        value=prediction.start,
        description=prediction.slider,
        style=_WIDE,
        layout={"width": "min(100%, 560px)"},
    )

    @cache
    def seen(position: int) -> str:
        return view_html(experiment.view(position))

    def on_choice(_: Any) -> None:
        commit.disabled = choice.value is None

    def on_commit(_: Any) -> None:
        choice.disabled = True
        figure.value = seen(prediction.start)
        asked = escape(f"Move the slider to {prediction.positions[prediction.asked]}.")
        box.children = (*box.children[:2], ipywidgets.HTML(f"<p>{asked}</p>"), slider, figure)

    def on_move(change: Any) -> None:
        figure.value = seen(change["new"])
        if change["new"] == prediction.asked and box.children[-1] is figure:
            outcome = experiment.outcome()
            said = escape(verdict_text(prediction, choice.value, outcome))
            verdict = ipywidgets.HTML(f'<p style="{_TEXT}" role="status"><b>{said}</b></p><p>{escape(_WHY)}</p>')
            why = ipywidgets.Textarea(placeholder="Because ...", layout={"width": "min(100%, 760px)"})
            reason = f'<details style="{_TEXT}"><summary>Compare with ours.</summary>{escape(outcome.said)}</details>'
            box.children = (*box.children, verdict, why, ipywidgets.HTML(reason))

    choice.observe(on_choice, names="value")
    commit.on_click(on_commit)
    slider.observe(on_move, names="value")
    return box
