"""What is handed in: notebooks with work in them, run from a clean start, with the words of the notebook."""

import io
import json
import shutil
import zipfile
from pathlib import Path

import nbformat
import pytest

from autograder.course.layout import RECORD_FILE, Course
from labsid.checks.kept_tries import KeptTry, tries_bytes
from labsid.checks.summary import PASSED
from labsid.cli.commands import main
from labsid.hand_in.clean_run import run_from_clean_start
from labsid.hand_in.long_outputs import LEFT_OUT, packed_notebook
from labsid.hand_in.progress import show_progress
from labsid.hand_in.saved_work import read_saved
from labsid.hand_in.submission_file import find_work, pack, run_notebook, run_text, tries_to_send

PRELAB, LAB, POSTLAB = "prelab-sinusoids", "lab-identification", "postlab-model-order"


@pytest.fixture
def work(released: Course, tmp_path: Path) -> Path:
    """A work folder with all assignments as they are released."""
    shutil.copytree(released.release, tmp_path / "work")
    return tmp_path / "work"


def answer(path: Path, **answers: str) -> None:
    """Write answers into a notebook, as Jupyter would."""
    notebook = json.loads(path.read_text(encoding="utf-8"))
    for cell in notebook["cells"]:
        text = answers.get(cell["id"].replace("-", "_"))
        if text is not None:
            cell["source"] = text.splitlines(keepends=True)
    path.write_text(json.dumps(notebook), encoding="utf-8")


def test_an_untouched_notebook_is_not_handed_in(work: Path) -> None:
    with pytest.raises(ValueError, match=f"there is nothing to hand in: {PRELAB}, {LAB}, {POSTLAB} as released"):
        find_work(work)
    answer(work / LAB / f"{LAB}.ipynb", lab_3b_start="It starts from rest.")
    found = find_work(work)
    assert [one.name for one in found.to_hand_in] == [LAB]
    assert [one.name for one in found.untouched] == [PRELAB, POSTLAB]


def test_a_run_and_saved_notebook_without_an_answer_is_untouched(work: Path) -> None:
    path = work / PRELAB / f"{PRELAB}.ipynb"
    notebook = nbformat.read(path, as_version=4)
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs = [nbformat.v4.new_output("stream", text="Ellipsis")]
            cell.execution_count = 1
    notebook.cells.append(nbformat.v4.new_code_cell(""))
    nbformat.write(notebook, path)
    assert read_saved(path).is_untouched
    notebook.cells[-1].source = "t = 3"
    nbformat.write(notebook, path)
    assert not read_saved(path).is_untouched


def test_the_hand_in_holds_the_notebooks_their_record_and_nothing_else(work: Path, tmp_path: Path) -> None:
    (work / LAB / ".ipynb_checkpoints").mkdir()
    (work / LAB / ".ipynb_checkpoints" / f"{LAB}-checkpoint.ipynb").touch()
    (work / "notes.txt").touch()
    for name, one in ((LAB, "lab_1a_extract_answer"), (PRELAB, "prelab_1_time_answer")):
        answer(work / name / f"{name}.ipynb", **{one: "t = 1"})
    found = find_work(work)
    assert found.remarks == ()
    for out in ("one.zip", "two.zip"):
        pack(found.to_hand_in, tmp_path / out)
        for path in work.rglob("*.ipynb"):
            path.touch()
    with zipfile.ZipFile(tmp_path / "one.zip") as archive:
        assert archive.testzip() is None
        expected = [f"{LAB}/{LAB}.ipynb", f"{LAB}/{RECORD_FILE}", f"{PRELAB}/{PRELAB}.ipynb"]
        assert sorted(archive.namelist()) == sorted(expected)
        for inside in expected:
            assert archive.read(inside) == (work / inside).read_bytes()
    assert (tmp_path / "one.zip").read_bytes() == (tmp_path / "two.zip").read_bytes()
    assert [one.name for one in find_work(work, LAB).to_hand_in] == [LAB]


