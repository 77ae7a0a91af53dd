import re

import pytest
from nbconvert.filters.markdown_mistune import markdown2html_mistune

from autograder.results.autograded import clean_markdown

_RUNS = re.compile(
    r"<(?!/?(p|a|em|strong|code|img|pre|br|div|span)\b)\w|<\w[^>]*\son\w+=|(javascript|vbscript|data):", re.IGNORECASE
)


@pytest.mark.parametrize(
    "text",
    [
        "<script>alert(1)</script>",
        "<img src=x onerror=alert(1)>",
        "<javascript:alert(1)>",
        "[x](javascript:alert(1))",
        "[x](JavaScript:alert(1))",
        "[x](&#106;avascript:alert(1))",
        "[x](java&Tab;script:alert(1))",
        "[x](< java\tscript:alert(1)>)",
        "[x](vbscript:alert(1))",
        "[x](data:text/html;base64,PHNjcmlwdD4=)",
        "![x](javascript:alert(1))",
        "[x]: javascript:alert(1)\n\n[x]",
        "<!-- --><svg/onload=alert(1)>",
        "```\n</code></pre><script>alert(1)</script>\n```",
    ],
)
def test_no_script_of_a_students_text_runs_in_formgrader(text: str) -> None:
    """Converted as formgrader converts it."""
    assert not _RUNS.search(re.sub(r"[\t\r\n]+", "", markdown2html_mistune(clean_markdown(text))))


@pytest.mark.parametrize(
    "macro", [r"\\href{javascript:alert(1)}{x}", r"\\\\href{x}{y}", r"\\mmlToken{mi}[href='x']{y}"]
)
def test_no_macro_of_mathjax_writes_a_link(macro: str) -> None:
    assert "\\" not in clean_markdown(f"${macro}$")
    assert "javascript:" not in clean_markdown(macro)


@pytest.mark.parametrize(
    "text", ["$a < b$ and **bold**, `x[1:2]`", r"$\\frac{a}{b} > \\theta$", "a & b: 2 > 1", "data: 3 V"]
)
def test_ordinary_text_is_kept(text: str) -> None:
    assert clean_markdown(text) == text
