"""A course with its own rig: texts, records, grading, and that the course of the tanks does not change."""

import re
import shutil
import zipfile
from collections.abc import Callable
from decimal import Decimal
from functools import cache
from pathlib import Path

import jupytext
import nbformat
import numpy as np
import pytest
from course_work import GradeCode, copy_course
from own_rigs import MOTOR, OF_THE_HEATER, OF_THE_MOTOR, OF_THE_TANKS, motor_log, rig_course, write_csv

from autograder.course.build import build_course, build_source
from autograder.course.individual_data import individual_file
from autograder.course.layout import RECORD_FILE, Course
from autograder.course.own_rig import OwnRig, Quantity, read_rig_log
from autograder.course.own_secret import shared_file
from autograder.course.release import write_individual_release, write_release
from autograder.course.rig_findings import about_rig
from autograder.course.rig_texts import PASSAGES_FILE, read_for_rig, rig_words
from autograder.course.settings import read_settings
from autograder.sandbox.isolation import open_launcher
from labsid.checks.cells import read_cell
from labsid.lab.identification import identify
from labsid.records.reading import Reading
from labsid.records.record import load_record

ROOT = Path(__file__).resolve().parents[3]
LAB, POSTLAB, STEP = "lab-identification", "postlab-model-order", "step-response"
SECRET = b"the course's secret, of more than 16 bytes"
WITH_PASSAGES = sorted(path.parent.name for path in (ROOT / "notebooks").glob(f"*/{PASSAGES_FILE}"))
CASES = [
    *((rig, LAB) for rig in ("motor", "dc-motor", "heater")),
    *(("dc-motor", POSTLAB), ("heater", STEP)),
    *(pytest.param("tanks", name, marks=pytest.mark.exhaustive) for name in (LAB, POSTLAB, STEP)),
    *(pytest.param(rig, name, marks=pytest.mark.exhaustive) for rig, name in (("heater", POSTLAB), ("dc-motor", STEP))),
]

PNG = bytes.fromhex(
    "89504e470d0a1a0a0000000d49484452000000010000000108060000001f15c4890000000d49444154789c6360606060000000050001"
    "a5f645400000000049454e44ae426082"
)

SLIPS = {
    "lab-1c-offsets": (
        "mean over the whole record",
        "y_offset, u_offset = np.mean(y_act), u_act[0]\ny, u = y_act - y_offset, u_act - u_offset",
    ),
    "lab-2a-phi": (
        "fit on all the data",
        "half = len(y) // 2\nPhi, Y = np.column_stack([y[1:-1], y[:-2], u[1:-1], u[:-2]]), y[2:]",
    ),
    "lab-2b-parameters": ("sign of a", "a1, a2, b1, b2 = theta_hat"),
    "lab-3a-second-half": ("state carried over", "y_sim_half = ct.forced_response(G, inputs=u).outputs[half:]"),
    "lab-3a-all": (
        "one-step prediction",
        "y_sim = np.r_[y[:2], np.column_stack([y[1:-1], y[:-2], u[1:-1], u[:-2]]) @ theta_hat]",
    ),
}


