"""The predictions of the course, by their ids."""

from labsid.predictions.lab_places import LAB_PLACES
from labsid.predictions.other_places import OTHER_PLACES
from labsid.predictions.prediction import Prediction

PREDICTIONS = {one.id: one for one in (*LAB_PLACES, *OTHER_PLACES)}


def find_prediction(prediction_id: str) -> Prediction:
    """The prediction of that id; `ValueError` lists the ids if there is none."""
    if prediction_id not in PREDICTIONS:
        raise ValueError(f"there is no prediction {prediction_id!r}; there are {', '.join(PREDICTIONS)}.")
    return PREDICTIONS[prediction_id]
