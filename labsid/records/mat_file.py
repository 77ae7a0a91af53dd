"""MATLAB files of versions 5 and 7."""

from labsid.records.column import Log
from labsid.records.mat5 import read_variables
from labsid.records.matlab_values import holds_objects, log_of_variables


def is_mat5(content: bytes) -> bool:
    """Whether the content begins with the header of a MAT-file of version 5 or 7."""
    return content.startswith(b"MATLAB ")


def open_mat(content: bytes, output: str, by_layout: bool) -> Log | None:
    """Read the variables of a ``.mat`` file.

    Parameters
    ----------
    content : bytes
        The content of the file.
    output : {"noise-reduced", "measured"}
        The output of ``LogData`` to use as `y`.
    by_layout : bool
        Whether ``LogData`` is read by its layout; else all variables are columns by name.

    Returns
    -------
    Log or None
        None if there are objects in the file, which `labsid.records.mat_objects` reads.

    Raises
    ------
    ValueError
        If the file is damaged, or holds no signals.
    """
    try:
        variables = read_variables(content)
    except ValueError as error:
        raise ValueError(
            f"it is no MAT-file of version 5 or 7, or it is cut off or damaged ({error}). Copy or download it "
            "again, or save it again with save('file.mat', 'LogData', '-v7')."
        ) from None
    variables.pop("", None)  # MATLAB's internal data
    if holds_objects(variables) and not (by_layout and "LogData" in variables):
        return None
    return log_of_variables(variables, output, by_layout)
