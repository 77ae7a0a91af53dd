"""File formats of records: read the columns of a file without validating them (see `record`)."""

from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import numpy as np

from labsid._arrays import FloatArray, freeze
from labsid.records.mat_file import is_mat_file, read_mat
from labsid.records.text_file import read_text

OUTPUTS = ("noise-reduced", "measured")
_SIGNALS = ("t", "u", "y", "y_measured", "y_noise_reduced", "reference")


@dataclass(frozen=True, slots=True, eq=False)
class RawRecord:
    """The columns of a file, not validated: lengths may differ, values may be NaN, times may be out of order.

    Attributes
    ----------
    t : ndarray, shape (Nt,), or None
        Times in seconds; None if the file has none.
    u, y : ndarray, shapes (Nu,) and (Ny,)
        Input and the requested output.
    Ts : float or None
        Sampling time in seconds, as given by the caller.
    y_measured, y_noise_reduced, reference : ndarray or None
        The other columns of a lab record.
    name : str
        File name without folder and suffix.
    notes : tuple of str
        Assumptions made in reading the file.
    """

    t: FloatArray | None
    u: FloatArray
    y: FloatArray
    Ts: float | None = None
    y_measured: FloatArray | None = None
    y_noise_reduced: FloatArray | None = None
    reference: FloatArray | None = None
    name: str = ""
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        freeze(self, **self._present())

    @property
    def columns(self) -> dict[str, FloatArray]:
        """The available columns by name, without the output that equals `y`."""
        present = self._present()
        for name in ("y_measured", "y_noise_reduced"):
            if name in present and np.array_equal(present[name], self.y, equal_nan=True):
                del present[name]
                break
        return present

    def _present(self) -> dict[str, FloatArray]:
        return {name: getattr(self, name) for name in _SIGNALS if getattr(self, name) is not None}


def read_raw(
    path: str | PathLike[str],
    *,
    output: str = "noise-reduced",
    columns: str | None = None,
    Ts: float | None = None,
) -> RawRecord:
    """Read the columns of a record file without validating them.

    Parameters
    ----------
    path : path
        ``.mat`` (version 5 or 7; recognized by its suffix or first bytes), or text: columns separated by
        semicolons, tabs, commas or blanks. Lines that start with # or % are ignored.
    output : {"noise-reduced", "measured"}
        Column 2 or column 1 of ``LogData.signals(1).values``.
    columns : str, optional
        Three columns for t,u,y or two for u,y: names from the header, or numbers from 1. For a text file without
        a header, ``t,u,y`` or ``u,y`` names the columns in order. For a ``.mat``: names of variables.
    Ts : float, optional
        Sampling time in seconds of a file without time.

    Returns
    -------
    RawRecord

    Raises
    ------
    OSError
        If the file cannot be opened.
    ValueError
        If the file does not contain these columns, or is damaged.
    """
    if output not in OUTPUTS:
        raise ValueError(f"output must be {' or '.join(OUTPUTS)}; got {output!r}.")
    if Ts is not None and not 0 < Ts < np.inf:
        raise ValueError(f"Ts must be a positive number of seconds; got {Ts:g}.")
    path = Path(path)
    content = path.read_bytes()
    if not content.strip():
        raise ValueError(f"{path.name} is empty: a record needs at least two samples of u and y.")
    try:
        if path.suffix.lower() == ".mat" or is_mat_file(content):
            found = read_mat(content, output, columns)
        elif output == "measured":
            raise ValueError(
                "output measured chooses between the two outputs of LogData; a text file has one y. "
                "Choose its column with columns (--columns)."
            )
        else:
            found = read_text(content, columns, Ts)
    except ValueError as error:
        raise ValueError(f"{path.name}: {error}") from None
    notes = tuple(found.pop("notes"))
    return RawRecord(**found, Ts=Ts, name=path.stem, notes=notes)
