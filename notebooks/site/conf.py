"""Sphinx's settings for the site; `make docs` builds it from the sources that `pages.py` writes."""

import re
from html import escape
from pathlib import Path
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx
from sphinx.ext import autosummary
from sphinx.writers.html5 import HTML5Translator

import labsid

autosummary.WELL_KNOWN_ABBREVIATIONS = (*autosummary.WELL_KNOWN_ABBREVIATIONS, " eq.", " Fig.")  # type: ignore[assignment]

project, author, version = "labsid", "the labsid authors", labsid.__version__
copyright = author
root_doc = "notebooks/site/index"
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.doctest",
    "sphinx.ext.napoleon",
]
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 4
default_role = "autolink"  # `name` in a docstring: a link where there is such a page
nitpick_ignore_regex = [("py:obj", ".*")]  # which also names parameters and attributes
templates_path = [str(Path(__file__).parent / "templates")]
autodoc_typehints = "none"  # the docstrings state types with their shapes and units
napoleon_google_docstring = False
napoleon_use_param = napoleon_use_rtype = False
napoleon_custom_sections = [("Attributes", "params_style")]
html_math_renderer = "mathml"
html_theme = "furo"
html_title = "labsid"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
pygments_style, pygments_dark_style = "a11y-high-contrast-light", "a11y-high-contrast-dark"
linkcheck_ignore = [r"https?://"]  # no network at build


def mathml(formula: str, display: str) -> str:
    """A formula as MathML; names of functions get the space around them that MathML leaves out."""
    name = r"\\(ln|log|exp|sin|cos|tan|det|min|max)(?![a-z])"
    formula = re.sub(rf"(?<=[\w}})]) +(?={name})", r"\\,", formula)
    return str(convert(re.sub(rf"{name} *(?=[^\W_]|\\)(?!\\left|\\[bB]ig|\\,)", r"\\\1\\,", formula), display=display))


def visit_math(self: HTML5Translator, node: nodes.math) -> None:
    """A formula in a line as MathML, which browsers draw without a script."""
    self.body.append(mathml(node.astext(), "inline"))
    raise nodes.SkipNode


def visit_math_block(self: HTML5Translator, node: nodes.math_block) -> None:
    """A formula of its own."""
    number = f'<span class="eqno">({escape(str(node["number"]))})</span>' if node.get("number") else ""
    self.body.append(f'<div class="math" tabindex="0">{number}{mathml(node.astext(), "block")}</div>')
    raise nodes.SkipNode


def make_accessible(app: Sphinx, name: str, template: str, context: dict[str, Any], doctree: nodes.document) -> None:
    """What scrolls by itself can be scrolled with the keyboard, and captions of the side bar have a level."""
    body = context.get("body", "")
    for start in ("<pre", '<div class="table-wrapper'):
        body = body.replace(start, f'{start[:4]} tabindex="0"{start[4:]}')
    context["body"] = body
    tree = context.get("furo_navigation_tree", "")
    context["furo_navigation_tree"] = tree.replace('role="heading"', 'role="heading" aria-level="2"')


def write_entry(app: Sphinx, problem: Exception | None) -> None:
    """The page that a browser asks for first."""
    if problem is None and app.builder.name == "html":
        page = f'<!doctype html><meta http-equiv="refresh" content="0; url={root_doc}.html"><title>labsid</title>'
        Path(app.outdir, "index.html").write_text(page, encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    """Formulas without a script, accessible pages, and the first page."""
    app.add_lexer("csv", TextLexer)  # of a guide; Pygments has none
    app.add_html_math_renderer("mathml", (visit_math, None), (visit_math_block, None))
    app.connect("html-page-context", make_accessible, priority=900)  # after the theme
    app.connect("build-finished", write_entry)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
