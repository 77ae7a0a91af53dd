"""A prediction as text, and as a still picture that is folded away until the student has chosen."""

from base64 import b64encode
from html import escape

from labsid.plots.predictions import View, view_png
from labsid.predictions.prediction import Experiment, Prediction

_STYLE = "max-width:760px;border-left:4px solid #0072B2;padding:.2em 0 .2em .9em;margin:.4em 0"
_OPENS = "display:list-item;cursor:pointer"  # the classic notebook would hide the triangle


def prediction_text(prediction: Prediction) -> str:
    """The question and its options."""
    options = "\n".join(f"  {letter}. {option}" for letter, option in zip("abcdef", prediction.options, strict=False))
    return f"Predict, then see (unmarked): {prediction.question}\n{options}"


def question_html(prediction: Prediction) -> str:
    """The question."""
    return f'<div style="{_STYLE}"><b>Predict, then see</b> (unmarked)<br>{escape(prediction.question)}</div>'


def still_html(prediction: Prediction, experiment: Experiment) -> str:
    """The question and its options; the picture at the position asked for, and what holds, are folded away."""
    outcome = experiment.outcome()
    options = "".join(f"<li>{escape(option)}</li>" for option in prediction.options)
    seen = view_html(experiment.view(prediction.asked))
    holds = f"<p><b>{escape(prediction.options[outcome.holds])}</b> {escape(outcome.said)}</p>"
    folded = f'<details><summary style="{_OPENS}">Choose one first, then open this.</summary>{seen}{holds}</details>'
    return f'{question_html(prediction)}<ol type="a">{options}</ol>{folded}'


def view_html(view: View) -> str:
    """A view as an image with its numbers below."""
    data = b64encode(view_png(view)).decode("ascii")
    alt = f"{view.title}. {view.said}"
    return (
        f'<img alt="{escape(alt, quote=True)}" src="data:image/png;base64,{data}" '
        f'style="width:100%;max-width:760px"><p>{escape(view.said)}</p>'
    )
