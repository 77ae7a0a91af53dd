"""A record as plain text, which says from what and how it was read."""

from labsid import __version__
from labsid.records.record import Record
from labsid.records.signals import jitter_note


def record_text(record: Record, source: str) -> str:
    """Write a record as text with the columns t,u,y, which any command reads without options.

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
    units = ("s", *record.units) if any(record.units) else ("", "", "")
    lines.append(",".join(f"{name} [{unit}]" if unit else name for name, unit in zip("tuy", units, strict=True)))
    for t, u, y, missing in zip(
        record.t.tolist(), record.u.tolist(), record.y.tolist(), record.missing.tolist(), strict=True
    ):
        lines.append(f"{t!r},{u!r},{'' if missing else repr(y)}")
    return "\n".join(lines) + "\n"
