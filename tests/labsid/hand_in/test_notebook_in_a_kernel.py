"""The checks in a real kernel, with cells run in the orders in which students run them."""

import json
import shutil
from itertools import pairwise
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

from autograder.course.layout import Course
from labsid.checks.kept_tries import read_tries
from labsid.checks.time_limit import CELL_SECONDS
from labsid.hand_in.kernel import CellOutcome, NotebookKernel

pytestmark = pytest.mark.slow

TIME = "t = np.linspace(0, 100, 1001).reshape(-1, 1)"
ANSWER, CHECK = "prelab-1-time-answer", "prelab-1-time"
NAME = "prelab-1-time (1. A column vector of time; 0.1 marks)"


def test_an_answer_cell_that_failed_is_told(jupyter) -> None:
    assert jupyter.answer(CHECK, TIME).startswith(f"✓ {NAME}: ")
    shown = jupyter.answer(CHECK, f"{TIME}\nt = tt")
    error = "NameError: name 'tt' is not defined"
    assert shown.startswith(
        f"✗ {NAME}: its answer cell stopped with {error}, in line 2: `t = tt`. No cell that has been"
    )
    assert shown.endswith("Correct that and run the cell, then this check.")
    assert "its answer cell stopped with SyntaxError" in jupyter.answer(CHECK, "t = = 3")
    assert jupyter.answer(CHECK, TIME).startswith("✓")


def test_tries_are_those_of_changed_answers(jupyter) -> None:
    jupyter.add(CHECK, "mine", "check.tries.keep()")
    assert "From now on the checks keep your tries" in jupyter.run("mine")
    jupyter.run(ANSWER, CHECK)  # as released: no try
    for source in ("t = tt", "t = tt", TIME.replace(".reshape(-1, 1)", ""), TIME, TIME):
        jupyter.answer(CHECK, source)
    path = jupyter.path.with_name("prelab-sinusoids-tries.json")
    tries = read_tries(path.read_bytes())
    assert [(one.question, one.right) for one in tries] == [(CHECK, False), (CHECK, False), (CHECK, True)]
    assert tries[0].slip == "Python error"
    assert "linspace" not in path.read_text(encoding="utf-8")
    jupyter.edit("mine", "check.tries()")
    assert jupyter.run("mine").splitlines()[-1].split() == ["0", CHECK, "right"]
    jupyter.edit("mine", "check.tries.delete()")
    jupyter.run("mine")
    assert not path.exists()


def test_an_answer_that_was_changed_and_not_run_is_told(jupyter) -> None:
    jupyter.edit(ANSWER, TIME)
    assert jupyter.run(CHECK).endswith(
        "its answer cell has not been run since the kernel was started. Run it, then this check."
    )
    assert jupyter.run(ANSWER, CHECK).startswith("✓")
    jupyter.edit(ANSWER, TIME.replace("1001", "101"), save=False)
    assert jupyter.run(CHECK).startswith("✓")  # not saved: nobody can know
    jupyter.save()
    assert jupyter.run(CHECK).endswith("its answer cell was changed after it was last run. Run it, then this check.")
    assert jupyter.run(ANSWER, CHECK).startswith("✗")
    assert "was changed" not in jupyter.run(CHECK)


def test_a_variable_of_an_earlier_run_is_told(jupyter) -> None:
    jupyter.answer(CHECK, TIME)
    shown = jupyter.answer(CHECK, TIME.replace("t =", "time ="))
    assert shown.endswith("`t` is from an earlier run of the answer cell; as the cell is now, it does not make `t`.")


def test_an_answer_below_its_check_is_told(jupyter) -> None:
    jupyter.add(CHECK, "mine", TIME)
    shown = jupyter.run(ANSWER, "mine", CHECK)
    assert "`t` is made further down, by a cell of your own. Grading runs the cells from top to bottom" in shown
    jupyter.answer("prelab-2-noise", TIME)
    assert "`t` is made further down, by the cell prelab-2-noise-answer" in jupyter.run(CHECK)
    jupyter.add("prelab-setup", "above", TIME)
    assert jupyter.run("above", ANSWER, CHECK).startswith("✓")


def test_a_right_value_set_further_down_does_not_cover_a_wrong_answer(jupyter) -> None:
    assert jupyter.answer(CHECK, "t = 3").startswith("✗")
    jupyter.add(CHECK, "mine", TIME)
    shown = jupyter.run("mine", CHECK)
    assert shown.endswith("set anew further down, by a cell of your own. Run the answer cell again, then this check.")


def test_a_cell_of_ones_own_whose_place_is_not_known_is_remarked(jupyter) -> None:
    jupyter.add("prelab-setup", "unsaved", TIME, save=False)
    shown = jupyter.run(ANSWER, "unsaved", CHECK)
    assert shown.startswith("✓")
    assert shown.endswith("`t` is made in a cell of your own: it counts if that cell stands above this check.")


