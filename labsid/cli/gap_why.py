"""The text of ``labsid gap diagnose --why``."""

import shutil
from collections.abc import Iterator
from math import isfinite
from textwrap import wrap

from labsid._texts import joined
from labsid.gap.verdict.gates import Gate, Probability, Stage, Why

WIDTHS = (60, 100)  # characters of a line: those of the terminal, within these limits
MEANINGS = {
    "none": "no gap beyond noise",
    "effect": "the effects explain all but noise",
    "partial": "the effects reduce the error on samples that no fit has seen, and more than noise is left",
    "unknown": "more than noise is left, and no effect of the table reduces the error enough",
}
EVIDENCE = {
    "colour": "residual slower than white noise",
    "repeats": "residual repeats with the input",
    "activity": "its size repeats with the input",
    "tails": "residual has outliers, or comes and goes",
    "short": "gap left on held-out samples",
    "several": "number of effects beyond the first",
    "coloured": "1 for coloured noise beside effects",
    "reduction": "error that the effects take away",
    "unrepeated": "1 if levels do not repeat",
    "dependent": "1 if the residual depends on u",
    "alone": "error that it alone takes away",
    "lead": "its lead, alone, over any other",
    "margin": "error with the best rival instead",
    "agreement": "by BIC found: 1, others -1, none 0",
    "others": "number of other effects",
    "together": "1 if all of its set are found",
    "missed": "error without it",
    "smooth": "1 if its law is a smooth curve",
}
"""What each measure of `Evidence` and `PartialEvidence` says."""

LEGEND = {
    "BIC gain": "over the fit with fewer effects",
    "change": "of the output over the rms residual",
    "error": "rms, over that without",
    "t": "of the effect missed least",
}
"""What the columns of the combinations that were not taken say."""


def format_why(why: Why, columns: int | None = None) -> str:
    """Format the explanation of a verdict as text.

    Parameters
    ----------
    why : Why
    columns : int, optional
        Characters of a line, by default those of the terminal.
    """
    wide = min(max(columns or shutil.get_terminal_size().columns, WIDTHS[0]), WIDTHS[1])
    lines = ["", "WHY", ""]
    for number, stage in enumerate(why.stages, 1):
        lines += [*_stage(number, stage, wide), ""]
    named = f" ({joined(why.names)})" if why.names else ""
    return "\n".join([*lines, *_wrapped(f"Verdict {why.verdict}{named}: {MEANINGS[why.verdict]}.", wide, "")])


def _stage(number: int, stage: Stage, wide: int) -> Iterator[str]:
    yield from _wrapped(f"{number}. {stage.question}", wide, "")
    for gate in stage.gates:
        yield from _gate(gate, wide)
    for probability in stage.probabilities:
        yield from _probability(probability, wide)
    if stage.not_taken:
        yield from _not_taken(stage, wide)
    yield from _wrapped(f"=> {stage.result}", wide, "   ", 3)


def _gate(gate: Gate, wide: int) -> Iterator[str]:
    mark = "pass" if gate.passed else "FAIL"
    limit = gate.threshold
    text = f"{mark}  {gate.name}: {_number(gate.value)}, {gate.relation} {_number(limit.value)} needed [{limit.place}]"
    yield from _wrapped(text, wide, "   ", 6)
    yield from _wrapped(gate.meaning, wide, 9 * " ")


def _probability(found: Probability, wide: int) -> Iterator[str]:
    what = f"probability of {found.of}" if found.of else "probability that nothing else acts"
    text = (
        f"{what}, by its evidence: {_number(found.value)}. It is 1/(1 + exp(-s)), s = {found.total:.2f} the sum of "
        f"{found.prior.value:g} [{found.prior.place}] and evidence x weight [{found.weights}]:"
    )
    yield from _wrapped(text, wide, "   ", 6)
    for measure, value, weight in found.terms:
        if not value and measure != "agreement":
            continue
        start = f"{value * weight:6.2f} = {value:5.2f} x {weight:5.2f}  {measure:<10}"
        yield from _wrapped(f"{start}  {EVIDENCE[measure]}", wide, 9 * " ", len(start) + 2)
    zero = [measure for measure, value, _ in found.terms if not value and measure != "agreement"]
    if zero:
        yield from _wrapped(f"{'0.00':>6}           {', '.join(zero)}", wide, 9 * " ", 24)


def _not_taken(stage: Stage, wide: int) -> Iterator[str]:
    legend = "; ".join(f"{title}: {LEGEND[title]}" for title in stage.columns)
    yield from _wrapped(f"Best combinations that were not taken ({legend}):", wide, "   ")
    yield 9 * " " + "".join(f"{title:>9}" for title in stage.columns)
    for one in stage.not_taken:
        figures = "".join(f"{_cell(value):>9}" for value in one.figures)
        yield from _wrapped(f"{figures}  {' + '.join(one.names)}: {one.reason}", wide, 9 * " ", len(figures) + 2)


def _number(value: float) -> str:
    """Up to three significant digits, and whole numbers with separators of thousands."""
    if not isfinite(value):
        return f"{value:g}"
    return f"{value:,.0f}" if abs(value) >= 100.0 else f"{value:.3g}" if abs(value) >= 1e-3 else f"{value:.1g}"


def _cell(value: float) -> str:
    if not isfinite(value):
        return "-"
    digits = 0 if abs(value) >= 100.0 else 1 if abs(value) >= 10.0 else 3
    return f"{round(value, digits) + 0.0:,.{digits}f}"  # no negative zero


def _wrapped(text: str, wide: int, indent: str, more: int = 0) -> list[str]:
    """Lines of a text, the first indented by `indent`, the others by `more` characters further."""
    for sign in "<>=":  # no line break between a relation and its threshold
        text = text.replace(f"{sign} ", f"{sign}\u00a0")
    lines = wrap(
        text,
        wide,
        initial_indent=indent,
        subsequent_indent=indent + more * " ",
        break_long_words=False,
        break_on_hyphens=False,
    )
    return [line.replace("\u00a0", " ") for line in lines]
