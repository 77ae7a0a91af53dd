"""Read the input of an experiment that is not made yet."""

from os import PathLike

import numpy as np

from labsid._arrays import FloatArray
from labsid.records.formats import RawRecord, read_raw
from labsid.records.reading import Reading
from labsid.records.record import find_faults, refusal, sampling_time


def load_planned_input(path: str | PathLike[str]) -> tuple[FloatArray, float]:
    """Read delimited text with the columns ``t,u``; others, such as an output, are ignored.

    Parameters
    ----------
    path : path

    Returns
    -------
    u : ndarray, shape (N,)
    Ts : float
        Sampling time in seconds.

    Raises
    ------
    OSError
        If the file cannot be opened.
    ValueError
        If it has no such columns, or its times are not even.
    """
    two = read_raw(path, Reading(columns="t,u", Ts=1.0))  # read as two signals; the first ones are the times
    faults = find_faults(RawRecord(t=two.u, u=two.y, y=np.arange(two.y.size, dtype=float), name=two.name))
    if faults:
        raise ValueError(refusal(path, faults))
    return two.y, sampling_time(two.u)