def test_long_outputs_are_left_out_of_the_hand_in_and_kept_in_the_notebook(work: Path, tmp_path: Path) -> None:
    """60 MB would not be collected; short outputs, and pictures in texts, stay."""
    path = work / PRELAB / f"{PRELAB}.ipynb"
    answer(path, prelab_1_time_answer="t = 1")
    notebook = json.loads(path.read_bytes())
    code = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    short = [{"output_type": "stream", "name": "stdout", "text": ["1\n"]}]
    picture = {"output_type": "display_data", "metadata": {}, "data": {"image/png": "A" * 60_000_000}}
    code[0]["outputs"], code[1]["outputs"] = short, [picture]
    text = next(cell for cell in notebook["cells"] if cell["cell_type"] == "markdown")
    text["attachments"] = {"a.png": {"image/png": "B" * 200_000}}
    path.write_text(json.dumps(notebook), encoding="utf-8")
    saved = path.read_bytes()
    (remark,) = pack(find_work(work).to_hand_in, tmp_path / "out.zip")
    assert remark.startswith(f"{PRELAB}: long outputs of 1 cell are left out of the file.")
    assert path.read_bytes() == saved
    with zipfile.ZipFile(tmp_path / "out.zip") as archive:
        packed = json.loads(archive.read(f"{PRELAB}/{PRELAB}.ipynb"))
    code[1]["outputs"] = [{"output_type": "stream", "name": "stdout", "text": [LEFT_OUT]}]
    assert packed == notebook


def test_many_outputs_that_are_not_long_are_left_out_together() -> None:
    cells = [{"outputs": [{"text": "a" * 90_000}]} for _ in range(600)] + [{"outputs": [{"text": "b"}]}, {"source": ""}]
    content, remark = packed_notebook(PRELAB, json.dumps({"cells": cells}).encode())
    assert "outputs of 600 cells" in remark
    assert json.loads(content)["cells"][-2:] == cells[-2:]
    assert len(content) < 200_000


def test_a_notebook_that_would_not_be_collected_is_refused_with_what_to_do(work: Path, tmp_path: Path) -> None:
    path = work / PRELAB / f"{PRELAB}.ipynb"
    answer(path, prelab_1_time_answer=f"t = 1  # {'a' * 51 * 2**20}")
    with pytest.raises(ValueError, match=r"51 MB without its outputs; at most 50 MB are collected\. Make the pictures"):
        pack(find_work(work).to_hand_in, tmp_path / "out.zip")
    assert not (tmp_path / "out.zip").exists()


def test_a_notebook_of_another_name_is_said_to_be_left_out(work: Path) -> None:
    answer(work / PRELAB / f"{PRELAB}.ipynb", prelab_1_time_answer="t = 1")
    (work / LAB / f"{LAB}.ipynb").rename(work / LAB / "final version.ipynb")
    expected = f"{LAB}/final version.ipynb is not included: the notebook of this folder is {LAB}.ipynb"
    assert find_work(work).remarks == (expected,)


@pytest.mark.parametrize(
    "content",
    [
        pytest.param(b"", id="empty"),
        pytest.param(b'{"cells": [', id="cut off"),
        pytest.param(b"\x89PNG\xff", id="binary"),
        pytest.param(b"[]", id="a list"),
        pytest.param(b"{}", id="no cells"),
        pytest.param(b'{"cells": 3}', id="cells that are a number"),
        pytest.param(b'{"cells": [3]}', id="a cell that is a number"),
        pytest.param(b'{"cells": [{"cell_type": "code", "metadata": {}}]}', id="a cell without source"),
        pytest.param(
            b'{"cells": [{"cell_type": "code", "source": "", "metadata":'
            b'{"nbgrader": {"grade_id": "a", "grade": true, "points": "x"}}}]}',
            id="points of text",
        ),
        pytest.param(b"[" * 100_000, id="nesting without end"),
    ],
)
def test_a_notebook_that_cannot_be_read_is_not_handed_in(work: Path, content: bytes) -> None:
    (work / PRELAB / f"{PRELAB}.ipynb").write_bytes(content)
    said = r"nothing to hand in: .*prelab-sinusoids.ipynb is not a readable notebook \(\w+\)\. Open it"
    with pytest.raises(ValueError, match=said) as error:
        find_work(work)
    assert "\n" not in str(error.value)
    assert "is not a readable notebook" in repr(show_progress(work))


