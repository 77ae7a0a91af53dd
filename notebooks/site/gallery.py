"""Diagnose a simulated rig with each effect, for the gallery of the site: ``python notebooks/site/gallery.py``.

The records are `dev` cases of the sealed check, drawn from `labsid.rig`: of each effect the first record that has it
alone. A run makes what is missing, and everything again once the diagnosis has changed.
"""

import json
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from labsid import diagnose, load_record
from labsid.blind.suite import diagnosis_hash, label_dict, make_cases, write_case
from labsid.gap.effects.families import DESCRIPTIONS
from labsid.plots import save_svg

GALLERY = Path(__file__).resolve().parents[2] / "build" / "gallery"
ROWS = {"single-clear": 40, "families": 4, "honest": 20, "joints": 6, "with-sim": 1}
"""Rows of the sealed check, and how many of their cases are looked through."""


def write_records(folder: Path) -> Iterator[str]:
    """Write a record of each effect, named after it, and its simulation if it has one; yields the names."""
    missing = set(DESCRIPTIONS)
    for row, count in ROWS.items():
        for case in make_cases("dev", count, [row]):
            labels = label_dict(case)["labels"]
            if len(labels) == 1 and labels[0] in missing:
                (name,) = labels
                missing.remove(name)
                write_case(folder, replace(case, name=name))
                yield name
    if missing:
        print(f"no record among {ROWS}: {', '.join(sorted(missing))}")


def make_entry(name: str, folder: Path) -> None:
    """Diagnose a record, and keep in the gallery its files, the text of the diagnosis and its figure."""
    given = folder / f"{name}.sim.json"
    result = diagnose(load_record(folder / f"{name}.csv"), json.loads(given.read_text()) if given.is_file() else None)
    save_svg(result.plot(), GALLERY / f"{name}.svg")
    for path in folder.glob(f"{name}.*"):
        (GALLERY / path.name).write_bytes(path.read_bytes())
    (GALLERY / f"{name}.txt").write_text(str(result), encoding="utf-8")


def main() -> None:
    """Make the gallery."""
    GALLERY.mkdir(parents=True, exist_ok=True)
    stamp = GALLERY / "diagnosis"
    if not stamp.is_file() or stamp.read_text() != str(diagnosis_hash()):
        for path in GALLERY.iterdir():
            path.unlink()
        stamp.write_text(str(diagnosis_hash()))
    if all((GALLERY / f"{name}.txt").is_file() for name in DESCRIPTIONS):
        return
    with TemporaryDirectory() as folder:
        for name in write_records(Path(folder)):
            if not (GALLERY / f"{name}.txt").is_file():
                start = time.perf_counter()
                make_entry(name, Path(folder))
                print(f"{name}: {time.perf_counter() - start:.1f} s", flush=True)


if __name__ == "__main__":
    main()
