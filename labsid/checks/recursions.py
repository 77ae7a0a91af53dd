"""The recursion that an output obeys, found from its samples, and how it differs from the one that is asked for.

A recursion with several mistakes at once gives samples that no single mistake gives; its terms can still be told, as
they are the only ones with which the samples agree.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.regressions import sample_name
from labsid.checks.verdict import Verdict

Key = tuple[str, int]
"""A signal's name, and how many samples ago."""
Terms = Mapping[Key, float]

RECURSION = "terms of the recursion"
"""The slip of an output that obeys another recursion."""
_EXACT = 1e-7  # relative: a recursion holds to rounding
_SAME_FACTOR = 1e-5
_ZERO = 1e-6  # relative to the largest factor
_SPARE = 3
"""Equations more than unknowns, below which a fit may be chance."""
_MOST_ROWS = 400


@dataclass(frozen=True, slots=True)
class Factor:
    """A factor of the recursion that is asked for: its `symbol`, with its sign, and its `value`."""

    symbol: str
    value: float


def terms_of(output: tuple[str, FloatArray], signals: Mapping[str, FloatArray], largest: int) -> Terms | None:
    """The factors of past outputs and of other signals with which every sample of an output agrees.

    Parameters
    ----------
    output : (str, ndarray)
        Its name, and its samples, shape (N,).
    signals : mapping
        Other signals by name, shape (N,), of which the present sample counts, too.
    largest : int
        Lag up to which terms are looked for.

    Returns
    -------
    mapping or None
        The terms whose factors are not zero. None if there is no such recursion, or more than one.
    """
    y = output[1]
    if any(signal.size != y.size for signal in signals.values()) or not np.all(np.isfinite(y)):
        return None
    # with more lags than it needs, a recursion and its shifted self are two solutions
    found = (_terms_up_to(output, signals, lag) for lag in range(1, largest + 1))
    return next((terms for terms in found if terms is not None), None)


def _terms_up_to(output: tuple[str, FloatArray], signals: Mapping[str, FloatArray], largest: int) -> Terms | None:
    name, y = output
    keys = [(name, lag) for lag in range(1, largest + 1)]
    keys += [(other, lag) for other in signals for lag in range(largest + 1)]
    rows = slice(largest, min(y.size, largest + _MOST_ROWS))
    held = {name: y, **signals}
    Phi = np.column_stack([held[one][rows.start - lag : rows.stop - lag] for one, lag in keys])
    size = np.maximum(np.max(np.abs(Phi), axis=1), np.abs(y[rows]))  # an unstable run grows without bound
    used = size > 0
    Phi, Y = Phi[used] / size[used, None], y[rows][used] / size[used]
    if len(Phi) < len(keys) + _SPARE:
        return None
    theta, _, rank, _ = np.linalg.lstsq(Phi, Y, rcond=None)
    if rank < len(keys) or np.max(np.abs(Y - Phi @ theta), initial=0.0) > _EXACT:
        return None
    least = _ZERO * float(np.max(np.abs(theta), initial=0.0))
    return {key: float(factor) for key, factor in zip(keys, theta, strict=True) if abs(factor) > least}


def with_recursion(
    verdict: Verdict,
    output: tuple[str, FloatArray],
    signals: Mapping[str, FloatArray],
    asked: Mapping[Key, Factor],
    measured: str = "",
) -> Verdict:
    """A verdict that names no mistake, with the recursion that the answer obeys where that is another one.

    Parameters
    ----------
    verdict : Verdict
    output : (str, ndarray)
        As `terms_of` takes it.
    signals : mapping
    asked : mapping
        The right factors, by signal and lag.
    measured : str
        Which of the signals is the measured output; it is looked for only where the others give no recursion.
    """
    if verdict.passed or verdict.slip is not None:
        return verdict
    largest = max(lag for _, lag in asked) + 1
    inputs = {name: signal for name, signal in signals.items() if name != measured}
    found = terms_of(output, inputs, largest)
    if found is None and measured:
        found = terms_of(output, signals, largest)
    said = "" if found is None else told_of_terms(output[0], found, asked, measured)
    return replace(verdict, reason=said, slip=RECURSION) if said else verdict


