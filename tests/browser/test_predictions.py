"""A prediction in JupyterLab: nothing is seen before a choice; then the slider, the figure and the verdict."""

import os
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import BrowserContext

pytestmark = pytest.mark.skipif(os.name != "posix", reason="servers are ended by signals")


def test_a_student_predicts_commits_and_sees(context: "BrowserContext", jupyterlab: str) -> None:
    from playwright.sync_api import expect

    from browser.accessibility import PICTURES, problems
    from browser.notebook_page import OWN_PARTS, NotebookPage

    page = context.new_page()
    page.goto(jupyterlab)
    notebook = NotebookPage(page)
    notebook.hide_files()
    notebook.wait_until_open("System identification: start here", "show_progress()")
    notebook.notebook.get_by_role("link", name="Lab: identify a second-order model").click()
    notebook.wait_until_open("1a. Load the record")
    notebook.run_first()
    cell = notebook.notebook.locator(".jp-CodeCell", has_text='check.predict("row-of-phi")')
    notebook.run(cell)
    shown = cell.locator(".jp-OutputArea")
    expect(shown).to_contain_text("beside y(k) stands the row that belongs to y(k−1)")
    expect(shown.get_by_role("slider")).to_have_count(0)
    expect(shown.locator("img")).to_have_count(0)
    commit = shown.get_by_role("button", name="This is my prediction")
    expect(commit).to_be_disabled()
    shown.get_by_label("About as well as before.").check()
    commit.click()
    expect(shown.locator("img")).to_have_attribute(
        "alt", "Rows of Φ in place. Error of the fit 0.004 V, of the simulation 0.032 V (rms)."
    )
    handle = shown.locator(".noUi-handle")
    handle.focus()
    page.keyboard.press("ArrowRight")
    expect(shown.locator("img")).to_have_attribute(
        "alt", "Rows of Φ 1 sample too late. Error of the fit 0.0063 V, of the simulation 0.26 V (rms)."
    )
    expect(shown).to_contain_text('Your prediction did not hold. What happens: "Much worse')
    expect(shown.locator("textarea")).to_be_visible()
    PICTURES.mkdir(parents=True, exist_ok=True)
    cell.screenshot(path=PICTURES / "prediction.png")
    assert problems(page, "prediction-in-jupyterlab", OWN_PARTS) == []
    page.close()
