"""A record as plain text, which says from what and how it was read."""

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
    names = record.signal_names
    units = ("s", *record.units) if any(record.units) else ("",) * (1 + len(names))
    lines.append(
        ",".join(f"{name} [{unit}]" if unit else name for name, unit in zip(("t", *names), units, strict=True))
    )
    columns = zip(record.t.tolist(), record.input_columns.tolist(), record.output_columns.tolist(), strict=True)
    for t, u, y in columns:
        lines.append(",".join([repr(t), *map(repr, u), *("" if value != value else repr(value) for value in y)]))
    return "\n".join(lines) + "\n"


def names_note(record: Record) -> tuple[str, ...]:
    """The options with which the text of a record is read, if its signals have names of their own."""
    by_default = (*names_of("u", (), len(record.inputs)), *names_of("y", (), len(record.outputs)))
    if record.signal_names == by_default:
        return ()
    return (f"read it with --inputs {','.join(record.inputs)} --outputs {','.join(record.outputs)}",)