def test_a_notebook_that_cannot_be_read_does_not_hold_back_the_others(
    work: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    answer(work / LAB / f"{LAB}.ipynb", lab_3b_start="It starts from rest.")
    (work / PRELAB / f"{PRELAB}.ipynb").write_bytes(b'{"cells": [')
    found = find_work(work)
    assert [one.name for one in found.to_hand_in] == [LAB]
    assert list(found.unreadable) == [PRELAB]
    with pytest.raises(ValueError, match=r"nothing to hand in: .* is not a readable notebook"):
        find_work(work, PRELAB)

    monkeypatch.setattr("labsid.hand_in.submission_file.run_notebook", lambda notebook: None)
    out = tmp_path / "hand-in.zip"
    assert main(["submit", "--folder", str(work), "--out", str(out)]) == 0
    with zipfile.ZipFile(out) as archive:
        assert sorted(archive.namelist()) == [f"{LAB}/{RECORD_FILE}", f"{LAB}/{LAB}.ipynb"]
    said = capsys.readouterr().out.splitlines()
    assert f"{PRELAB} cannot be handed in: {work / PRELAB / PRELAB}.ipynb is not a readable notebook" in "\n".join(said)
    assert said[-2:] == [
        f"Hand in this file: {out} ({LAB})",
        f"Not in it, because it cannot be read: {PRELAB}. Mend it and run this command again.",
    ]


def test_a_file_that_the_machine_does_not_give_is_named(work: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    answer(work / LAB / f"{LAB}.ipynb", lab_3b_start="It starts from rest.")
    read = Path.read_bytes

    def refused(path: Path) -> bytes:
        if path.stem == PRELAB:
            raise PermissionError(13, "Permission denied", str(path))
        return read(path)

    monkeypatch.setattr(Path, "read_bytes", refused)
    assert "cannot be read (Permission denied)" in find_work(work).unreadable[PRELAB]


def test_a_notebook_of_somebody_else_is_not_handed_in(work: Path) -> None:
    content = '{"cells": [{"cell_type": "code", "source": "a = 3", "metadata": {}}], "nbformat": 4}'
    (work / LAB / f"{LAB}.ipynb").write_text(content, encoding="utf-8")
    with pytest.raises(ValueError, match="contains no cell of the assignment"):
        find_work(work)


def test_an_empty_folder_is_said(tmp_path: Path) -> None:
    for folder in (tmp_path, tmp_path / "nosuch"):
        with pytest.raises(ValueError, match="contains no notebooks"):
            find_work(folder)
    with pytest.raises(ValueError, match=r"Expected step-response/step-response\.ipynb below it"):
        find_work(tmp_path, "step-response")


# ---- the clean run


@pytest.mark.slow
def test_a_wrong_step_costs_its_own_marks_alone(solve) -> None:
    path = solve(
        LAB,
        lab_1c_offsets_answer="y_offset, u_offset = 1.0, 1.0\ny, u = y_act - 1, u_act - 1",
        lab_2a_phi_answer="half = len(y) // 2\nPhi = undefined",
        lab_2b_theta_answer=None,
    )
    saved = read_saved(path)
    run = run_from_clean_start(saved.cells, saved.template, saved.path)
    states = {one.question.id: one.state for one in run.states}
    wrong = {question: state for question, state in states.items() if state not in ("right", "marked by hand")}
    assert wrong == {"lab-1c-offsets": "not right", "lab-2a-phi": "not right", "lab-2b-theta": "not done"}
    shown = "\n".join(run_text(saved, run))
    assert "Total: 1.4 of 2 marks; 0.1 of them are given by hand" in shown
    said = (
        "✗ lab-2a-phi (2a. Build Φ; 0.2 marks): its answer cell stopped with NameError: name 'undefined' is not defined"
    )
    line = next(line for line in shown.splitlines() if line.startswith(said))
    assert line.endswith("Correct that and run the cell, then this check.")


@pytest.mark.slow
def test_what_passes_only_in_a_used_notebook_is_found(solve) -> None:
    """An answer below its check, a variable from further down, and given cells that the student has changed."""
    path = solve(PRELAB, prelab_1_time_answer=None, prelab_4_matrix_answer="data_new = later")
    notebook = nbformat.read(path, as_version=4)
    place = {cell.id: i for i, cell in enumerate(notebook.cells)}
    notebook.cells[place["prelab-3-cut"]].source = "print('all right')"
    below = "later = np.hstack([t_new, y1_new, y2_new])"
    notebook.cells.insert(place["prelab-4-function"] + 1, nbformat.v4.new_code_cell(below))
    right = "t = np.linspace(0, 100, 1001).reshape(-1, 1)"
    notebook.cells.insert(place["prelab-1-time"] + 1, nbformat.v4.new_code_cell(right))
    nbformat.write(notebook, path)
    states = {one.question.id: one.state for one in run_notebook(read_saved(path)).states}
    assert states["prelab-1-time"] == "not done"
    assert states["prelab-4-matrix"] == "not right"
    assert states["prelab-2-noise"] == states["prelab-3-cut"] == states["prelab-6-cut-off"] == "right"


@pytest.mark.slow
def test_a_students_own_cell_that_fails_is_named_and_the_cells_after_it_are_run(solve) -> None:
    path = solve(PRELAB)
    notebook = nbformat.read(path, as_version=4)
    place = next(i for i, cell in enumerate(notebook.cells) if cell.id == "prelab-2-noise") + 1
    notebook.cells.insert(place, nbformat.v4.new_code_cell("\n# a try\nprint(undefined)"))
    notebook.cells.insert(place, nbformat.v4.new_code_cell("mean = np.mean(y1)\nOut = In = 0\nbefore = _i, Out, In"))
    nbformat.write(notebook, path)
    saved = read_saved(path)
    run = run_notebook(saved)
    assert [one.state for one in run.states].count("right") == len(run.states) - 1  # the open question
    history, remark = run.remarks
    assert history.startswith("`_i`, which Jupyter makes of the cells that were run before, is missing or another one")
    assert remark.startswith("Your own cell that begins with `# a try` stopped with NameError: name 'undefined' is not")
    assert list(run_text(saved, run))[-1] == remark
    assert "correct it or delete it" in remark


@pytest.mark.slow
@pytest.mark.parametrize("line", ["import time; time.sleep(999)", "import os; os._exit(1)"])
def test_an_endless_loop_and_a_kernel_that_ends_cost_their_cell_alone(line: str, solve) -> None:
    path = solve(PRELAB, prelab_4_function_answer=line)
    saved = read_saved(path)
    run = run_from_clean_start(saved.cells, saved.template, saved.path, cell_seconds=8)
    states = {one.question.id: one.state for one in run.states}
    assert [one for one, state in states.items() if state == "not right"] == ["prelab-4-function"]
    assert list(states.values()).count("right") == len(states) - 2


@pytest.mark.slow
def test_submit_asks_before_it_writes_what_is_not_right(
    released: Course, work: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "hand-in.zip"
    answer(work / PRELAB / f"{PRELAB}.ipynb", prelab_1_time_answer="t = np.linspace(0, 100, 1001).reshape(-1, 1)")
    command = ["submit", "--folder", str(work), "--out", str(out)]
    assert main(command) == 2
    shown = capsys.readouterr()
    assert "7 questions are not right or not done." in shown.err
    assert "to write it all the same, add --yes" in shown.err
    assert not out.exists()
    assert main([*command, "--yes", "--assignment", PRELAB]) == 0
    shown = capsys.readouterr()
    lines = [" ".join(line.split()) for line in shown.out.splitlines()]
    assert "✓ prelab-1-time 0.1 of 0.1 right 1. A column vector of time" in lines
    assert "· prelab-3-cut 0 of 0.15 not done 3. Cut off the first 200 samples" in lines
    assert "Total: 0.1 of 1 marks; 0.05 of them are given by hand" in lines
    assert lines[-1] == f"Hand in this file: {out} ({PRELAB})"
    with zipfile.ZipFile(out) as archive:
        assert archive.namelist() == [f"{PRELAB}/{PRELAB}.ipynb"]


class Terminal(io.StringIO):
    """What a student types."""

    def isatty(self) -> bool:
        return True


@pytest.mark.slow
@pytest.mark.parametrize(("typed", "status"), [("n\n", 2), ("y\n", 0)])
def test_at_a_terminal_submit_asks(
    typed: str, status: int, work: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    out = tmp_path / "hand-in.zip"
    answer(work / PRELAB / f"{PRELAB}.ipynb", prelab_1_time_answer="t = 3")
    monkeypatch.setattr("sys.stdin", Terminal(typed))
    assert main(["submit", "--folder", str(work), "--out", str(out)]) == status
    shown = capsys.readouterr()
    assert f"8 questions are not right or not done. Write {out} all the same?" in shown.out
    assert out.exists() == (status == 0)
    assert (f"{out} was not written." in shown.err) == (status == 2)


@pytest.mark.parametrize(
    ("typed", "is_sent"),
    [("n\n", False), ("\n", False), ("y\n", True), (None, False)],
    ids=["no", "return alone", "yes", "no terminal"],
)
def test_tries_are_sent_after_a_yes_alone(
    typed: str | None, is_sent: bool, work: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    monkeypatch.setattr("labsid.hand_in.submission_file.run_notebook", lambda notebook: None)
    answer(work / PRELAB / f"{PRELAB}.ipynb", prelab_1_time_answer="t = 3")
    kept = work / PRELAB / f"{PRELAB}-tries.json"
    kept.write_bytes(tries_bytes([KeptTry("prelab-1-time", 3, False, "row")]))
    monkeypatch.setattr("sys.stdin", io.StringIO() if typed is None else Terminal(typed))
    out = tmp_path / "hand-in.zip"
    assert main(["submit", "--folder", str(work), "--out", str(out)]) == 0
    shown = capsys.readouterr().out
    with zipfile.ZipFile(out) as archive:
        assert (f"{PRELAB}/{kept.name}" in archive.namelist()) == is_sent
    assert ("Send them, too?" in shown) == (typed is not None)
    assert ("[y/N]" in shown) == (typed is not None)


@pytest.mark.parametrize("content", [None, tries_bytes([]), b"{", b" " * 500_000])
def test_nobody_is_asked_about_tries_that_are_not_there(content: bytes | None, work: Path) -> None:
    answer(work / PRELAB / f"{PRELAB}.ipynb", prelab_1_time_answer="t = 3")
    if content is not None:
        (work / PRELAB / f"{PRELAB}-tries.json").write_bytes(content)
    assert tries_to_send(find_work(work).to_hand_in) == {}


@pytest.mark.slow
def test_the_start_page_tells_how_far_one_is(jupyter) -> None:
    jupyter.answer("prelab-1-time", "t = np.linspace(0, 100, 1001).reshape(-1, 1)")
    cell = jupyter.cell("prelab-1-time")
    outcome = {"labsid": {"question": "prelab-1-time", "state": "right"}}
    cell["outputs"] = [{"output_type": "display_data", "data": {"text/plain": "✓"}, "metadata": outcome}]
    failed = jupyter.cell("prelab-2-noise")
    failed["outputs"] = [{"output_type": "error", "ename": "CheckFailed", "evalue": "no", "traceback": []}]
    jupyter.edit("prelab-2-noise-answer", "y1 = 3")
    untouched = jupyter.cell("prelab-3-cut")
    untouched["outputs"] = failed["outputs"]
    jupyter.save()
    shown = show_progress(jupyter.path.parent.parent)
    expected = "0.1 of 1 marks; 0.05 of them are given by hand (1 right, 1 not right, 6 not done)"
    assert [(row.name, row.said) for row in shown.rows] == [(PRELAB, expected)]
    assert expected in shown._repr_html_()


def test_what_is_right_on_ones_own_record_alone_is_named(work: Path, released: Course) -> None:
    """A number in the middle of an expression, which the check in the notebook cannot see."""
    source = json.loads((released.source / POSTLAB / f"{POSTLAB}.ipynb").read_text(encoding="utf-8"))
    answers = {cell["id"].replace("-", "_"): "".join(cell["source"]) for cell in source["cells"]}
    right = {key: text for key, text in answers.items() if key.endswith("_answer")}
    path = work / POSTLAB / f"{POSTLAB}.ipynb"
    typed = "theta_1 = np.array([0.9767251198332572, 0.0694983904318448]) + 0 * Phi_1[0]"
    answer(path, **right | {"postlab_1_theta_answer": typed})
    run = run_notebook(read_saved(path))
    assert run is not None
    assert list(run.reasons) == ["postlab-1-theta"]
    assert "it is right on your record, and not on another one" in run.reasons["postlab-1-theta"]
    states = {one.question.id: one.state for one in run.states}
    assert states["postlab-1-transfer-function"] == PASSED
