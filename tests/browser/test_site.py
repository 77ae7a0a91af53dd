"""The site that `make docs` has built, in a browser: axe-core and the width of its pages. Skipped without a build."""

import pytest
from course_work import ROOT

from browser.accessibility import problems_in_either_scheme

BUILT = ROOT / "build" / "docs" / "html"
PAGES = (
    "notebooks/site/index",
    "notebooks/site/gallery/input-dead-zone",
    "notebooks/site/decision",
    "notebooks/site/constants",
    "notebooks/site/api/labsid.fit_arx",
    "notebooks/postlab-model-order/postlab-model-order",
)


@pytest.mark.slow
@pytest.mark.parametrize("name", PAGES)
def test_a_page_of_the_site_is_accessible_and_fits(context, name):
    path = BUILT / f"{name}.html"
    if not path.is_file():
        pytest.skip("the site has not been built: make docs")
    page = context.new_page()
    page.goto(path.as_uri())
    assert problems_in_either_scheme(page, f"site-{name.replace('/', '-')}") == []
    page.close()
