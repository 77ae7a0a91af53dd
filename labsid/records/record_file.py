"""A record as plain text, which says from what and how it was read."""

from itertools import zip_longest

import numpy as np

from labsid import __version__
from labsid.records.record import Record
from labsid.records.several_signals import names_of
from labsid.records.signals import jitter_note


def record_text(record: Record, source: str) -> str:
    """Write a record as text with the columns t,u,y, which any command reads without options.

    Signals that have names keep them; a comment then says the options to type.

    Parameters
    ----------
    record : Record
    source : str
        Name of the log.

    Returns
    -------
    str
        Comments on what was done, a header with the units, and a line for each sample; a missing output is empty.
    """
    name = " ".join(source.split())
    lines = [f"# record of {name}, {len(record)} samples every {record.Ts!r} s, labsid {__version__}"]
    lines += [f"# {' '.join(note.split())}" for note in (*record.notes, *jitter_note(record.jitter, record.Ts))]
    lines += [f"# {note}" for note in names_note(record)]
    names, units = ["t", *record.signal_names], ["s", *record.units] if any(record.units) else []
    columns = [record.t, *record.input_columns.T, *record.output_columns.T]
    if record.reference is not None and record.several:
        names, columns = [*names, "reference"], [*columns, record.reference]
    labelled = zip_longest(names, units, fillvalue="")
    lines.append(",".join(f"{name} [{unit}]" if unit else name for name, unit in labelled))
    for row in np.column_stack(columns).tolist():
        lines.append(",".join("" if value != value else repr(value) for value in row))
    return "\n".join(lines) + "\n"


def names_note(record: Record) -> tuple[str, ...]:
    """The options with which the text of a record is read, if its signals have names of their own."""
    by_default = (*names_of("u", (), len(record.inputs)), *names_of("y", (), len(record.outputs)))
    has_reference = record.reference is not None and record.several  # t,u,y have no place for it
    if record.signal_names == by_default and not has_reference:
        return ()
    options = f"--inputs {','.join(record.inputs)} --outputs {','.join(record.outputs)}"
    return (f"read it with {options}{' --reference reference' if has_reference else ''}",)
