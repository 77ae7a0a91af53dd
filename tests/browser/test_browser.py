"""A student and an instructor in a real browser, and every kind of page at the width of a screen and of a telephone."""

import os
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from browser.conftest import LAB, PRELAB, Student

if TYPE_CHECKING:
    from playwright.sync_api import BrowserContext

pytestmark = [pytest.mark.slow, pytest.mark.skipif(os.name != "posix", reason="servers are ended by signals")]


def test_a_student_works_in_jupyterlab_and_submits(
    context: "BrowserContext", jupyterlab: str, student: Student
) -> None:
    from browser.notebook_page import NotebookPage
    from playwright.sync_api import expect

    page = context.new_page()
    page.goto(jupyterlab)
    work = NotebookPage(page)
    work.notebook.get_by_role("link", name="Pre-lab: two noisy sinusoids").click()
    work.wait_until_open("1. A column vector of time")
    work.run(work.notebook.locator(".jp-CodeCell").first)
    work.answer("prelab-1-time", "t = np.linspace(0, 100, 1001)", "✗ prelab-1-time")
    expect(work.check_cell("prelab-1-time")).to_contain_text('check.skip("prelab-1-time")')
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
    page.screenshot(path="build/x/prelab2.png")

    page.locator(".lm-TabBar-tab", has_text="start.ipynb").click()
    work.notebook.get_by_role("link", name="Lab: identify a second-order model").click()
    work.wait_until_open("1a. Load the record")
    work.restart_and_run_all()
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
    page.screenshot(path="build/x/lab2.png")
    page.close()

    said = student.labsid("submit")
    assert "questions are not right or not done. hand-in.zip was not written" in said
    said = student.labsid("submit", "--yes")
    assert f"{PRELAB}, run from a clean start:" in said
    for line in ("✓ prelab-1-time", "– prelab-2-noise", "✓ lab-1a-extract", "✓ lab-2b-parameters"):
        assert line in said
    assert "Total: 0.25 of 1 marks" in said
    assert said.splitlines()[-1] == f"Hand in this file: hand-in.zip ({PRELAB}, {LAB})"
    with zipfile.ZipFile(student.home / "hand-in.zip") as archive:
        assert {Path(name).name for name in archive.namelist()} >= {f"{PRELAB}.ipynb", f"{LAB}.ipynb"}
