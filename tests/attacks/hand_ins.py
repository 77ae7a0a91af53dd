"""Hand-ins that are not what they should be: the notebook's text, what stands beside it, what pages make of it."""

import json
import os
from pathlib import Path
from typing import Any

from attacks import FIRST, NOISE, QUESTIONS, TIME, Attack

NAME = "prelab-sinusoids.ipynb"
SCRIPT = "<script>alert('planted')</script><img src=x onerror=alert(1)>"
ANSI = "\\x1b[31mred\\x1b]8;;file:///planted\\x07\\x1b[2J"
_RIGHT = "the answers are right, and nothing else of the file counts"


def _cell(notebook: dict[str, Any], grade_id: str) -> dict[str, Any]:
    return next(cell for cell in notebook["cells"] if cell.get("id") == grade_id)


def _write(folder: Path, notebook: Any, name: str = NAME) -> None:
    (folder / name).write_text(json.dumps(notebook), encoding="utf-8")


def _duplicates(folder: Path, notebook: dict[str, Any]) -> None:
    for grade_id in ("prelab-1-time-answer", "prelab-1-time", "prelab-6-clock", "prelab-setup"):
        notebook["cells"].append(_cell(notebook, grade_id))
    _write(folder, notebook)


def _without_checks(folder: Path, notebook: dict[str, Any]) -> None:
    kept = [cell for cell in notebook["cells"] if cell.get("id") not in QUESTIONS]
    _write(folder, {**notebook, "cells": kept})


def _checks_changed(folder: Path, notebook: dict[str, Any]) -> None:
    for question in QUESTIONS:
        _cell(notebook, question)["source"] = "raise SystemExit"
    _cell(notebook, "prelab-setup")["source"] = "check = print"
    _write(folder, notebook)


def _points_changed(folder: Path, notebook: dict[str, Any]) -> None:
    for cell in notebook["cells"]:
        meta = cell["metadata"].get("nbgrader")
        if meta is not None:
            meta |= {"points": 1e9, "grade": True, "solution": True, "locked": False, "max_score": "NaN"}
    _cell(notebook, "prelab-1-time-answer")["source"] = "pass"
    _write(folder, notebook)


def _hostile_metadata(folder: Path, notebook: dict[str, Any]) -> None:
    notebook["metadata"] = {"kernelspec": {"name": "../../bin/sh", "argv": ["/bin/sh"]}, "title": SCRIPT}
    for index, value in enumerate((SCRIPT, "../../etc", "\ud800", 10**20, None, [[]], {"grade_id": {}})):
        nbgrader = value if isinstance(value, dict) else {"grade_id": value}
        notebook["cells"].insert(
            index, {"cell_type": "code", "metadata": {"nbgrader": nbgrader}, "source": "", "id": str(value)}
        )
    _write(folder, notebook)


def _hostile_outputs(folder: Path, notebook: dict[str, Any]) -> None:
    bundle = {"text/html": SCRIPT, "application/javascript": "alert('planted')", "image/svg+xml": SCRIPT}
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            cell["outputs"] = [
                {"output_type": "display_data", "data": bundle, "metadata": {}},
                {"output_type": "stream", "name": "stdout", "text": SCRIPT + "\x1b[31m"},
                {"output_type": "error", "ename": SCRIPT, "evalue": SCRIPT, "traceback": [SCRIPT]},
            ]
    _write(folder, notebook)


def _text(text: str | bytes) -> Any:
    def hand_in(folder: Path, notebook: dict[str, Any]) -> None:
        (folder / NAME).write_bytes(text.encode() if isinstance(text, str) else text)

    return hand_in


def _renamed(folder: Path, notebook: dict[str, Any]) -> None:
    _write(folder, notebook, "prelab-sinusoids (1) final $(touch x) ;'.ipynb")


def _link_to_another(folder: Path, notebook: dict[str, Any]) -> None:
    (folder / NAME).symlink_to(f"../../honest-ada/prelab-sinusoids/{NAME}")


def _link_of_the_folder(folder: Path, notebook: dict[str, Any]) -> None:
    folder.rmdir()
    folder.symlink_to("../honest-ada/prelab-sinusoids")


def _link_to_a_device(folder: Path, notebook: dict[str, Any]) -> None:
    (folder / NAME).symlink_to("/dev/zero")


def _link_to_the_machine(folder: Path, notebook: dict[str, Any]) -> None:
    (folder / NAME).symlink_to("/etc/passwd")


def _pipes(folder: Path, notebook: dict[str, Any]) -> None:
    _write(folder, notebook)
    os.mkfifo(folder / "timestamp.txt")
    os.mkfifo(folder / "another.ipynb")
    (folder / "json.py").write_text("raise SystemExit", encoding="utf-8")


