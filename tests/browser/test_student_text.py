"""Text of a student in a real browser: nothing in it runs, in formgrader's own templates and in our pages."""

from typing import TYPE_CHECKING

import nbformat
import pytest
from hostile_texts import HOSTILE

from autograder.results.prose import prose_for_notebook, prose_html

if TYPE_CHECKING:
    from playwright.sync_api import BrowserContext

ORDINARY = "It starts at $\\frac{a}{b}$.\n\n- because **of** [this](https://a.example)\n\n```\nx = 1\n\ny = 2\n```"
LINKS = """
() => [...document.querySelectorAll(".labsid-answer a, .prose a")].map(link => {
  if (link.protocol === "https:") link.addEventListener("click", event => event.preventDefault());
  return link.protocol;
})
"""


def formgrader_page(texts: list[str]) -> str:
    """As nbgrader's server makes it, with its templates; the page has neither its scripts nor MathJax."""
    from nbconvert.exporters import HTMLExporter
    from nbgrader.server_extensions.formgrader.handlers import template_path
    from traitlets.config import Config

    cells = [nbformat.v4.new_markdown_cell(prose_for_notebook(text)) for text in texts]
    for number, cell in enumerate(cells):
        kind = {"grade": True, "solution": True, "locked": False, "task": False, "schema_version": 3, "points": 1}
        cell.metadata["nbgrader"] = {**kind, "grade_id": f"q{number}", "cell_type": "markdown"}
    config = Config()
    config.HTMLExporter.template_name = "formgrade"
    config.HTMLExporter.extra_template_basedirs = [template_path]
    resources = {"base_url": "", "index": 0, "total": 1, "notebook_id": "n", "assignment_id": "a", "submission_id": "s"}
    page, _ = HTMLExporter(config=config).from_notebook_node(nbformat.v4.new_notebook(cells=cells), resources)
    return str(page)


@pytest.mark.parametrize("where", ["formgrader", "our pages"])
def test_nothing_that_a_student_wrote_runs(context: "BrowserContext", where: str) -> None:
    texts = [*(text.replace("alert(1)", "window.ran=1") for text in HOSTILE), ORDINARY]
    if where == "formgrader":
        shown = formgrader_page(texts)
    else:
        shown = "".join(f'<div class="prose">{prose_html(text)}</div>' for text in texts)
    page = context.new_page()
    dialogs: list[str] = []
    page.on("dialog", lambda dialog: (dialogs.append(dialog.message), dialog.dismiss()))
    page.set_content(shown, wait_until="domcontentloaded")
    answers = page.locator(".labsid-answer" if where == "formgrader" else ".prose")
    assert answers.count() == len(texts)
    assert set(page.evaluate(LINKS)) == {"https:"}
    for link in answers.locator("a").all():
        link.click(force=True)
    for tag in ("script", "img", "svg", "iframe", "form", "input", "style", "object"):
        assert answers.locator(tag).count() == 0
    assert page.evaluate("() => window.ran") is None
    assert dialogs == []
    last = answers.last
    assert last.locator("math mfrac").count() == 1
    assert last.locator("li strong").inner_text() == "of"
    assert last.locator("pre").inner_text().rstrip() == "x = 1\n\ny = 2"
    page.close()
