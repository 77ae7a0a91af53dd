"""A student and an instructor in a real browser, and every kind of page at the width of a screen and of a telephone."""

import csv
import io
import json
import os
import re
import sys
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import urljoin

import pytest
from gap_reports import report, with_experiment, with_holdout, with_rest
from representatives import mostly_exhaustive
from signals_reports import signals_report, with_planned_inputs

from autograder.course.layout import Course
from browser.conftest import LAB, PRELAB, Instructor, Student
from browser.processes import served, wait_until_reachable
from labsid.gap.batches.batch_page import write_batch_page
from labsid.gap.reports.html_report import write_html_report

if TYPE_CHECKING:
    from playwright.sync_api import BrowserContext

pytestmark = pytest.mark.skipif(os.name != "posix", reason="servers are ended by signals")


def test_a_student_works_in_jupyterlab_and_submits(
    context: "BrowserContext", jupyterlab: str, student: Student
) -> None:
    from playwright.sync_api import expect

    from browser.accessibility import problems
    from browser.notebook_page import OWN_PARTS, NotebookPage

    page = context.new_page()
    page.goto(jupyterlab)
    work = NotebookPage(page)
    work.hide_files()
    work.wait_until_open("System identification: start here", "show_progress()")
    work.run_first()
    expect(work.notebook).to_contain_text("not begun")
    found = problems(page, "start-page", OWN_PARTS)
    work.notebook.get_by_role("link", name="Pre-lab: two noisy sinusoids").click()
    work.wait_until_open("1. A column vector of time")
    work.run_first()
    work.answer("prelab-1-time", "t = np.linspace(0, 100, 1001)", "✗ prelab-1-time")
    expect(work.check_cell("prelab-1-time")).to_contain_text("run check.hint()")
    work.answer("prelab-1-time", "t = np.linspace(0, 100, 1001).reshape(-1, 1)", "✓ prelab-1-time")
    skipped = work.add_below("prelab-2-noise", 'check.skip("prelab-2-noise")')
    expect(skipped).to_contain_text("skipped. It earns no marks. The notebook now has the reference's `y1`, `y2`.")
    cut = "t_new, y1_new, y2_new = t[200:] - t[200], y1[200:], y2[200:]"
    work.answer("prelab-3-cut", cut, "✓ prelab-3-cut")
    summary = work.restart_and_run_all()
    expect(summary).to_contain_text("Total0.25 of 1 marks; 0.05 of them are given by hand")
    for question, state in {"1-time": "right", "2-noise": "skipped", "3-cut": "right", "4-matrix": "not done"}.items():
        row = summary.get_by_role("row").filter(has_text=f"prelab-{question}")
        expect(row.get_by_role("cell").last).to_have_text(state)
    work.save()
    found += problems(page, "notebook-prelab", OWN_PARTS)
    page.close()
    assert not found, "\n".join(found)

    said = student.labsid("submit", "--assignment", PRELAB)
    assert "questions are not right or not done. hand-in.zip was not written" in said
    said = student.labsid("submit", "--assignment", PRELAB, "--yes")
    assert f"{PRELAB}, run from a clean start:" in said
    for line in ("✓ prelab-1-time", "– prelab-2-noise"):
        assert line in said
    assert "Total: 0.25 of 1 marks" in said
    assert said.splitlines()[-1] == f"Hand in this file: hand-in.zip ({PRELAB})"
    with zipfile.ZipFile(student.home / "hand-in.zip") as archive:
        assert f"{PRELAB}.ipynb" in {Path(name).name for name in archive.namelist()}


@pytest.mark.exhaustive  # above, a notebook without a record; `test_predictions.py` opens this one, with its figures
def test_a_student_works_on_a_record_in_jupyterlab(
    context: "BrowserContext", jupyterlab: str, student: Student
) -> None:
    from playwright.sync_api import expect

    from browser.accessibility import problems
    from browser.notebook_page import OWN_PARTS, NotebookPage

    page = context.new_page()
    page.goto(jupyterlab)
    work = NotebookPage(page)
    work.hide_files()
    work.wait_until_open("System identification: start here", "show_progress()")
    work.notebook.get_by_role("link", name="Lab: identify a second-order model").click()
    work.wait_until_open("1a. Load the record")
    work.run_first(3)
    signals = 't, u_act, y = (LogData["time"], LogData["signals"][1]["values"], LogData["signals"][0]["values"])\n'
    swapped, right = "y_act, y_actm = y[:, 0], y[:, 1]", "y_act, y_actm = y[:, 1], y[:, 0]"
    work.answer("lab-1a-extract", signals + swapped, "✗ lab-1a-extract")
    work.answer("lab-1a-extract", signals + right, "✓ lab-1a-extract")
    work.answer("lab-1a-sampling-time", "Ts = t[1] - t[0]", "✓ lab-1a-sampling-time")
    skipped = work.add_below("lab-2b-theta", 'check.skip("lab-2b-theta")')
    expect(skipped).to_contain_text("The notebook now has the reference's `theta_hat` on your record.")
    work.answer("lab-2b-parameters", "a1, a2 = -theta_hat[:2]\nb1, b2 = theta_hat[2:]", "✓ lab-2b-parameters")
    summary = work.restart_and_run_all()
    expect(summary).to_contain_text("Total0.25 of 2 marks")
    work.save()
    found = problems(page, "notebook-lab", OWN_PARTS)
    page.close()
    assert not found, "\n".join(found)

    said = student.labsid("submit", "--assignment", LAB, "--yes")
    for line in ("✓ lab-1a-extract", "✓ lab-2b-parameters"):
        assert line in said
    assert said.splitlines()[-1] == f"Hand in this file: hand-in.zip ({LAB})"


