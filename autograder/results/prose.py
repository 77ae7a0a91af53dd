"""Students' Markdown as HTML that is safe to show: no HTML of their own, no scripts, no images, no other headings."""

from functools import cache
from typing import TYPE_CHECKING, Any

import markupsafe

from autograder.results.formulas import formula_html

if TYPE_CHECKING:
    from markdown_it import MarkdownIt

MAX_CHARACTERS = 50_000
"""Longer text is shown as it is."""


def prose_html(text: str) -> markupsafe.Markup:
    """Render Markdown, with its formulas.

    Parameters
    ----------
    text : str
        Untrusted. HTML in it is shown as text; links that could run a script are shown as text.
    """
    if len(text) > MAX_CHARACTERS:
        return markupsafe.Markup("<pre>{}</pre>").format(text)
    renderer = _renderer()
    tokens = renderer.parse(text)
    for token in tokens:
        if token.type in ("heading_open", "heading_close"):
            token.tag = "p"
        for child in token.children or ():
            if child.type == "link_open":
                child.attrSet("rel", "noopener noreferrer nofollow")
    return markupsafe.Markup(renderer.renderer.render(tokens, renderer.options, {}))


@cache
def _renderer() -> "MarkdownIt":
    from markdown_it import MarkdownIt
    from mdit_py_plugins.dollarmath import dollarmath_plugin

    def formula(latex: str, options: dict[str, Any]) -> str:
        return str(formula_html(latex, "block" if options.get("display_mode") else "inline"))

    return MarkdownIt("js-default", {"html": False}).disable("image").use(dollarmath_plugin, renderer=formula)
