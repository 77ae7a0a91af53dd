"""What students write, as every page shows it: no script, no formula of MathJax, no long time."""

from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path

import pytest
from hostile_texts import HOSTILE
from nbconvert.filters.markdown_mistune import markdown2html_mistune

from autograder.results import prose
from autograder.results.prose import LINKS, prose_for_notebook, prose_html
from labsid.checks.time_limit import limit_time

ALLOWED = {
    "p", "a", "em", "strong", "s", "code", "pre", "br", "hr", "div", "span", "ul", "ol", "li", "blockquote",
    "table", "thead", "tbody", "tr", "th", "td", "math", "mrow", "mi", "mo", "mn", "mfrac", "msub", "msup", "mtext",
}  # fmt: skip


class Elements(HTMLParser):
    """The elements of a page, and its texts, entities decoded as a browser does."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None]]] = []
        self.texts: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))
        self.texts.append("")

    def handle_endtag(self, tag: str) -> None:
        self.texts.append("")

    def handle_data(self, data: str) -> None:
        self.texts.append((self.texts.pop() if self.texts else "") + data)


@pytest.mark.parametrize("text", HOSTILE)
@pytest.mark.parametrize("shown", [prose_html, lambda text: markdown2html_mistune(prose_for_notebook(text))])
def test_no_script_of_a_students_text_runs(text: str, shown: Callable[[str], str]) -> None:
    """In our own pages, and converted as formgrader converts it."""
    page = Elements(str(shown(text)))
    for tag, attributes in page.found:
        assert tag in ALLOWED
        assert attributes.keys() <= {"href", "rel", "class", "display", "title", "start", "style", "stretchy"}
        assert "href" not in attributes or (tag == "a" and LINKS.match(attributes["href"] or ""))


@pytest.mark.parametrize("text", HOSTILE)
def test_mathjax_finds_no_formula_in_a_students_text(text: str) -> None:
    """It looks for delimiters in one text at a time, and not across elements."""
    page = Elements(markdown2html_mistune(prose_for_notebook(text)))
    for part in page.texts:
        assert part in ("$", "\\") or not {"$", "\\"} & set(part)
    assert all("$" not in str(value) and "\\" not in str(value) for _, one in page.found for value in one.values())


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a < b and **bold**, `x[1:2]`", "<p>a &lt; b and <strong>bold</strong>, <code>x[1:2]</code></p>"),
        ("a & b: 2 > 1", "a &amp; b: 2 &gt; 1"),
        ("data: 3 V", "data: 3 V"),
        ("[w](https://a.example/x?y=1)", '<a href="https://a.example/x?y=1" rel="noopener noreferrer nofollow">w</a>'),
        ("$\\frac{a}{b}$", "<mfrac><mrow><mi>a</mi></mrow><mrow><mi>b</mi></mrow></mfrac>"),
        ("```\na\n\nb\n```", "<code>a&#10;&#10;b&#10;</code>"),
    ],
)
def test_ordinary_text_is_shown(text: str, expected: str) -> None:
    assert expected in markdown2html_mistune(prose_for_notebook(text))


def test_what_takes_long_is_kept_for_the_next_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(prose, "_KEPT", [])
    monkeypatch.setattr(prose, "_SLOW_SECONDS", 0.0)
    text = "A **long** answer. " * 20
    first = prose_html(text)
    prose.keep_slow_texts(tmp_path)
    for _ in range(2):
        prose._rendered.cache_clear()
        assert prose_html(text) == first
    (kept,) = (tmp_path / "rendered").iterdir()
    kept.write_text("<p>kept</p>", encoding="utf-8")
    prose._rendered.cache_clear()
    assert prose_html(text) == "<p>kept</p>"
    prose._rendered.cache_clear()
    assert "short" in prose_html("short")
    assert len(list((tmp_path / "rendered").iterdir())) == 1


SLOW = {
    "formulas": ("$$a\n\n" * 12_500)[:49_990], "brackets": "[" * 49_990, "images": "![[" * 16_000,
    "links": "[a](" * 12_000, "emphasis": "**a" * 16_000, "many formulas": "$a$ " * 12_000, "tags": "<" * 49_990,
    "rows": ("|a" * 500 + "\n") * 49, "quotes": "> " * 24_000, "lists": "- a\n " * 9_000, "long": "$$a\n\n" * 100_000,
}  # fmt: skip


@pytest.mark.parametrize("kind", SLOW)
def test_a_text_is_rendered_within_its_time_and_once(kind: str) -> None:
    with limit_time(60.0):  # its limit is half a second; without it, some would take minutes
        first = prose_html(SLOW[kind])
    assert prose_html(SLOW[kind]) is first