def hand_ins(course: Course) -> bytes:
    """Moodle's zip file: Ann has solved both notebooks but one function, Bob the pre-lab."""
    texts = {
        "Ann Öz_101": "The sine starts at $\\sin(0.4\\pi) = 0.95$.\n\n- because *20 s* are cut off",
        "Bob Ek_102": "It starts elsewhere.",
    }
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for owner, text in texts.items():
            wrong = "def cut_off(data, n):\n    return data[n:]"
            replaced = {"prelab-6-clock": text, "prelab-4-function-answer": wrong}
            for name in (PRELAB, LAB) if owner.startswith("Ann") else (PRELAB,):
                notebook = json.loads((course.source / name / f"{name}.ipynb").read_text(encoding="utf-8"))
                for cell in notebook["cells"]:
                    cell["source"] = replaced.get(cell["id"], cell["source"])
                archive.writestr(f"{owner}_assignsubmission_file_/{name}.ipynb", json.dumps(notebook))
    return packed.getvalue()


WORKSHEET = """\
Identifier,Full name,Email address,ID number,Status,Grade,Maximum Grade,Last modified (submission),Feedback comments
Participant 101,Ann Öz,ann@x.edu,ann,Submitted for grading,,1.00,"Friday, 20 November 2026, 10:00 AM",
Participant 102,Bob Ek,bob@x.edu,bob,Submitted for grading,,1.00,"Friday, 20 November 2026, 10:00 AM",
Participant 103,Cat Ny,cat@x.edu,cat,No submission,,1.00,-,
"""


def test_an_instructor_grades_marks_and_exports(context: "BrowserContext", instructor: Instructor) -> None:
    from playwright.sync_api import expect

    from browser.accessibility import PICTURES, problems

    home = instructor.home
    (home / "moodle.zip").write_bytes(hand_ins(instructor.course))
    (home / "worksheet.csv").write_text(WORKSHEET, encoding="utf-8-sig")
    said = instructor.labsid("course", "collect", "moodle.zip", "--out", "in", "--worksheet", "worksheet.csv")
    assert f"{PRELAB} 2, {LAB} 1" in said
    grade = ["course", "grade", "--submitted", "in", "--out", "OUT", "--assignment", PRELAB, "--assignment", LAB]
    assert "4 submissions graded" in instructor.labsid(*grade)

    found = []
    page = context.new_page()
    mark = [*instructor.command, "course", "mark", "--out", "OUT", "--no-open", "--marker", "Eve"]
    with served(mark, home, instructor.environment, r"http://127\.0\.0\.1:\d+/[\w-]+/") as address:
        page.goto(address)
        found += problems(page, "open-questions")
        page.keyboard.press("Tab")
        page.keyboard.press("Enter")
        answers = page.get_by_role("article")
        expect(answers).to_have_count(2)
        expect(answers.first).to_be_focused()
        found += problems(page, "mark")
        page.keyboard.press("p")
        page.keyboard.insert_text("0.03")
        page.keyboard.press("Enter")
        expect(answers.first).to_contain_text("marked by Eve")
        expect(answers.last).to_be_focused()
        page.keyboard.press("c")
        page.keyboard.insert_text("Which value?")
        page.keyboard.press("Escape")
        page.keyboard.press("1")
        expect(answers.last).to_contain_text("marked by Eve")
        expect(page.locator("#waiting")).to_have_text("0")
        found += problems(page, "marked")

    formgrader = [sys.executable, "-m", "jupyter_server"]
    with served(formgrader, home / "OUT", instructor.environment, r"http://127\.0\.0\.1:\d+/\S*\?token=\w+") as address:
        page.goto(wait_until_reachable(address))  # which logs in
        page.goto(urljoin(address, f"/formgrader/gradebook/{PRELAB}/{PRELAB}"))
        page.get_by_role("link", name="Submission #1").click()
        mark_of_formgrader = page.locator("#prelab-6-clock")  # the order of the submissions is nbgrader's
        expect(mark_of_formgrader).to_have_value(re.compile(r"^0\.03$|^0\.02$"))
        first = mark_of_formgrader.input_value()
        mark_of_formgrader.scroll_into_view_if_needed()
        page.screenshot(path=PICTURES / "formgrader.png")
        page.goto(urljoin(address, f"/formgrader/gradebook/{PRELAB}/{PRELAB}"))
        page.get_by_role("link", name="Submission #2").click()
        expect(mark_of_formgrader).to_have_value({"0.03": "0.02", "0.02": "0.03"}[first])

    assert "Wrote" in instructor.labsid("course", "report", "--out", "OUT")
    instructor.labsid("course", "feedback", "--out", "OUT")
    page.goto((home / "OUT" / "report.html").as_uri())
    found += problems(page, "report")
    page.get_by_role("link", name="0.83").click()
    section = page.locator("#prelab-6-clock")
    expect(section).to_contain_text("0.03 / 0.05")
    found += problems(page, "feedback-prelab")
    page.goto((home / "OUT" / "feedback" / "ann" / f"{LAB}.html").as_uri())
    found += problems(page, "feedback-lab")
    page.close()
    assert not found, "\n".join(found)

    export = ["course", "export", "--out", "OUT", "--worksheet", "worksheet.csv", "--format", "moodle"]
    said = instructor.labsid(*export, "--assignment", PRELAB)
    with (home / "OUT" / "moodle" / "worksheet.csv").open(encoding="utf-8-sig", newline="") as file:
        grades = {row["ID number"]: row["Grade"] for row in csv.DictReader(file)}
    assert grades == {"ann": "0.83", "bob": "0.82", "cat": ""}