def test_a_variable_of_a_deleted_cell_is_told(jupyter) -> None:
    jupyter.add("prelab-setup", "mine", TIME)
    assert jupyter.run("mine", ANSWER, CHECK).startswith("✓")
    jupyter.delete("mine")
    assert "`t` was made by a cell that is no longer in the notebook" in jupyter.run(CHECK)


def test_a_variable_of_the_answer_made_only_further_down_is_told(jupyter) -> None:
    jupyter.add(CHECK, "mine", "count = 1001")
    jupyter.run("mine")
    shown = jupyter.answer(CHECK, TIME.replace("1001", "count"))
    assert "the answer uses `count`, which only a cell of your own further down makes" in shown
    jupyter.add("prelab-setup", "above", "count = 1001")
    assert jupyter.run("above", ANSWER, CHECK).startswith("✓")


def test_a_taught_function_and_a_pip_line_are_told_in_the_notebook(jupyter) -> None:
    shown = jupyter.answer(CHECK, f"from labsid import find_offsets\n{TIME}")
    assert "it uses `labsid.find_offsets`, which is the taught function itself. Grading refuses it" in shown
    jupyter.add("prelab-setup", "mine", "from labsid import make_sinusoids as taught")
    jupyter.run("mine")
    shown = jupyter.answer(CHECK, f"taught\n{TIME}")
    assert "it uses `taught`, which is the taught function itself" in shown
    jupyter.run("prelab-4-function-answer")
    jupyter.edit("prelab-4-function-answer", "from labsid import cut_off")
    assert "`cut_off` is the taught function itself" in jupyter.run("prelab-4-function-answer", "prelab-4-function")
    shown = jupyter.answer(CHECK, f"%pip --version\n{TIME}")
    assert shown.startswith("✓")  # grading skips the line, too


def test_deleted_given_lines_are_told(released: Course, jupyter) -> None:
    """Grading puts them back; in the notebook the check names them."""
    release = f"lambda: __import__('pathlib').Path({str(released.release)!r})"
    jupyter.kernel.run(f"import labsid.checks.notebook_file as file\nfile.release_folder = {release}", None, 20)
    given = 'fig_1, (ax_a, ax_b) = plt.subplots(2, 1, figsize=(8, 7), layout="constrained")'
    told = f"Its answer cell lacks the line `{given}` of the release: undo the deletion, or copy from the release."
    shown = jupyter.answer("prelab-5-original", "ax_a.plot([0, 1], [0, 1])")
    assert "its answer cell stopped with NameError: name 'ax_a' is not defined" in shown
    assert shown.endswith(told)
    assert jupyter.answer("prelab-5-original", "print(1)").endswith(told)
    assert "lacks" not in jupyter.answer("prelab-5-original", "fig_1, (ax_a, ax_b) = plt.subplots(2)")


def test_an_endless_loop_is_told(jupyter) -> None:
    jupyter.edit(ANSWER, "while True:\n    pass")
    assert "KeyboardInterrupt" in jupyter.run(ANSWER, seconds=1)
    shown = jupyter.run(CHECK)
    assert "its answer cell was interrupted after 1 s, in `while True: " in shown
    assert f"Grading stops a cell after {CELL_SECONDS:g} s" in shown


@pytest.mark.parametrize("prefix", [None, "editor://notebook#"])
def test_a_program_that_sends_no_ids_or_ids_of_its_own_gets_plain_checks(
    prefix: str | None, released: Course, tmp_path: Path
) -> None:
    shutil.copytree(released.release / "prelab-sinusoids", tmp_path / "work")
    path = tmp_path / "work" / "prelab-sinusoids.ipynb"
    cells = {cell.id: cell for cell in nbformat.read(path, as_version=4).cells}
    path.write_text(path.read_text(encoding="utf-8").replace("pass", TIME, 1), encoding="utf-8")
    with NotebookKernel(path.parent) as kernel:

        def run(source: str, name: str) -> CellOutcome:
            return kernel.run(source, None if prefix is None else f"{prefix}{name}", 20)

        run(cells["prelab-setup"].source, "a")
        run("t = np.linspce(0, 100, 1001)", "b")
        for _ in range(2):
            shown = run(f'check("{CHECK}")', "c")
            assert shown.error == "CheckFailed"
            assert "the cell that was run before this check stopped with AttributeError" in shown.text
            assert shown.text.endswith("Correct that and run the cell, then this check.")
        run("t = 3", "b")
        shown = run(f'check("{CHECK}")', "c")
        assert shown.error == "CheckFailed"
        assert "stopped" not in shown.text
        run(TIME, "b")
        run("t = undefined", "b")
        assert run(f'check("{CHECK}")', "c").printed.startswith("✓")


