"""The notebook's own file, from which checks read marks, names of steps, and the order of cells."""

import json
from decimal import Decimal
from pathlib import Path

import pytest

from labsid.checks.cells import grade_id_of, is_stub
from labsid.checks.notebook_file import open_notebook, plain_cells


def notebook(points: float) -> str:
    meta = {"grade_id": "tiny-1", "grade": True, "solution": False, "points": points}
    cells = [
        {"cell_type": "markdown", "id": "text", "metadata": {}, "source": ["# Tiny\n", "## Step $\\Phi$"]},
        {"cell_type": "code", "id": "tiny-1", "metadata": {"nbgrader": meta}, "source": "check('tiny-1')"},
    ]
    return json.dumps({"cells": cells, "nbformat": 4})


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("JPY_SESSION_NAME", raising=False)


def test_the_notebook_in_the_folder_is_found() -> None:
    assert open_notebook("tiny") is None
    Path("tiny.ipynb").write_text(notebook(0.2), encoding="utf-8")
    found = open_notebook("tiny")
    assert found is not None
    (question,) = found.template.questions
    assert (question.points, question.heading, question.part) == (Decimal("0.2"), "Step Φ", "Tiny")
    assert [found.position(cell) for cell in ("text", "tiny-1", "other", None)] == [0, 1, None, None]


def test_a_renamed_notebook_is_found_by_the_name_that_jupyter_gives(monkeypatch: pytest.MonkeyPatch) -> None:
    Path("tiny.ipynb").write_text(notebook(0.2), encoding="utf-8")
    Path("my copy.ipynb").write_text(notebook(0.3), encoding="utf-8")
    monkeypatch.setenv("JPY_SESSION_NAME", str(Path("my copy.ipynb").resolve()))
    found = open_notebook("tiny")
    assert found is not None
    assert found.template.questions[0].points == Decimal("0.3")


@pytest.mark.parametrize("content", ["", "[]", '{"cells": [3]}', '{"cells": [{"cell_type": "code"}]}', '{"cells": []}'])
def test_a_damaged_notebook_is_no_notebook(content: str, monkeypatch: pytest.MonkeyPatch) -> None:
    Path("tiny.ipynb").write_text(content, encoding="utf-8")
    assert open_notebook("tiny") is None
    if content != '{"cells": []}':
        with pytest.raises(ValueError, match=r"it is not a notebook of format 4|one of its cells has no text"):
            plain_cells(json.loads(content or "null"))


def test_stubs_of_this_release_and_of_earlier_ones_are_known() -> None:
    for source in (
        "",
        " \n",
        "# t\n# Your code here\npass",
        "def f():\n    # Your code here\n    ...",
        "*Your answer here*",
    ):
        assert is_stub(source)
    assert not is_stub("t = 3  # Your code here")
    assert grade_id_of({"metadata": None}) == grade_id_of({}) == ""