COUPLED = (("input-dead-zone", "valve"), ("extra-lag", None))
SHOWN = {
    "effects": lambda: with_experiment(with_holdout(with_rest(report("input-delay", "load-step"), "linear"))),
    "none": lambda: report(verdict="none"),
    "signals": lambda: with_planned_inputs(signals_report(*COUPLED, holdout=True)),
    "signals-none": lambda: signals_report(verdict="none"),
}


@pytest.mark.parametrize("name", mostly_exhaustive(SHOWN, ["effects", "signals"]))  # without an effect, they have less
def test_pages_of_the_gap_diagnosis(name: str, context: "BrowserContext", tmp_path: Path) -> None:
    from browser.accessibility import problems_in_either_scheme

    page = context.new_page()
    write_html_report(tmp_path / "page.html", SHOWN[name]())
    page.goto((tmp_path / "page.html").as_uri())
    found = problems_in_either_scheme(page, f"gap-{name}")
    page.close()
    assert not found, "\n".join(found)


def test_the_summary_of_a_batch_is_sorted_by_a_click(context: "BrowserContext", tmp_path: Path) -> None:
    from browser.accessibility import problems_in_either_scheme

    reports = {name: report(name) for name in ("load-step", "input-delay", "extra-lag")}
    for stem, closed in {"load-step": 0.5, "input-delay": 0.1, "extra-lag": 0.9}.items():
        reports[stem]["gap"] |= {"closed": closed, "after": 0.064 - 0.05 * closed}
    reports["none"] = report(verdict="none")
    reports["broken"] = {"schema": "labsid.gap/4", "verdict": "error", "message": "broken.csv is empty"}
    path = tmp_path / "summary.html"
    write_batch_page(path, "bench", reports)
    page = context.new_page()
    refused: list[str] = []
    page.on("console", lambda message: refused.append(message.text))
    page.on("pageerror", lambda failure: refused.append(str(failure)))
    page.goto(path.as_uri())
    orders = [page.locator("#records tbody a").all_inner_texts()]
    for title in ("Gap closed", "Gap closed", "Record"):
        page.get_by_role("button", name=title).click()
        orders.append(page.locator("#records tbody a").all_inner_texts())
    assert orders == [
        ["input-delay", "load-step", "extra-lag", "none"],
        ["input-delay", "load-step", "extra-lag", "none"],
        ["extra-lag", "load-step", "input-delay", "none"],  # without a closed share: last in both orders
        ["extra-lag", "input-delay", "load-step", "none"],
    ]
    assert page.locator("th[aria-sort]").all_inner_texts() == ["Record"]
    background = "getComputedStyle(document.body).backgroundColor"
    light = page.evaluate(background)
    page.emulate_media(color_scheme="dark")
    assert page.evaluate(background) != light
    page.emulate_media(color_scheme="light")
    found = problems_in_either_scheme(page, "batch")
    page.close()
    assert not refused
    assert not found, "\n".join(found)
