"""Model solutions for students: after the due date, on each one's own record, and nothing of one to another."""

import zipfile
from datetime import UTC, datetime, timedelta
from pathlib import Path

import nbformat
import pytest

from autograder.course.layout import Course
from autograder.export.solution_notebooks import solution_page, solve
from autograder.export.solutions import plan_solutions, require_closed, write_solutions
from autograder.intake.worksheet import Worksheet, read_worksheet
from autograder.results.extensions import Extension, closed_assignments
from labsid.cli.commands import main

PRELAB, LAB = "prelab-sinusoids", "lab-identification"
NOW = datetime(2026, 12, 1, tzinfo=UTC)
HOUR = timedelta(hours=1)
SECRET = "0123456789abcdef0123456789abcdef\n"


def test_a_solution_is_run_and_has_nothing_of_grading(course: Course) -> None:
    solved = solve(course, PRELAB, None)
    text = nbformat.writes(solved)
    assert "### BEGIN" not in text
    assert "nbgrader" not in {key for cell in solved.cells for key in cell.metadata}
    outputs = [output for cell in solved.cells for output in cell.get("outputs", ())]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    page = solution_page(solved, "Pre-<lab>", "Course & more")
    assert "Course &amp; more · Pre-&lt;lab&gt; · model solution" in page
    assert "<h2>" in page
    assert "<math" in page
    assert 'src="data:image/png;base64,' in page
    assert "✓" in page
    assert "<script" not in page
    assert "http" not in page.replace("http://www.w3.org", "")


def test_a_solution_that_stops_is_said(course: Course, tmp_path: Path) -> None:
    broken = Course(tmp_path)
    target = broken.source / PRELAB / f"{PRELAB}.ipynb"
    target.parent.mkdir(parents=True)
    notebook = nbformat.read(course.source / PRELAB / f"{PRELAB}.ipynb", as_version=4)
    notebook.cells.insert(0, nbformat.v4.new_code_cell("nosuch + 1"))
    nbformat.write(notebook, target)
    with pytest.raises(ValueError, match=f"the model solution of {PRELAB} stops: NameError: name 'nosuch'"):
        solve(broken, PRELAB, None)
    with pytest.raises(ValueError, match=r"has not been built .* labsid course build"):
        solve(broken, LAB, None)


def test_solutions_are_individual_only_with_a_secret() -> None:
    shared = plan_solutions([PRELAB, LAB], None)
    assert (shared.shared, shared.individual, shared.students) == ((PRELAB, LAB), (), ())
    own = plan_solutions([PRELAB, LAB], ["z1", "z2"])
    assert (own.shared, own.individual, own.students) == ((PRELAB,), (LAB,), ("z1", "z2"))
    assert plan_solutions([PRELAB], ["z1"]).students == ()


def test_nothing_is_given_out_while_somebody_works_on_it() -> None:
    due = {PRELAB: NOW - HOUR, LAB: NOW + HOUR}
    running = {("z1", PRELAB): Extension(NOW + HOUR, "1 December")}
    assert closed_assignments(due, {}, NOW) == {PRELAB}
    assert closed_assignments(due, running, NOW) == set()
    assert closed_assignments(due, running, NOW + HOUR) == {PRELAB, LAB}
    require_closed([PRELAB, "other"], due, {}, NOW)
    with pytest.raises(ValueError, match=f"{LAB} is not due yet"):
        require_closed([PRELAB, LAB], due, {}, NOW)
    with pytest.raises(ValueError, match=rf"{PRELAB}: extensions still run: z1 \(1 December\)"):
        require_closed([PRELAB], due, running, NOW)


@pytest.fixture
def sheet(tmp_path: Path) -> Worksheet:
    rows = ("Participant 7,Jürgen Öz,z1", "Participant 8,Li Mei,z2", "Participant 9,A Guest,z9")
    (tmp_path / "sheet.csv").write_text("\n".join(["Identifier,Full name,ID number", *rows]), encoding="utf-8")
    return read_worksheet(tmp_path / "sheet.csv")


def test_each_students_solutions_are_apart(tmp_path: Path, sheet: Worksheet) -> None:
    out = tmp_path / "solutions.zip"
    files = {"": {"a/a.html": b"all"}, "z1": {"b/b.html": b"one"}, "z2": {"b/b.html": b"two"}}
    assert write_solutions(out, files, None, str) == [out, tmp_path / "solutions-packages"]
    with zipfile.ZipFile(out) as archive:
        assert archive.namelist() == ["a/a.html"]
    for student, content in (("z1", b"one"), ("z2", b"two")):
        with zipfile.ZipFile(tmp_path / "solutions-packages" / f"{student}.zip") as archive:
            assert archive.namelist() == ["b/b.html"]
            assert archive.read("b/b.html") == content
    ids = {"7": "z1", "8": "z2", "9": "z9"}
    del files[""]
    assert write_solutions(tmp_path / "m.zip", files, sheet, ids.__getitem__) == [tmp_path / "m-packages.zip"]
    assert not (tmp_path / "m.zip").exists()
    with zipfile.ZipFile(tmp_path / "m-packages.zip") as archive:
        folders = ("Jürgen Öz_7_assignsubmission_file_", "Li Mei_8_assignsubmission_file_")
        assert archive.namelist() == [f"{folder}/my-solutions.zip" for folder in folders]


def test_the_command_gives_out_what_is_due(
    course: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("notebooks", "autograder", "data"):
        (tmp_path / name).symlink_to(course.root / name)
    (tmp_path / "secret").write_text(SECRET, encoding="utf-8")
    (tmp_path / "class.csv").write_text("z1\nz2\n", encoding="utf-8")
    settings = f'secret = "secret"\nstudents = "class.csv"\n[assignments.{LAB}]\ndue = 2026-01-01T00:00:00\n'
    (tmp_path / "course.toml").write_text(settings + f"[assignments.{PRELAB}]\ndue = 2999-01-01T00:00:00\n")
    monkeypatch.chdir(tmp_path)
    made: list[tuple[str, str]] = []

    def solved(_: Course, name: str, record: bytes | None) -> object:
        made.append((name, "" if record is None else str(hash(record))))
        if len(made) == 2:
            raise ValueError("it stops.")
        return nbformat.v4.new_notebook(cells=[nbformat.v4.new_markdown_cell(f"# {len(made)}")])

    monkeypatch.setattr("autograder.export.solutions.solve", solved)
    assert main(["course", "solutions", "--out", "s.zip", "--jobs", "1"]) == 0
    captured = capsys.readouterr()
    assert [name for name, _ in made] == [LAB, LAB]
    assert made[0] != made[1]
    assert captured.err == f"{LAB} of z2: it stops.\n"
    assert captured.out.startswith(f"Wrote s-packages: {LAB}. Give nobody the solutions of another")
    assert [path.name for path in Path("s-packages").iterdir()] == ["z1.zip"]
    assert not Path("s.zip").exists()
    assert main(["course", "solutions", "--out", "s.zip", "--assignment", PRELAB]) == 2
    assert f"{PRELAB} is not due yet" in capsys.readouterr().err
    assert main(["course", "solutions", "--out", "s.zip", "--assignment", PRELAB, "--early"]) == 0
    assert capsys.readouterr().out == f"Wrote s.zip: {PRELAB}.\n"
    Path("course.toml").write_text("", encoding="utf-8")
    assert main(["course", "solutions", "--out", "x.zip"]) == 2
    assert "no due date in course.toml has passed for everybody" in capsys.readouterr().err
