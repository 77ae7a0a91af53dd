"""What a cell with a prediction shows: a slider where widgets run, else a still picture, and text without Jupyter."""

from importlib.util import find_spec
from typing import Any

from labsid.predictions.places import find_prediction
from labsid.predictions.prediction import Sources
from labsid.predictions.still import prediction_text, still_html

_WIDGET = "application/vnd.jupyter.widget-view+json"
RUN_AGAIN = "Predict, then see: if no choice appears below, run this cell."
"""Shown above a slider, as a notebook that is opened again has none until its cell is run."""


def prediction_data(prediction_id: str, sources: Sources) -> dict[str, Any]:
    """A prediction in every form that a notebook's program may show, by MIME type.

    Parameters
    ----------
    prediction_id : str
    sources : Sources
        The notebook's data.

    Returns
    -------
    dict
        A program shows the widget if it can, else the still picture, else the text.

    Raises
    ------
    ValueError
        If there is no such prediction.
    """
    prediction = find_prediction(prediction_id)
    text = prediction_text(prediction)
    try:
        experiment = prediction.prepare(sources)
        still = still_html(prediction, experiment)
    except (ValueError, ArithmeticError, LookupError) as error:  # a record that is too short, or variables that changed
        return {"text/plain": f"{text}\nIt cannot be shown here: {error}."}
    data: dict[str, Any] = {"text/plain": text, "text/html": still}
    if find_spec("ipywidgets") is not None:
        from labsid.predictions.widgets import prediction_widget

        bundle = prediction_widget(prediction, experiment)._repr_mimebundle_() or {}
        data |= {kind: content for kind, content in bundle.items() if kind == _WIDGET}
    return data


def has_widget(data: dict[str, Any]) -> bool:
    """Whether a widget is among the forms of a prediction."""
    return _WIDGET in data


def text_of(prediction_id: str) -> str:
    """A prediction as text, for Python without Jupyter."""
    return prediction_text(find_prediction(prediction_id))
