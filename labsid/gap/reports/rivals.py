"""Responses of two explanations to the proposed input, from the fits that the report holds."""

from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.effects.families import EFFECTS_BY_KEY
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.reports.sentences import distinguishing_effects


def rival_responses(report: dict[str, Any]) -> dict[str, FloatArray]:
    """Output of each of the two explanations for the proposed input, in the units of the record, by its title.

    Parameters
    ----------
    report : dict
        Without a proposed input, or without the fits that a page can simulate, the result is empty.
    """
    planned, replay = report["next_experiment"], report.get("replay")
    if planned is None or replay is None:
        return {}
    u = (np.array(planned["u"], float) - replay["u_scale"]["centre"]) / replay["u_scale"]["unit"]
    found = {}
    titles = distinguishing_effects(planned["separates"])
    for title, name in zip(titles, planned["separates"], strict=True):
        names = sorted(name.split("+"))
        one = next((one for one in replay["combinations"] if sorted(one["names"]) == names and one["simulated"]), None)
        if one is None or one["constant"] is not None:
            return {}
        hypothesis = Hypothesis(tuple(EFFECTS_BY_KEY[key] for key in one["effects"]))
        theta, gains = (np.array(one[key], float) for key in ("theta", "gains"))
        output = hypothesis.output(theta, gains, u, one["span"], one["reference"])
        found[title] = replay["y_scale"]["centre"] + replay["y_scale"]["unit"] * output
    return found if all(np.isfinite(y).all() for y in found.values()) else {}
