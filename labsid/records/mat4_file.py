"""MATLAB files of version 4, with scipy."""

from pathlib import Path

import numpy as np

from labsid.records.column import Log, is_numeric
from labsid.records.matlab_values import log_of_variables


def open_log(path: Path) -> Log:
    """Read the matrices of a file.

    Raises
    ------
    ValueError
        If there are no numbers in it.
    """
    from scipy.io import loadmat

    variables = {
        name: value if isinstance(value, np.ndarray) and is_numeric(value) else "no numbers"
        for name, value in loadmat(path).items()
        if not name.startswith("__")
    }
    return log_of_variables(variables, "noise-reduced", False)