def _beside(folder: Path, notebook: dict[str, Any]) -> None:
    _write(folder, notebook)
    (folder / "a.ipynb").symlink_to("/dev/zero")
    with (folder / "b.ipynb").open("wb") as sparse:
        sparse.truncate(1 << 40)


def _long_text(folder: Path, notebook: dict[str, Any]) -> None:
    notebook["cells"].append({"cell_type": "markdown", "metadata": {}, "source": "a" * 9_000_000})
    _cell(notebook, "prelab-1-time-answer")["source"] = "t = [['a' * 50 + 'b'] * 1000] * 2"
    _write(folder, notebook)


def _too_long_text(folder: Path, notebook: dict[str, Any]) -> None:
    notebook["cells"].append({"cell_type": "markdown", "metadata": {}, "source": "a" * 10_000_000})
    _write(folder, notebook)


def _long_code(folder: Path, notebook: dict[str, Any]) -> None:
    _cell(notebook, "prelab-1-time-answer")["source"] += '\n0\n"""\n' + "x;" * 60_000 + '\n"""\n'
    _write(folder, notebook)


ATTACKS = (
    Attack("duplicate grade_id", _RIGHT, hand_in=_duplicates),
    Attack("check cells deleted", "they are put back", hand_in=_without_checks),
    Attack("check cells and setup changed", "they are put back", hand_in=_checks_changed),
    Attack("points in the metadata changed", "points are the release's", hand_in=_points_changed, loses=(TIME,)),
    Attack("notebook renamed", "it is taken for what it is", hand_in=_renamed),
    Attack("hostile metadata", _RIGHT, hand_in=_hostile_metadata),
    Attack("hostile outputs", _RIGHT, hand_in=_hostile_outputs),
    Attack("corrupt JSON", "quarantined", hand_in=_text('{"cells": ['), loses=QUESTIONS, said="broken JSON"),
    Attack("nested JSON", "quarantined", hand_in=_text("[" * 10**6), loses=QUESTIONS, said="cannot be read"),
    Attack(
        "JSON that unpacks to twenty times its size",
        "quarantined before it is unpacked",
        hand_in=_text(b'{"nbformat": 4, "cells": [' + b"[]," * (6 << 20) + b"[]]}"),
        loses=QUESTIONS,
        said="cannot be read",
    ),
    Attack("not text", "quarantined", hand_in=_text(bytes(range(256))), loses=QUESTIONS, said="not text in UTF-8"),
    Attack(
        "a link to another's notebook",
        "quarantined: a link is nobody's work",
        hand_in=_link_to_another,
        loses=QUESTIONS,
        said="a symbolic link",
    ),
    Attack(
        "a link to another's folder",
        "quarantined: a link is nobody's work",
        hand_in=_link_of_the_folder,
        loses=QUESTIONS,
        said="a symbolic link",
    ),
    Attack("a link to a device", "no notebook", hand_in=_link_to_a_device, loses=QUESTIONS, said="no notebook"),
    Attack(
        "a link to a file of this machine",
        "quarantined, and nothing of the file is told",
        hand_in=_link_to_the_machine,
        loses=QUESTIONS,
        said="a symbolic link",
    ),
    Attack("a link to a device and a file of 1 TB beside the notebook", "they are not read", hand_in=_beside),
    Attack(
        "texts to look for in a text of 9 MB",
        "a limited number of them is looked for",
        hand_in=_long_text,
        loses=(TIME,),
    ),
    Attack(
        "a text of 10 MB", "quarantined", hand_in=_too_long_text, loses=QUESTIONS, said="10 million characters of text"
    ),
    Attack("code of 120 kB", "it is compared as text", hand_in=_long_code),
    Attack("pipes beside the notebook", "they are not opened", hand_in=_pipes),
    Attack(
        "HTML and colours in output and error",
        "the cell stopped; what it said is shown as text",
        {NOISE: f'print("{SCRIPT}{ANSI}")\nfrom IPython.display import HTML, Javascript, display\n'
                f'display(HTML("{SCRIPT}"), Javascript("alert(1)"))\n'
                f'class Planted(Exception):\n    pass\nPlanted.__name__ = "{SCRIPT}"\n'
                f'raise Planted("{SCRIPT}{ANSI}</pre>`{SCRIPT}`")'},
        loses=(NOISE,),
    ),
    Attack(
        "HTML in a figure",
        "the figure is as it should be, and the picture shows its title as text",
        extras={FIRST: (f'ax_a.set_title("(a) Original data {SCRIPT}]]>")',)},
    ),
    Attack("output without end", _RIGHT, extras={NOISE: ("print('x' * 30_000_000)",) * 3}),
)  # fmt: skip
