"""Whether the legend of a figure names each curve, or calls one by the name of the other."""

import re
from dataclasses import dataclass

from labsid.checks.figures import legend_text
from labsid.checks.verdict import NoAnswer
from labsid.plots.figure_values import AxesValue, CurveValue


@dataclass(frozen=True, slots=True, eq=False)
class NamedCurve:
    """A curve, and the words by which legends name it.

    Attributes
    ----------
    curve : CurveValue
    what : str
        What the curve is, as a message says it: "the original system".
    words : str
        Pattern of words that name this curve alone.
    also : str
        Pattern of words that name it beside a curve that they do not name, such as "model" beside "process".
    """

    curve: CurveValue
    what: str
    words: str
    also: str


def require_own_names(axes: AxesValue, where: str, one: NamedCurve, other: NamedCurve) -> None:
    """Refuse a legend that gives one of two curves the name of the other; what names neither is accepted.

    Parameters
    ----------
    axes : AxesValue
    where : str
        What the figure is called in the message.
    one, other : NamedCurve

    Raises
    ------
    NoAnswer
        If the words of an entry name the other curve and not its own, or both entries may do so.
    """
    texts = [legend_text(axes, named.curve) for named in (one, other)]
    crossed = [_names(text, its, another) for text, its, another in zip(texts, (one, other), (other, one), strict=True)]
    for text, its, another, how in zip(texts, (one, other), (other, one), crossed, strict=True):
        if how == "surely" or all(crossed):
            raise NoAnswer(
                f"The legend of {where} names the curve of {its.what} {text.strip()!r}, as if it were {another.what}: "
                "give each curve the name of its own data.",
                "legend entries swapped",
            )


def _names(text: str, own: NamedCurve, other: NamedCurve) -> str:
    """How an entry names the other curve: "surely", "perhaps", or not at all."""
    if _has(text, own.words) or _has(text, own.also):
        return ""
    return "surely" if _has(text, other.words) else "perhaps" if _has(text, other.also) else ""


def _has(text: str, words: str) -> bool:
    return re.search(words, text.replace("_", " "), re.IGNORECASE) is not None
