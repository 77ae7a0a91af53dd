"""Students' Markdown as HTML that is safe to show: no HTML of their own, no scripts, no images, no other headings.

The text is parsed, and what may be shown is chosen in the tree, never by patterns in the text. Each text is rendered
once in a process, under a limit of time; one that takes longer is shown as it was typed. What takes long is kept in the
folder of the results, for the next command.
"""

import contextlib
import hashlib
import re
import sys
import time
from collections.abc import Callable, Sequence
from functools import cache, lru_cache
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import markupsafe

from autograder.results import formulas
from autograder.results.formulas import formula_html
from labsid._files import write_text

if TYPE_CHECKING:
    from markdown_it import MarkdownIt
    from markdown_it.token import Token

MAX_CHARACTERS = 50_000
"""Longer text is shown as it is, shortened to this."""

SECONDS = 0.5
"""Processor time in which a text is rendered; an answer of a page takes 0.01 s."""

LINKS = re.compile(r"(?:https?|mailto):", re.IGNORECASE)
"""Links that are shown as such, after parsing; all others are text."""

_SLOW_CHARACTERS = 200  # a shorter text takes no time worth keeping
_SLOW_SECONDS = 0.03
_KEPT: list[Path] = []  # the folder, if slow texts are kept
_TAG = re.compile(r"(<[^>]*>)")


class _TooSlowError(Exception):
    """The limit of time is over."""


def prose_html(text: str) -> markupsafe.Markup:
    """Render Markdown, with its formulas.

    Parameters
    ----------
    text : str
        Untrusted. HTML in it is shown as text, and links have no addresses but those of the web and of e-mail.
    """
    return _rendered(text, SECONDS)


def course_html(text: str) -> markupsafe.Markup:
    """Render Markdown of the course itself: like `prose_html`, with its headings, and with folded hints unfolded."""
    text = re.sub(r"<summary>(.*?)</summary>", r"**\1**", text, flags=re.DOTALL)
    text = re.sub(r"</?details>", "", text)
    return markupsafe.Markup(_render(text, float("inf"), keep_headings=True))


def prose_for_notebook(text: str, seconds: float = SECONDS) -> str:
    """Render Markdown as a cell of Markdown for a program that does not clean it, such as formgrader.

    Parameters
    ----------
    text : str
        Untrusted; see `prose_html`.
    seconds : float
        Processor time.

    Returns
    -------
    str
        HTML on one line, which Markdown passes on as it is. No delimiter of MathJax, which could write links, is beside
        another character: MathJax reads formulas only within one text.
    """
    parts = _TAG.split(str(_rendered(text, seconds)))
    inner = "".join(part if index % 2 else _apart(part) for index, part in enumerate(parts))
    return f'<div class="labsid-answer">{inner}</div>'


def _apart(text: str) -> str:
    """Text between tags on one line, with each dollar sign and backslash in an element of its own."""
    text = text.replace("\n", "&#10;")
    return re.sub(r"[$\\]", lambda found: f"<span>&#{ord(found[0])};</span>", text)


def keep_slow_texts(out: Path) -> None:
    """Keep what takes long to render in ``OUT/rendered``, for this process and later ones."""
    _KEPT[:] = [out.absolute() / "rendered"]


@lru_cache(maxsize=4096)
def _rendered(text: str, seconds: float) -> markupsafe.Markup:
    if not _KEPT or len(text) < _SLOW_CHARACTERS or seconds < SECONDS:
        return _rendered_now(text, seconds)
    key = hashlib.sha256(b"\0".join([_version(), repr(seconds).encode(), text.encode(errors="surrogatepass")]))
    path = _KEPT[0] / f"{key.hexdigest()}.html"
    with contextlib.suppress(OSError, UnicodeDecodeError):
        return markupsafe.Markup(path.read_text(encoding="utf-8"))
    began = time.thread_time()
    rendered = _rendered_now(text, seconds)
    if time.thread_time() - began > _SLOW_SECONDS:
        with contextlib.suppress(OSError, UnicodeEncodeError):
            write_text(path, str(rendered))
    return rendered


