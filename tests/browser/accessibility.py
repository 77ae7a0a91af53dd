"""What axe-core finds on a page, at the width of a screen and of a telephone."""

from collections.abc import Iterator, Sequence

from course_work import ROOT
from playwright.sync_api import Page

WIDTHS = (1280, 390)
PICTURES = ROOT / "build" / "browser"
"""Screenshots of every page, to be looked at."""
_SERIOUS = ("serious", "critical")
_OF_JUPYTERLAB = ("aria-input-field-name", "image-alt", "scrollable-region-focusable")
"""JupyterLab itself makes the elements around texts, which scroll, and around images, without an alternative text; the
handle of a slider of ipywidgets has no name, only a label beside it."""


def problems_in_either_scheme(page: Page, name: str) -> list[str]:
    """What `problems` finds in light colours, and in dark ones on a screen, where all parts are seen."""
    found = problems(page, name)
    page.emulate_media(color_scheme="dark")
    found += problems(page, f"{name}-dark", widths=WIDTHS[:1])
    page.emulate_media(color_scheme="light")
    return found


def problems(page: Page, name: str, parts: Sequence[str] = (), widths: Sequence[int] = WIDTHS) -> list[str]:
    """Serious findings of axe-core, and horizontal scrolling, at each width; the page keeps its first size.

    Parameters
    ----------
    page : Page
    name : str
        Of the page, for its screenshots.
    parts : sequence of str, optional
        CSS selectors of the parts of a page of JupyterLab that are the project's own; default the whole page, which
        must then fit the width.
    widths : sequence of int, optional
        In pixels.

    Returns
    -------
    list of str
        Page, width, rule and place of each; empty if there is nothing to report.
    """
    size = page.viewport_size
    assert size is not None
    found = []
    PICTURES.mkdir(parents=True, exist_ok=True)
    for width in widths:
        page.set_viewport_size({"width": width, "height": size["height"]})
        page.screenshot(path=PICTURES / f"{name}-{width}.png", full_page=not parts)
        found += [f"{name} at {width} px: {line}" for line in _findings(page, parts)]
        wide = 0 if parts else page.evaluate("document.documentElement.scrollWidth")
        if wide > width:
            found.append(f"{name} at {width} px: its content is {wide} px wide")
    page.set_viewport_size(size)
    return found


def _findings(page: Page, parts: Sequence[str]) -> Iterator[str]:
    from axe_playwright_python.sync_playwright import Axe

    context, options = None, None
    if parts:
        context = {"include": [[part] for part in parts if page.locator(part).count()]}
        options = {"rules": {rule: {"enabled": False} for rule in _OF_JUPYTERLAB}}
    for rule in Axe().run(page, context=context, options=options).response["violations"]:
        if rule["impact"] in _SERIOUS:
            places = ", ".join(" ".join(map(str, node["target"])) for node in rule["nodes"][:3])
            yield f"{rule['id']} ({rule['impact']}, {len(rule['nodes'])} times): {places}"
