"""The demonstration: build the course, grade sample submissions, identify the lab's record and draw its figures."""

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from autograder.batch.executors import open_executor
from autograder.batch.grade import grade_batch
from autograder.batch.selection import Batch, find_batch
from autograder.course.build import build_course
from autograder.course.layout import Course, find_course
from autograder.course.settings import read_settings
from autograder.export.grades_csv import export_csv
from autograder.feedback_texts import make_feedback_texts
from autograder.results.feedback import write_feedback
from autograder.results.report import write_report
from autograder.results.summary import class_table
from autograder.samples import LAB, write_samples

Progress = Callable[..., Iterator[Any]]
_MARK = ".labsid-demo"


def run_demo(out: Path, progress: Progress) -> None:
    """Run the demonstration and print where its output is.

    Parameters
    ----------
    out : Path
        Output folder; replaced if an earlier demonstration made it.
    progress : callable
        ``progress(items, total, what)`` yields the items with a progress bar.

    Raises
    ------
    ValueError
        If `out` has other content, or the course is not found.
    """
    course = find_course()
    if course.remark:
        print(course.remark)
    _clear(out)
    names = list(progress(build_course(course), len(course.assignments()), "building the course"))
    print(f"1. Built {len(names)} assignments: {', '.join(names)}.")
    students = write_samples(course, out / "submitted")
    submitted, graded = out / "submitted", out / "graded"
    lab = find_batch(course, submitted, LAB)
    rest = Batch(submitted, ("ada",), tuple(name for name in names if name != LAB))
    with open_executor("best", 2, None, print) as executor:
        done = (result for batch in (lab, rest) for result in grade_batch(course, batch, graded, executor))
        list(progress(done, len(students) + len(rest.assignments), "grading"))
    print(f"2. Graded {len(students)} sample students (isolation: {executor.level}).\n")
    print(class_table(graded))
    print()
    for student, description in students.items():
        print(f"   {student}: {description}")
    texts = make_feedback_texts(course, read_settings(course), graded)
    pages = list(progress(write_feedback(graded, texts), None, "feedback"))
    export_csv(graded)
    report = write_report(graded, texts)
    print(f"\n3. Wrote {len(pages)} feedback pages, the class report and the exports.")
    print("4. Identified the lab's record:\n")
    print(_identify(course, out))
    figures = list(progress(draw_figures(course, out / "figures"), None, "drawing"))
    print(f"5. Drew {len(figures)} figures.\n")
    print("Output:")
    for path, description in (
        (graded / "feedback" / "ben" / "lab-identification.html", "feedback on a submission with common mistakes"),
        (report, "class report: most costly questions and mistakes, submissions to review"),
        (graded / "grades.csv", "marks of every question and student"),
        (out / "figures" / "figure-7.png", "simulation of the identified model and measured output"),
        (out / "identification.json", "parameters, poles and errors of the model"),
        (course.release, "student release; open it with: labsid lab"),
    ):
        print(f"   {path}  {description}")


def draw_figures(course: Course, folder: Path) -> Iterator[Path]:
    """Draw the lab's figures from its record as PNG files; yields each path."""
    import numpy as np

    from labsid import plots
    from labsid.lab.arx import fit_arx
    from labsid.lab.offset import find_offsets, remove_offsets
    from labsid.lab.sinusoid import make_sinusoids
    from labsid.lab.step_comparison import compare_with_approximation, second_order_example
    from labsid.lab.verification import verify
    from labsid.records.record import load_record

    record = load_record(course.record)
    u, y = remove_offsets(record.u, record.y, find_offsets(record.u, record.y))
    half = len(y) // 2
    models = [fit_arx(u, y, record.Ts, order=order, stop=half).model for order in (1, 2)]
    first, second = (verify(model, u, y) for model in models)
    comparison = compare_with_approximation(second_order_example(), np.arange(0, 30.025, 0.025), 2.0)
    figures = {
        "figure-1": plots.figure_1(make_sinusoids(np.random.default_rng(1))),
        "figure-2": plots.figure_2(),
        "figure-3": plots.figure_3(),
        "figure-4": plots.figure_4(),
        "figure-5": plots.figure_5(record),
        "figure-6": plots.figure_6(record.t, y, u),
        "figure-7": plots.figure_7(record.t, y, second),
        "figure-7-initial-state": plots.figure_7_initial_state(record.t, y, second),
        "figure-8": plots.figure_8(record.t, y, first.y_all, second.y_all, first.mse_all, second.mse_all),
        "figure-a1": plots.figure_a1(comparison.t, comparison.y_original, comparison.fit),
        "figure-a2": plots.figure_a2(comparison),
    }
    folder.mkdir(parents=True, exist_ok=True)
    for name, figure in figures.items():
        path = folder / f"{name}.png"
        plots.save_png(figure, path)
        yield path


def _identify(course: Course, out: Path) -> str:
    from labsid._files import write_json
    from labsid.cli.console import identification_text
    from labsid.lab.identification import identify, to_json_dict
    from labsid.records.record import load_record

    found = identify(load_record(course.record), order=2, start=2)
    write_json(out / "identification.json", to_json_dict(found))
    return identification_text(found)


def _clear(out: Path) -> None:
    """Make an empty folder; refuse to delete anything that this command did not make."""
    if out.exists():
        if not (out / _MARK).is_file():
            raise ValueError(f"{out} exists and was not made by this command. Give --out another name.")
        shutil.rmtree(out)
    out.mkdir(parents=True)
    (out / _MARK).touch()
