"""The site that `make docs` has built, in a browser: axe-core and the width of its pages. Skipped without a build."""

import pytest
from course_work import ROOT

from browser.accessibility import WIDTHS, problems, problems_in_either_scheme

BUILT = ROOT / "build" / "docs" / "html"
PAGES = (
    "notebooks/site/index",
    "notebooks/site/gallery/input-dead-zone",
    pytest.param("notebooks/site/decision", marks=pytest.mark.exhaustive),  # words and formulas: so has a notebook
    "notebooks/site/api/labsid.fit_arx",
    "notebooks/postlab-model-order/postlab-model-order",
)
WIDEST = "notebooks/site/constants"
"""A page of tables of hundreds of rows."""


@pytest.mark.slow
@pytest.mark.parametrize("name", PAGES)
def test_a_page_of_the_site_is_accessible_and_fits(context, name):
    page = opened(context, name)
    assert problems_in_either_scheme(page, f"site-{name.replace('/', '-')}") == []
    page.close()


@pytest.mark.slow
def test_the_widest_tables_of_the_site_are_accessible_and_fit_a_telephone(context):
    """All rows fit; axe-core, which takes a minute for all, sees the first ones of each table."""
    page = opened(context, WIDEST)
    size = page.viewport_size
    page.set_viewport_size({"width": WIDTHS[-1], "height": size["height"]})
    assert page.evaluate("document.documentElement.scrollWidth") <= WIDTHS[-1]
    page.set_viewport_size(size)
    page.evaluate("document.querySelectorAll('tbody tr:nth-child(n+4)').forEach((row) => row.remove())")
    assert problems(page, "site-constants", widths=WIDTHS[-1:]) == []
    page.close()


def opened(context, name):
    path = BUILT / f"{name}.html"
    if not path.is_file():
        pytest.skip("the site has not been built: make docs")
    page = context.new_page()
    page.goto(path.as_uri())
    return page
