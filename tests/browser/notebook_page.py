"""A notebook open in JupyterLab, worked on with the mouse and the keyboard as a student does."""

from dataclasses import dataclass

from playwright.sync_api import Locator, Page, expect

_IN_FRONT = ".jp-NotebookPanel:not(.lm-mod-hidden) .jp-Notebook"
OWN_PARTS = (f"{_IN_FRONT} .jp-RenderedMarkdown", f"{_IN_FRONT} .jp-OutputArea-output")
"""What is the course's own in the notebook in front: its texts, and what its cells show."""

IDLE_MS = 240_000


@dataclass(frozen=True)
class NotebookPage:
    """The notebook that is in front in a window of JupyterLab.

    Attributes
    ----------
    page : Page
    """

    page: Page

    @property
    def notebook(self) -> Locator:
        """The cells that can be seen, apart from those of other tabs."""
        return self.page.locator(_IN_FRONT)

    def check_cell(self, question: str) -> Locator:
        """The cell with the check of a question."""
        source = self.page.locator(".jp-InputArea", has_text=f'check("{question}")')
        return self.notebook.locator(".jp-CodeCell", has=source)

    def answer_cell(self, question: str) -> Locator:
        """The cell above the check."""
        return self.check_cell(question).locator('xpath=preceding-sibling::*[contains(@class, "jp-CodeCell")][1]')

    def wait_until_open(self, heading: str, last_code: str = "check.summary()") -> None:
        """Wait until the notebook is shown to its last code and its kernel can run cells."""
        expect(self.notebook.get_by_role("heading", name=heading, exact=True)).to_be_visible()
        # JupyterLab draws the last cells when it is idle, which takes long beside other tests.
        expect(self.notebook.locator(".jp-CodeCell", has_text=last_code)).to_be_attached(timeout=IDLE_MS)
        expect(self.page.locator("#jp-main-statusbar")).to_contain_text("Python 3 (ipykernel) | Idle")

    def hide_files(self) -> None:
        """Close the list of files, which would leave no room for the notebook on a narrow screen.

        It is closed already where an earlier test of this server has closed it.
        """
        files = self.page.locator("#filebrowser")
        self.page.locator("#filebrowser:not(.jp-mod-restoring)").wait_for(state="attached")
        if files.is_visible():
            self.page.keyboard.press("ControlOrMeta+b")
        files.wait_for(state="hidden")

    def run(self, cell: Locator) -> None:
        """Run a cell with Shift+Enter."""
        cell.locator(".cm-content").click()
        self.page.keyboard.press("Shift+Enter")

    def run_first(self, cells: int = 1) -> None:
        """Run the first code cells."""
        for place in range(cells):
            self.run(self.notebook.locator(".jp-CodeCell").nth(place))

    def write(self, cell: Locator, source: str) -> None:
        """Replace the text of a cell."""
        cell.locator(".cm-content").click()
        self.page.keyboard.press("ControlOrMeta+a")
        self.page.keyboard.insert_text(source)

    def answer(self, question: str, source: str, said: str) -> None:
        """Write an answer, run it, run its check, and wait for what that says."""
        self.write(self.answer_cell(question), source)
        self.page.keyboard.press("Shift+Enter")
        self.run(self.check_cell(question))
        expect(self.check_cell(question).locator(".jp-OutputArea")).to_contain_text(said)

    def add_below(self, question: str, source: str) -> Locator:
        """Add a cell below a check, and run it.

        Returns
        -------
        Locator
            The new cell.
        """
        self.check_cell(question).locator(".jp-InputPrompt").click()
        self.page.keyboard.press("b")
        self.page.keyboard.press("Enter")
        self.page.keyboard.insert_text(source)
        self.page.keyboard.press("Shift+Enter")
        return self.check_cell(question).locator('xpath=following-sibling::*[contains(@class, "jp-CodeCell")][1]')

    def restart_and_run_all(self) -> Locator:
        """Restart the kernel, run all cells, and wait until the last one has been run.

        Returns
        -------
        Locator
            The output of the last cell, which must be the summary.
        """
        code = self.notebook.locator(".jp-CodeCell")
        self.page.get_by_role("menuitem", name="Run", exact=True).click()
        self.page.get_by_role("menuitem", name="Restart Kernel and Run All Cells…").click()
        self.page.get_by_role("button", name="Confirm Kernel Restart").click()
        expect(code.last.locator(".jp-InputPrompt")).to_have_text(f"[{code.count()}]:")
        return code.last.locator(".jp-OutputArea")

    def save(self) -> None:
        """Save the notebook, and wait until its tab says so."""
        self.page.keyboard.press("Escape")
        self.page.keyboard.press("ControlOrMeta+s")
        expect(self.page.locator(".lm-TabBar-tab.jp-mod-current.jp-mod-dirty")).to_have_count(0)