@pytest.fixture(scope="module")
def course_of(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Callable[[str], Course]:
    """The built course of a rig: the lab, the post-lab and the step response."""

    @cache
    def made(rig: str) -> Course:
        folder = tmp_path_factory.mktemp(rig)
        if rig == "motor":
            record, description = write_csv(folder / "motor.csv", motor_log()), OF_THE_MOTOR
        elif rig == "tanks":
            record, description = ROOT / "data" / RECORD_FILE, OF_THE_TANKS
        elif rig == "dc-motor":
            record = request.getfixturevalue("shared_data") / "real-rigs" / "dc-motor.csv"
            description = OF_THE_MOTOR + "reading = { from = 7.2 }\n"
        else:
            record = request.getfixturevalue("shared_data") / "several-signals" / "tclab-step.csv"
            description = OF_THE_HEATER
        return rig_course(folder / "course", record, description, LAB, POSTLAB, STEP)

    return made


@pytest.mark.parametrize(("rig", "name"), CASES)
def test_solutions_have_all_marks_and_untouched_notebooks_none(
    rig: str, name: str, course_of: Callable[[str], Course]
) -> None:
    course = course_of(rig)
    with open_launcher("none") as launcher:
        grade = GradeCode(course, launcher)
        solved = grade(name, {})
        release = nbformat.read(course.release / name / f"{name}.ipynb", as_version=4)
        cells = [cell for cell in map(read_cell, release.cells) if cell is not None and cell.kind == "answer"]
        untouched = grade(name, {cell.id: cell.source for cell in cells})
    assert [one.question for one in solved.values() if one.score not in (None, one.max_score)] == []
    assert sum((one.score or Decimal(0) for one in untouched.values()), Decimal(0)) == 0


@pytest.mark.parametrize("rig", ["motor", "dc-motor", "heater", pytest.param("tanks", marks=pytest.mark.exhaustive)])
def test_slips_are_named_as_on_the_tanks(rig: str, course_of: Callable[[str], Course]) -> None:
    with open_launcher("none") as launcher:
        graded = GradeCode(course_of(rig), launcher)(LAB, {f"{one}-answer": code for one, (_, code) in SLIPS.items()})
    lost = {one.question: one.slip for one in graded.values() if one.score not in (None, one.max_score)}
    assert lost == {question: slip for question, (slip, _) in SLIPS.items()}


def test_labels_and_messages_have_the_units_of_the_rig(course_of: Callable[[str], Course]) -> None:
    in_volts = (
        "fig_6, (ax_a, ax_b) = plt.subplots(2, 1)\nax_a.plot(t, y)\nax_b.step(t, u)\n"
        "ax_a.set(ylabel='Output (V)')\nax_b.set(ylabel='Input (V)', xlabel='Time (s)')"
    )
    with open_launcher("none") as launcher:
        graded = GradeCode(course_of("motor"), launcher)(LAB, {"lab-1c-figure-6-answer": in_volts})
    assert graded["lab-1c-figure-6"].score == 0
    assert "'Output (V)' has another unit than the signal: write it as (rpm)" in graded["lab-1c-figure-6"].reason


def test_a_value_that_is_typed_in_fails_on_the_hidden_record(course_of: Callable[[str], Course]) -> None:
    course = course_of("motor")
    found = identify(load_record(shared_file(course, RECORD_FILE)))
    typed = f"theta_hat = np.array({found.fit.theta.tolist()})"
    with open_launcher("none") as launcher:
        graded = GradeCode(course, launcher)(LAB, {"lab-2b-theta-answer": typed})
    assert graded["lab-2b-theta"].score == 0
    assert "fits your record only" in graded["lab-2b-theta"].reason


@pytest.mark.parametrize("name", [LAB, POSTLAB])
def test_the_texts_are_about_the_rig(name: str, course_of: Callable[[str], Course]) -> None:
    source = nbformat.read(course_of("motor").source / name / f"{name}.ipynb", as_version=4)
    text = "\n".join(cell.source for cell in source.cells)
    left = [line for line in text.splitlines() if re.search(r"tank|pump|level sensor|\bvolts?\b|\{\{", line)]
    said = (
        "simulated water tanks, in volts",
        "on another rig, in volts",
        "of water tanks.)",
        "with the water tanks is left",
    )
    assert [line for line in left if not any(one in line for one in said)] == []
    assert "rpm" in text
    assert "Output (V)" not in text


def test_the_numbers_in_the_texts_are_those_of_the_record(course_of: Callable[[str], Course]) -> None:
    course = course_of("motor")
    model = identify(load_record(shared_file(course, RECORD_FILE))).model
    source = nbformat.read(course.source / LAB / f"{LAB}.ipynb", as_version=4)
    text = " ".join(" ".join(cell.source for cell in source.cells).split())
    assert f"an input of about {model.u_offset:g} V holds the output at about {model.y_offset:.4g} rpm" in text
    slowest = max(abs(model.poles))
    assert f"The longest time constant, about {-model.Ts / np.log(slowest):.2g} s" in text
    assert "clip(kp * error + integral + u_offset, 2, 6.5)" in text


def test_a_simulated_record_is_called_so(course_of: Callable[[str], Course]) -> None:
    said = "The course's record is simulated with a model that was identified from a log of this rig."
    for rig, is_said in (("heater", True), ("motor", False)):
        source = nbformat.read(course_of(rig).source / LAB / f"{LAB}.ipynb", as_version=4)
        assert any(said in cell.source for cell in source.cells) == is_said


def test_a_picture_is_shown_where_the_rig_is_described(tmp_path: Path) -> None:
    (tmp_path / "rig.png").write_bytes(PNG)
    record = write_csv(tmp_path / "motor.csv", motor_log())
    picture = f'picture = "{(tmp_path / "rig.png").as_posix()}"\n'
    course = rig_course(tmp_path / "course", record, OF_THE_MOTOR + picture, LAB)
    notebook = nbformat.read(course.release / LAB / f"{LAB}.ipynb", as_version=4)
    nbformat.validate(notebook)
    (shown,) = (cell for cell in notebook.cells if cell.get("attachments"))
    assert "A bridge drives a motor" in shown.source
    assert "![the motor](attachment:rig.png)" in shown.source
    assert [*shown.attachments["rig.png"]] == ["image/png"]


def test_the_course_of_the_tanks_is_as_its_texts_are(tmp_path: Path) -> None:
    """Whatever the passages for other rigs are, the release of the tanks is that of the text notebooks alone."""
    course = copy_course(tmp_path / "course", *WITH_PASSAGES)
    (course.root / "course.toml").write_text('title = "Identification"\n', encoding="utf-8")
    list(build_course(course))
    with_passages = {path.name: path.read_bytes() for path in course.release.rglob("*") if path.is_file()}
    bare = copy_course(tmp_path / "bare", *WITH_PASSAGES)
    for path in bare.notebooks.glob(f"*/{PASSAGES_FILE}"):
        path.unlink()
    (bare.root / "course.toml").write_text('title = "Identification"\n', encoding="utf-8")
    list(build_course(bare))
    assert {path.name: path.read_bytes() for path in bare.release.rglob("*") if path.is_file()} == with_passages
    assert with_passages[RECORD_FILE] == (ROOT / "data" / RECORD_FILE).read_bytes()
    for name in WITH_PASSAGES:
        text = jupytext.read(ROOT / "notebooks" / name / f"{name}.md", fmt="md:myst")
        built = build_source(ROOT / "notebooks" / name / f"{name}.md")
        assert [cell.cell_type for cell in built.cells] == [cell.cell_type for cell in text.cells]
        assert all(ours.source.startswith(theirs.source) for ours, theirs in zip(built.cells, text.cells, strict=True))


@pytest.mark.parametrize("name", WITH_PASSAGES)
def test_every_passage_is_in_its_notebook_and_has_known_words(name: str, tmp_path: Path) -> None:
    rig = OwnRig(
        write_csv(tmp_path / "motor.csv", motor_log()),
        "the motor",
        "A bridge drives it.",
        Quantity("voltage", "V"),
        Quantity("speed", "m/s"),
    )
    words = rig_words(rig)
    assert (words.values["output.unit^2"], words.values["gain.unit"]) == ("(m/s)^2", "(m/s)/V")
    notebook = read_for_rig(ROOT / "notebooks" / name / f"{name}.md", words)
    assert "{{" not in "".join(re.findall(r"\{\{[a-z.]+\}\}", "".join(cell.source for cell in notebook.cells)))


def test_a_passage_that_the_notebook_does_not_say_is_named(tmp_path: Path) -> None:
    words = rig_words(
        OwnRig(write_csv(tmp_path / "m.csv", motor_log()), "it", "It.", Quantity("u", "V"), Quantity("y", "V"))
    )
    text = tmp_path / "one.md"
    text.write_text("A tank\nis here.\n", encoding="utf-8")

    def told(passages: str) -> str:
        (tmp_path / PASSAGES_FILE).write_text(passages, encoding="utf-8")
        with pytest.raises(ValueError, match=PASSAGES_FILE) as refused:
            read_for_rig(text, words)
        return str(refused.value)

    assert "does not say 'no tank'" in told('[[passage]]\ntanks = "no\\ntank"\nrig = ""')
    assert "'u.hig' in double braces is not known" in told('[[passage]]\ntanks = "tank is"\nrig = "{{u.hig}}"')
    assert "there is no cell 'two'" in told('left-out = ["two"]')


def test_a_record_that_does_not_carry_the_lab_is_not_built(tmp_path: Path) -> None:
    log = motor_log()
    path = tmp_path / "one-step.csv"
    np.savetxt(path, np.column_stack([log.t, log.u, log.y_measured])[:240], delimiter=",", header="t,u,y", comments="")
    with pytest.raises(ValueError, match=r"one-step.csv carries the lab: no, because of steps"):
        rig_course(tmp_path / "course", path, OF_THE_MOTOR, LAB)


def test_a_log_with_one_output_gets_the_noise_reduction_of_the_lab(tmp_path: Path) -> None:
    path = write_csv(tmp_path / "motor.csv", motor_log())
    log = read_rig_log(path, Reading(), ("V", "rpm"))
    assert np.allclose(log.y_noise_reduced[4:], np.convolve(log.y_measured, np.ones(5) / 5, "valid"))
    assert log.units == ("V", "rpm")
    whole = read_rig_log(ROOT / "data" / RECORD_FILE, Reading())
    assert np.array_equal(whole.y_noise_reduced, load_record(ROOT / "data" / RECORD_FILE).y)


def test_individual_records_are_of_rigs_like_the_measured_one(tmp_path: Path) -> None:
    rig = OwnRig(write_csv(tmp_path / "motor.csv", motor_log()), "it", "It.", Quantity("u", "V"), Quantity("y", "rpm"))
    seen = []
    for student in ("ann", "bob", "cat", "dan"):
        content = individual_file(RECORD_FILE, student, SECRET, rig)
        assert individual_file(RECORD_FILE, student, SECRET, rig) == content
        path = tmp_path / RECORD_FILE
        path.write_bytes(content)
        record = load_record(path)
        found = identify(record)
        assert record.units == ("V", "rpm")
        assert len(record) == len(motor_log().u)
        assert record.u.min() >= 2.0
        assert record.u.max() <= 6.5
        assert not [
            one for one in about_rig(record) if one.level == "refused" or (one.topic == "rest" and one.level != "ok")
        ]
        gain = float(np.sum(found.model.b) / np.sum(found.model.a))
        assert abs(gain / MOTOR.gain - 1) < 0.15
        seen.append((round(gain, 2), found.model.y_offset))
    assert len(set(seen)) == 4


def test_packages_of_students_have_their_own_records(course_of: Callable[[str], Course], tmp_path: Path) -> None:
    course = course_of("motor")
    shutil.copyfile(ROOT / "pyproject.toml", course.root / "pyproject.toml")
    done = write_individual_release(course, tmp_path / "all.zip", SECRET, ["ann", "bob"], [LAB])
    assert done.students == 2
    rig = read_settings(course).rig
    assert rig is not None
    with zipfile.ZipFile(tmp_path / "all-packages" / "ann.zip") as package:
        assert package.read(f"{LAB}/{RECORD_FILE}") == individual_file(RECORD_FILE, "ann", SECRET, rig)
    assert f"{LAB}/{RECORD_FILE}" in write_release(course, tmp_path / "shared.zip", [LAB])