def test_skipping_a_function_says_what_needs_one(jupyter) -> None:
    jupyter.add("prelab-4-function", "skip", 'check.skip("prelab-4-function")')
    assert jupyter.run("skip").endswith(
        "It sets no variable for later steps. A function is not given: code that calls `cut_off` needs one of your own."
    )


def test_a_skipped_step_unlocks_the_ones_after_it(jupyter) -> None:
    jupyter.answer(CHECK, "t = 3")
    noise = (
        "y1 = np.sin(0.02 * np.pi * t) + rng.uniform(-0.2, 0.2, t.shape)\n"
        "y2 = np.cos(0.02 * np.pi * t) + rng.uniform(-0.2, 0.2, t.shape)"
    )
    jupyter.edit("prelab-2-noise-answer", noise)
    shown = jupyter.answer("prelab-2-noise", "y1 = 0")
    assert shown.endswith(f"it starts from {CHECK} (1. A column vector of time), which is not right yet.")
    jupyter.add(CHECK, "skip", f'check.skip("{CHECK}")')
    assert jupyter.run("skip").endswith("skipped. It earns no marks. The notebook now has the reference's `t`.")
    assert jupyter.answer("prelab-2-noise", noise).startswith("✓ prelab-2-noise")
    assert jupyter.run(CHECK).startswith(f"– {NAME}: you went on from the reference's value. It earns no marks.")
    shown = [line.split()[:5] for line in jupyter.run("prelab-summary").splitlines()]
    assert shown[1:4] == [
        ["–", CHECK, "0", "of", "0.1"],
        ["✓", "prelab-2-noise", "0.25", "of", "0.25"],
        ["·", "prelab-3-cut", "0", "of", "0.15"],
    ]
    assert shown[-1] == ["Total:", "0.25", "of", "1", "marks;"]


def test_run_all_of_a_half_done_notebook_reaches_the_end(released: Course, solve, tmp_path: Path) -> None:
    """As Jupyter does: it goes on after a cell with the tag that the build puts on every cell of a release."""
    path = solve(
        "lab-identification",
        lab_1c_offsets_answer=None,
        lab_2a_phi_answer="Phi = Ph",
        lab_2b_theta_answer=None,
        lab_3a_all_answer=None,
    )
    notebook = nbformat.read(path, as_version=4)
    notebook.cells.insert(0, nbformat.v4.new_code_cell("own = 1"))
    place = next(i for i, cell in enumerate(notebook.cells) if cell.id == "lab-2a-phi") + 1
    notebook.cells.insert(place, nbformat.v4.new_code_cell('check.skip("lab-2a-phi")'))
    nbformat.write(notebook, path)
    NotebookClient(notebook, kernel_name="python3", resources={"metadata": {"path": str(path.parent)}}).execute()
    assert all(cell.execution_count for cell in notebook.cells if cell.cell_type == "code")
    (shown,) = notebook.cells[-1].outputs
    text = json.dumps(shown.data, ensure_ascii=False)
    assert "<table>" in shown.data["text/html"]
    lines = {line.split()[1]: line.split()[0] for line in shown.data["text/plain"].splitlines() if line[:2] == "  "}
    assert lines["lab-1a-extract"] == lines["lab-1c-loop"] == "✓"
    assert lines["lab-1c-offsets"] == lines["lab-2a-phi"] == "–"
    assert lines["lab-2b-theta"] in "✗·"
    assert "marks; 0.1 of them are given by hand" in text


def test_every_code_cell_of_a_release_lets_run_all_go_on(released: Course) -> None:
    for name in released.assignments():
        release, source = (
            nbformat.read(folder / name / f"{name}.ipynb", as_version=4)
            for folder in (released.release, released.source)
        )
        assert all("raises-exception" in cell.metadata.tags for cell in release.cells if cell.cell_type == "code")
        assert not any("raises-exception" in cell.metadata.get("tags", ()) for cell in source.cells)
        assert release.cells[-1].source == "check.summary()"


def test_marks_stand_at_each_question(released: Course) -> None:
    for name in released.assignments():
        cells = nbformat.read(released.release / name / f"{name}.ipynb", as_version=4).cells
        for above, cell in pairwise(cells):
            meta = cell.metadata.get("nbgrader", {})
            if meta.get("grade") and meta["solution"]:
                assert above.source.endswith(f"\n\n*({meta['points']:g} marks, marked by hand)*")
            elif meta.get("grade"):
                assert cell.source.removesuffix(" ✎") == f'check("{cell.id}")  # {meta["points"]:g} marks'
