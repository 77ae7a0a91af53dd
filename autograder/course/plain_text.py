"""Numbers and text as they appear in tables, pages and terminal output."""

from decimal import Decimal


def plain_decimal(value: Decimal) -> str:
    """A decimal without exponent and trailing zeros: ``0.60`` is ``0.6``, ``2.0`` is ``2``."""
    text = format(value.normalize(), "f")
    return "0" if text in ("-0", "") else text


def shortened(text: str, most: int = 200) -> str:
    """The end of a long text, such as a path, with dots before it."""
    return text if len(text) <= most else f"...{text[-most:]}"


def one_line(text: str) -> str:
    """Text without line breaks and control characters."""
    return " ".join("".join(c if c.isprintable() or c.isspace() else " " for c in text).split())
