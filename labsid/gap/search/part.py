"""The beginning of a long record, on which start values are sought: fits to all of it go on from there.

An effect whose time course belongs to the record is sought on all of it, as is every effect of a simulation that is
run, of a slow sensor, of several records, and of an unstable rig.
"""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from labsid.gap.effects.families import names_where
from labsid.gap.fits.fitting import Fit
from labsid.gap.record.data import Data

LONG = 8000  # samples, from which a part is enough; set by hand
SHORTEST = 4000  # samples; set by hand
GROWTH = 1.25  # of the number of samples, until they are enough; numerics
MIN_RANGE = 0.95  # of the range between the quantiles of each signal, that the part must have; set by hand
QUANTILES = 0.005, 0.995  # of a signal: its range without outliers; set by hand
MIN_SPREAD = 0.8  # of the standard deviation, and of that of the changes, that the part must have; set by hand


def beginning(data: Data, parent: Fit, added: Iterable[str]) -> Data:
    """The beginning of a long record that is as informative as the whole; the record itself where there is none.

    Parameters
    ----------
    data : Data
    parent : Fit
        To which effects are added.
    added : iterable of str
        Their names.
    """
    one_record = names_where("of_one_record") | names_where("varies_in_time")
    names = {*parent.hypothesis.names, *added}
    if data.samples < LONG or data.pieces or data.beside or data.at is not None or names & one_record:
        return data
    if parent.hypothesis.plant.kind == "given" or parent.hypothesis.feedback is not None:
        return data
    count = SHORTEST
    while count < data.samples / GROWTH:
        if _is_informative(data, count):
            return replace(data, u=data.u[:count], y=data.y[:count], rows=data.rows[:count])
        count = int(GROWTH * count)
    return data


def on_part(data: Data, part: Data, fit: Fit) -> Fit:
    """A fit to a record, as one to its beginning."""
    return fit if part is data else replace(fit, output=fit.output[: part.samples])


def _is_informative(data: Data, count: int) -> bool:
    """Whether the first samples move as far, as much and as fast as all of them."""
    for signal in (data.u, data.y):
        ranges = [float(np.ptp(np.quantile(one, QUANTILES))) for one in (signal[:count], signal)]
        spreads = [np.array([np.std(one), np.std(np.diff(one))]) for one in (signal[:count], signal)]
        if ranges[0] < MIN_RANGE * ranges[1] or (spreads[0] < MIN_SPREAD * spreads[1]).any():
            return False
    return True
