"""Write the records of rows with their labels apart: ``python -m labsid.blind.record_folders FOLDER --row ROW``."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from labsid.blind.rows import ON_REQUEST, ROWS
from labsid.blind.suite import write_suite


def write_rows(folder: Path, rows: Sequence[str], suite: str = "dev", per_row: int | None = None) -> list[Path]:
    """Write the records of each row into ``ROW/records`` and their labels into ``ROW/labels.json``.

    Parameters
    ----------
    folder : Path
        Created if missing.
    rows : sequence of str
    suite : {"dev", "final"}
    per_row : int, optional

    Returns
    -------
    list of Path
        The files of labels. Records that need further words of the command line have them in ``NAME.options``.
    """
    paths = []
    for row in rows:
        written = write_suite(folder / row / "records", suite, per_row, [row])
        paths.append(written.replace(folder / row / "labels.json"))
    return paths


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the records and print where their labels are."""
    parser = argparse.ArgumentParser(prog="python -m labsid.blind.record_folders", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--row", action="append", choices=list(ROWS), help=f"default: {', '.join(ON_REQUEST)}")
    parser.add_argument("--per-row", type=int, default=8, help="records of each row")
    parser.add_argument("--suite", choices=("dev", "final"), default="dev")
    chosen = parser.parse_args(arguments)
    for path in write_rows(chosen.folder, chosen.row or ON_REQUEST, chosen.suite, chosen.per_row):
        print(path)


if __name__ == "__main__":
    main()
