"""Labels of figures as plain text: without TeX markup and control characters."""

import re
from unicodedata import lookup

_SYMBOLS = {
    "lambda": "λ",  # its name in Unicode is LAMDA
    "Lambda": "Λ",
    "varphi": "φ",
    "varepsilon": "ε",
    "vartheta": "ϑ",
    "cdot": "·",
    "times": "×",
    "pm": "±",
    "le": "≤",
    "leq": "≤",
    "ge": "≥",
    "geq": "≥",
    "ne": "≠",
    "neq": "≠",
    "approx": "≈",
    "infty": "∞",
    "circ": "°",
    "prime": "′",
    "sum": "Σ",
    "partial": "∂",
    "sqrt": "√",
    "rightarrow": "→",
    "to": "→",
}
"""Signs of TeX commands that are not Greek letters by their name in Unicode."""
_STYLE = re.compile(
    "(wide)?(hat|tilde)|bar|overline|d?dot|vec|left|right|math(rm|bf|it|sf|tt|cal|bb|regular)|operatorname|"
    "text(rm|bf|it)?|rm|bf|it|q?quad|displaystyle"
)
"""TeX commands that set how the text after them looks."""


def label_text(text: str, longest: int) -> str:
    """Text without TeX markup and control characters, shortened to `longest` characters."""
    text = re.sub(r"\\(?:([A-Za-z]+)|(.))", _sign, text) if "$" in text else text
    text = text.replace("$", "")
    text = "".join(c for c in re.sub(r"[{}]", "", text) if c.isprintable())
    return text if len(text) <= longest else text[: longest - 1] + "…"


def _sign(command: re.Match[str]) -> str:
    """What a TeX command stands for in plain text; its name where that is not known, as for ``\\sin``."""
    name, mark = command.groups()
    if name is None:
        return " " if mark in ",;: " else "" if mark == "!" else mark
    if _STYLE.fullmatch(name):
        return ""
    if name in _SYMBOLS:
        return _SYMBOLS[name]
    try:
        return lookup(f"GREEK {'CAPITAL' if name[0].isupper() else 'SMALL'} LETTER {name}")
    except KeyError:
        return name
