"""Students' LaTeX formulas as MathML, which browsers draw without scripts."""

import html
import re
from xml.etree.ElementTree import Element, tostring

import markupsafe

MAX_CHARACTERS = 1000
"""Longer formulas are shown as they were typed."""

_ELEMENT = re.compile(
    "math|m(row|i|n|o|text|space|frac|sqrt|root|sub|sup|subsup|over|under|underover|table|tr|td|style|padded|phantom)|"
    "menclose|mmultiscripts|mprescripts|none"
)
_ATTRIBUTE = re.compile(
    "display|displaystyle|scriptlevel|mathvariant|stretchy|fence|separator|accent|accentunder|movablelimits|form|"
    "symmetric|largeop|linethickness|columnalign|columnspacing|rowspacing|notation|lspace|rspace|width|height|depth"
)
_PLAIN_VALUE = re.compile(r"[a-z -]*|\d{0,2}(\.\d+)?(em|ex|pt|px|%)?")
"""Words, or a size that can neither cover other parts of the page nor widen it by much."""


def formula_html(formula: str, display: str) -> markupsafe.Markup:
    """Render a formula; one that cannot be read is shown as it was typed.

    Parameters
    ----------
    formula : str
        Untrusted LaTeX, without dollar signs.
    display : {"inline", "block"}

    Returns
    -------
    Markup
        MathML with elements and attributes of a fixed list, and text.
    """
    from latex2mathml.converter import convert_to_element

    if len(formula) > MAX_CHARACTERS:
        return markupsafe.escape(formula)
    try:
        drawn = convert_to_element(formula, display=display)
        _restrict(drawn)
        return markupsafe.Markup(tostring(drawn, encoding="unicode"))
    except Exception:  # the converter's errors have no common class, and IndexError is among them
        return markupsafe.escape(formula)


def _restrict(element: Element) -> None:
    """Remove attributes that are not known; `ValueError` for an element that is not."""
    for part in element.iter():
        if not _ELEMENT.fullmatch(part.tag):
            raise ValueError(f"{part.tag} is no element of a formula")
        for name, value in list(part.attrib.items()):
            if not _ATTRIBUTE.fullmatch(name) or not _PLAIN_VALUE.fullmatch(value):
                del part.attrib[name]
        part.text, part.tail = (html.unescape(text) if text else None for text in (part.text, part.tail))