def told_of_terms(output: str, found: Terms, asked: Mapping[Key, Factor], measured: str = "") -> str:
    """What recursion an output obeys, and how that differs from the right one; empty where it does not.

    Parameters
    ----------
    output : str
    found : mapping
        What `terms_of` has found.
    asked : mapping
    measured : str

    Returns
    -------
    str
        Empty also where fewer than half of the factors are those of the right one, in any place and with any sign.
    """
    right = {key: factor.value for key, factor in asked.items()}
    known = [factor for factor in found.values() if any(_is_symbol(factor, one) for one in asked.values())]
    if _are_equal(found, right) or 2 * len(known) < len(found):  # another model altogether has factors of its own
        return ""
    names = list(dict.fromkeys(name for name, _ in [*asked, *found]))
    of_measured = {(output, lag): factor for (name, lag), factor in found.items() if name == measured}
    differences: list[str] = []
    turned = {key: value if key[0] == output else -value for key, value in right.items()}
    if _are_equal(found, turned):
        return f"What you computed obeys {output}(k) = {_written(found, asked, {})}: it is right but for its sign."
    if of_measured and not any(name == output for name, _ in found):
        differences.append(
            f"the past outputs in it are the *measured* ones, `{measured}`, so that it predicts one step; a simulation "
            "feeds its own outputs back"
        )
        compared: dict[Key, float] = {key: factor for key, factor in found.items() if key[0] != measured} | of_measured
    else:
        compared = dict(found)
    for name in (one for one in names if one != measured or not of_measured):
        differences += _differences(name, _of(name, compared), _of(name, asked), [*asked.values()])
    equation = _written(found, asked, {measured: output} if of_measured else {})
    because = "; ".join(differences)
    return f"What you computed obeys {output}(k) = {equation}" + (f": {because}." if because else ".")


def _of(name: str, terms: Mapping[Key, object]) -> dict[int, object]:
    return {lag: factor for (one, lag), factor in terms.items() if one == name}


def _are_equal(one: Mapping[Key, float], other: Mapping[Key, float]) -> bool:
    return all(abs(one.get(key, 0.0) - other.get(key, 0.0)) <= _tolerance(other.values()) for key in {*one, *other})


def _tolerance(values: object) -> float:
    return _SAME_FACTOR * max(map(abs, values), default=1.0)  # type: ignore[call-overload]


def _differences(
    name: str, got: Mapping[int, object], asked: Mapping[int, object], known: list[Factor]
) -> Iterator[str]:
    """How the terms of one signal differ, in words."""
    factors = {lag: one for lag, one in asked.items() if isinstance(one, Factor)}
    right = {lag: one.value for lag, one in factors.items()}
    have = {lag: float(one) for lag, one in got.items()}  # type: ignore[arg-type]
    if _same(have, right):
        return
    if not have:
        yield f"{name} is missing"
        return
    if not right:
        yield f"{name} does not belong into it"
        return
    for shift in (0, 1, -1):
        moved = {lag + shift: value for lag, value in right.items()}
        when = {0: "", 1: f"{name} is one sample late", -1: f"{name} is one sample early"}[shift]
        symbols = " and ".join(one.symbol.lstrip("+-") for one in factors.values() if one.symbol)
        turned = {lag: -value for lag, value in moved.items()}
        reversed_ = dict(zip(moved, reversed(moved.values()), strict=True))
        for candidate, what in (
            (moved, ""),
            (turned, f"the sign of {symbols} is the other one"),
            (reversed_, f"{symbols} are exchanged"),
            ({lag: -value for lag, value in reversed_.items()}, f"{symbols} are exchanged, and have the other sign"),
        ):
            if _same(have, candidate):
                yield " and ".join(filter(None, (when, what)))
                return
    missing = [sample_name(name, lag) for lag in factors if lag not in have]
    if missing:
        yield f"{' and '.join(missing)} {'are' if len(missing) > 1 else 'is'} missing"
    for lag, factor in factors.items():
        if lag in have and abs(have[lag] - factor.value) > _tolerance(right.values()):
            written = _symbol(have[lag], known).replace("+ ", "").replace("- ", "-")
            yield f"the factor of {sample_name(name, lag)} is {written} and not {factor.symbol}"
    for lag in sorted(have.keys() - right.keys()):
        yield f"{sample_name(name, lag)} does not belong into it"


def _same(one: Mapping[int, float], other: Mapping[int, float]) -> bool:
    keys = {lag for lag in {*one, *other} if abs(one.get(lag, 0.0)) + abs(other.get(lag, 0.0)) > 0}
    return all(abs(one.get(lag, 0.0) - other.get(lag, 0.0)) <= _tolerance(other.values()) for lag in keys)


def _written(found: Terms, asked: Mapping[Key, Factor], same_as: Mapping[str, str]) -> str:
    """The right-hand side of the recursion, with symbols for the factors that are known."""
    terms = []
    for (name, lag), factor in found.items():
        own = asked.get((same_as.get(name, name), lag))
        symbol = _symbol(factor, [*([own] if own else []), *asked.values()])
        terms.append(f"{symbol} {sample_name(name, lag)}".replace("+ 1 ", "+ ").replace("- 1 ", "- "))
    written = " ".join(terms).removeprefix("+ ")
    return f"-{written.removeprefix('- ')}" if written.startswith("- ") else written


def _is_symbol(factor: float, one: Factor) -> bool:
    """Whether a number is this factor, with either sign."""
    return abs(abs(factor) - abs(one.value)) <= _SAME_FACTOR * abs(one.value)


def _symbol(factor: float, known: list[Factor]) -> str:
    for one in known:
        plain, sign = one.symbol.lstrip("+-") or "1", -1.0 if one.symbol.startswith("-") else 1.0
        if _is_symbol(factor, one):
            return f"{'+' if sign * factor * one.value > 0 else '-'} {plain}"
    return f"{'+' if factor > 0 else '-'} {abs(factor):.4g}"