@cache
def _version() -> bytes:
    """A digest of the code that renders."""
    sources = (Path(module.__file__ or "").read_bytes() for module in (sys.modules[__name__], formulas))
    return hashlib.sha256(b"".join(sources)).digest()


def _rendered_now(text: str, seconds: float) -> markupsafe.Markup:
    if len(text) <= MAX_CHARACTERS:
        try:
            return markupsafe.Markup(_render(text, time.thread_time() + seconds))
        except Exception:  # too slow, or too deep; the errors of a parser have no common class
            pass
    shortened = f"{text[:MAX_CHARACTERS]} ..." if len(text) > MAX_CHARACTERS else text
    return markupsafe.Markup("<pre>{}</pre>").format(shortened)


def _render(text: str, deadline: float, keep_headings: bool = False) -> str:
    parser, environment = _parser(), {"deadline": deadline}
    tokens = parser.parse(text, environment)
    for token in tokens:
        if token.type in ("heading_open", "heading_close") and not keep_headings:
            token.tag = "p"
        if token.children:
            _clean_links(token.children)
    return str(parser.renderer.render(tokens, parser.options, environment))


def _clean_links(tokens: Sequence["Token"]) -> None:
    """Keep links to the web and to e-mail addresses; of others only the text."""
    kept: list[bool] = []
    for token in tokens:
        if token.type == "link_open":
            address = str(token.attrGet("href") or "")
            kept.append(LINKS.match(address) is not None)
            token.attrs = {"href": _quoted(address), "rel": "noopener noreferrer nofollow"} if kept[-1] else {}
        if token.type in ("link_open", "link_close"):
            is_kept = kept[-1] if token.type == "link_open" else kept.pop()
            token.tag = "a" if is_kept else "span"


def _quoted(address: str) -> str:
    return re.sub(r"[$\\`\s]", lambda found: f"%{ord(found[0]):02X}", address)


@cache
def _parser() -> "MarkdownIt":
    from markdown_it import MarkdownIt
    from mdit_py_plugins.dollarmath import dollarmath_plugin

    parser = MarkdownIt("js-default", {"html": False, "maxNesting": 20})
    parser.disable(["image", "html_block", "html_inline"]).use(dollarmath_plugin)
    for ruler in (parser.block.ruler, parser.inline.ruler, parser.inline.ruler2):
        for rule in ruler.__rules__:
            rule.fn = _with_limit(rule.fn)
        ruler.__cache__ = None
    for kind, display in _FORMULAS.items():
        parser.add_render_rule(kind, _formula_rule(display))
    return parser


_FORMULAS = {"math_inline": "inline", "math_inline_double": "block", "math_block": "block", "math_block_label": "block"}


def _formula_rule(display: str) -> Callable[..., str]:
    def render(renderer: Any, tokens: Sequence["Token"], index: int, options: Any, environment: Any) -> str:
        _require_time(environment)
        formula = str(formula_html(tokens[index].content.strip(), display))
        drawn = formula if formula.startswith("<math") and not re.search(r"[$\\]", formula) else ""
        shown = drawn or f"<code>{escape(tokens[index].content.strip())}</code>"
        element = "span" if display == "inline" else "div"
        return f'<{element} class="math {display}">{shown}</{element}>'

    return render


def _with_limit(rule: Callable[..., Any]) -> Callable[..., Any]:
    """A rule of the parser that is not begun after the limit of time; each call of one is short."""

    def limited(state: Any, *arguments: Any) -> Any:
        _require_time(state.env)
        return rule(state, *arguments)

    return limited


def _require_time(environment: Any) -> None:
    if time.thread_time() > environment["deadline"]:
        raise _TooSlowError
