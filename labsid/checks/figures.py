"""Checks of what a figure shows; each `require_` function raises `NoAnswer` with what is missing."""

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray
from labsid.checks.compare import as_figure
from labsid.checks.relations import relation
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer
from labsid.plots.figure_values import AxesValue, CurveValue

_SYMBOLS = frozenset("abcdekpqrtuvwxyz12345Y")
"""Single characters that name a signal, a parameter or an order."""


def one_figure(name: str, value: Value) -> AxesValue:
    """Read a figure whose curves may stand in one panel or in several: all of its panels as one.

    An axis counts as labelled if it is labelled wherever it needs to be: the y-axis of each panel that shows something,
    the x-axis of the lowest.
    """
    panels = [axes for axes in as_figure(name, value).axes if axes.curves]
    if not panels:
        raise NoAnswer(f"`{name}` is empty: draw in its axes.", "empty axes")
    ylabels = [axes.ylabel for axes in panels]
    return AxesValue(
        title=" ".join(axes.title for axes in panels),
        xlabel=panels[-1].xlabel,
        ylabel=" ".join(ylabels) if all(label.strip() for label in ylabels) else "",
        xlim=panels[0].xlim,
        ylim=panels[0].ylim,
        grid=all(axes.grid for axes in panels),
        legend=tuple(text for axes in panels for text in axes.legend),
        texts=tuple(text for axes in panels for text in axes.texts),
        curves=tuple(curve for axes in panels for curve in axes.curves),
        is_listed=any(axes.is_listed for axes in panels),
    )


def find_curve(axes: AxesValue, y: ArrayLike, x: ArrayLike | None = None) -> CurveValue | None:
    """The curve that shows these data; one drawn by ``stairs`` may lack the last sample."""
    wanted = np.asarray(y, float).reshape(-1)
    abscissa = None if x is None else np.asarray(x, float).reshape(-1)
    for curve in axes.curves:
        n = curve.y.size
        if n < 2 or not wanted.size - 1 <= n <= wanted.size:
            continue
        right_y = _agree(curve.y, wanted[:n])
        if right_y and (abscissa is None or _agree(curve.x, abscissa[:n])):
            return curve
    return None


def require_curve(
    axes: AxesValue,
    where: str,
    what: str,
    y: ArrayLike,
    x: ArrayLike | None = None,
    others: Mapping[str, ArrayLike] = MappingProxyType({}),
) -> CurveValue:
    """Require a curve of `y` (against `x`) and return it.

    `where` and `what` name the axes and the signal; `others` are signals that may have been drawn in its place.
    """
    curve = find_curve(axes, y, x)
    if curve is not None:
        return curve
    drawn = None if x is None else find_curve(axes, y)
    if drawn is not None:
        times = np.asarray(x, float).reshape(-1)[: drawn.x.size]
        for factor, unit in UNITS_OF_TIME:
            if _agree(drawn.x * factor, times):
                raise NoAnswer(
                    f"In {where}, {what} is drawn against the time in {unit}: give the time vector itself, in seconds.",
                    "another unit of time",
                )
        counted = _agree(drawn.x, np.arange(drawn.x.size, dtype=float))
        raise NoAnswer(
            f"In {where}, {what} is drawn against {'the sample number' if counted else 'another vector'}, and not "
            f"against time: give the time vector as the first argument.{'' if counted else _of_times(drawn.x, times)}",
            "drawn against the sample number" if counted else "drawn against another vector",
        )
    for name, other_curve in others.items():
        if len([curve for curve in axes.curves if find_curve(replace(axes, curves=(curve,)), other_curve)]) > 1:
            raise NoAnswer(f"In {where} no curve shows {what}, and two show `{name}`.", "one signal drawn twice")
    raise no_curve(axes, where, what, np.asarray(y, float).reshape(-1), "Plot it against time.")


UNITS_OF_TIME = ((60.0, "minutes"), (3600.0, "hours"), (1e-3, "milliseconds"))
"""Seconds in each, and its name."""


def _of_times(x: FloatArray, times: FloatArray) -> str:
    """How a vector is related to the times, behind a sentence; empty where nothing simple relates them."""
    said = relation(x, times, _agree, "the vector beside the times")
    return f" {said}" if said else ""


def no_curve(axes: AxesValue, where: str, what: str, wanted: FloatArray, advice: str) -> NoAnswer:
    """What to say where no curve shows a signal: what is drawn in its place, if that can be told, else the advice."""
    samples = wanted.size
    if any(1 < curve.x.size <= samples and _agree(curve.x, wanted[: curve.x.size]) for curve in axes.curves):
        text = f"In {where}, {what} is on the horizontal axis: what is given to `plot` first goes there."
        return NoAnswer(text, "x and y swapped")
    if samples > 1 and len(axes.curves) >= samples - 1 and all(curve.y.size < samples for curve in axes.curves):
        text = f"In {where} there is a curve for each *row* of the table: each column is a curve, over all samples."
        return NoAnswer(text, "rows drawn")
    few = (curve.y for curve in axes.curves if 1 < curve.y.size <= samples / 10)
    row = next((y for y in few if np.isin(y[y != 0], wanted).any()), None)
    if row is not None:
        text = (
            f"In {where} no curve shows {what}: one has {row.size} points in place of {samples}. Of a table, `[0]` is "
            "the first *row* and `[:, 0]` the first column."
        )
        return NoAnswer(text, "rows drawn")
    related = next(filter(None, (relation(curve.y, wanted, _agree) for curve in axes.curves)), "")
    related += " Such a constant is an offset." if "constant added" in related else ""
    near = f"In {where} no curve shows {what}. One curve is related to it: {related[:1].lower()}{related[1:]}"
    return NoAnswer(near if related else f"In {where} no curve shows {what}. {advice}", "no curve")


def require_labels(axes: AxesValue, where: str, units: tuple[str, str]) -> None:
    """Require both axis labels, with the units `units` (x, y), such as ``("s", "V")``, in brackets."""
    for axis, unit in zip("xy", units, strict=True):
        require_label(axes, where, axis, unit)


def require_label(axes: AxesValue, where: str, axis: str, unit: str) -> None:
    """Require the label of one axis, "x" or "y", with its unit in brackets unless `unit` is empty."""
    label = axes.xlabel if axis == "x" else axes.ylabel
    if not label.strip():
        raise NoAnswer(f"In {where} the {axis}-axis has no label: use `set_{axis}label`.", "axis without a label")
    if unit and not _has_unit(label, unit):
        if _has_unit(axes.ylabel if axis == "x" else axes.xlabel, unit):
            raise NoAnswer(f"In {where} the labels of the two axes are swapped.", "axis labels swapped")
        has, slip = ("another unit than the signal", "another unit") if re.search(r"[(\[]", label) else ("no unit",) * 2
        raise NoAnswer(f"In {where} the {axis}-label {label!r} has {has}: write it as ({unit}).", slip)


_SPELLED_OUT = "s", "V"  # of which (seconds) and (Volts) are accepted


def _has_unit(label: str, unit: str) -> bool:
    ends = "" if unit in _SPELLED_OUT else r"(?![^\W\d_])"  # (mm) is not in m
    pattern = rf"[(\[/,][\s$]*(?:\\(?:mathrm|text)\s*{{?)?{re.escape(unit)}{ends}"
    return re.search(pattern, label, re.IGNORECASE) is not None


def require_here(check: Callable[[AxesValue], object], axes: AxesValue, beside: AxesValue | None, ax: str) -> None:
    """Check one of two panels; where it fails and the panel `beside` it would pass, the message says that, too.

    `ax` is the name of the axes that should be set.
    """
    try:
        check(axes)
    except NoAnswer as failed:
        if beside is None or not _passes(check, beside):
            raise
        raise NoAnswer(
            f"{failed} The other panel has that. Each panel is set through its own axes, this one through `{ax}`. "
            "(`plt.xlim` and the like set the panel that was made last.)",
            failed.slip,
        ) from None


def _passes(check: Callable[[AxesValue], object], axes: AxesValue) -> bool:
    try:
        check(axes)
    except NoAnswer:
        return False
    return True


def require_grid(axes: AxesValue, where: str) -> None:
    """Require a grid."""
    if not axes.grid:
        raise NoAnswer(f"{where} has no grid: call `grid(True)`.", "no grid")


def require_limits(axes: AxesValue, where: str, xlim: tuple[float, float], ylim: tuple[float, float]) -> None:
    """Require the axis limits of the printed figure."""
    for name, got, wanted in (("x", axes.xlim, xlim), ("y", axes.ylim, ylim)):
        if not np.allclose(got, wanted, atol=1e-9):
            raise NoAnswer(
                f"In {where} the {name}-axis runs from {got[0]:g} to {got[1]:g}; it should run from {wanted[0]:g} to "
                f"{wanted[1]:g}: use `set_{name}lim`.",
                "axis limits",
            )


def require_legend(axes: AxesValue, where: str, entries: int) -> None:
    """Require a legend with at least `entries` entries that tell the curves apart."""
    texts = [text.strip() for text in axes.legend if text.strip()]
    labels = {curve.label.strip() for curve in axes.curves if not curve.label.startswith("_")} - {""}
    asked = f"In {where} the legend should name {entries} curves"
    if axes.is_listed and _is_a_text_taken_apart(texts):
        letters = " and ".join(map(repr, texts[:2]))
        raise NoAnswer(
            f"{asked}, and its entries are single letters, {letters}: `legend` was given one text, whose letters name "
            'the curves. It takes a list, `legend(["...", "..."])`, or nothing where each curve has a `label`.',
            "one text for the legend",
        )
    if len(texts) >= entries and len(set(texts)) < entries:
        same = next(text for text in texts if texts.count(text) > 1)
        raise NoAnswer(
            f"{asked}, and {texts.count(same)} of its entries are {same!r}: give each curve a name of its own. (One "
            "`label` for a table names all its columns alike: draw them one by one, or give a list of names.)",
            "names not told apart",
        )
    if len(texts) >= entries:
        return
    if not texts and len(labels) >= entries:
        raise NoAnswer(
            f"{asked}. {len(labels)} curves have a `label`, but the axes show no legend: `legend` of these axes is to "
            "be called after the curves are drawn.",
            "no legend",
        )
    if texts and axes.is_listed:
        handed = "one text" if len(texts) == 1 else f"{len(texts)} texts"
        raise NoAnswer(
            f"{asked}, and it names {len(texts)}: `legend([...])` was given {handed}, for the curves in the order in "
            "which they are drawn. Give it one for each curve, or give each curve a `label` and call `legend()`.",
            "fewer texts than curves",
        )
    if texts and len(labels) >= entries:
        raise NoAnswer(
            f"{asked}, and it names {len(texts)}, though {len(labels)} curves have a `label`: was `legend` called "
            "before the others were drawn, or given fewer texts than there are curves? Call `legend()` last.",
            "no legend",
        )
    if texts:
        raise NoAnswer(f"{asked}, and it names {len(texts)}: each curve needs a `label`.", "no legend")
    raise NoAnswer(f"{asked}: give each a `label` and call `legend`.", "no legend")


def _is_a_text_taken_apart(texts: list[str]) -> bool:
    """Whether the entries are the letters of one text: single ones that are not all symbols of signals."""
    return len(texts) > 1 and all(len(text) == 1 for text in texts) and not set(texts) <= _SYMBOLS


def legend_text(axes: AxesValue, curve: CurveValue) -> str:
    """Legend entry of a curve: its label, or the entry of the same rank if ``legend`` was given the texts."""
    if curve.label in axes.legend:
        return curve.label
    # `is`: records that contain arrays have no equality
    rank = next(i for i, other in enumerate(axes.curves) if other is curve)
    return axes.legend[rank] if rank < len(axes.legend) else ""


def plain_text(text: str) -> str:
    """A label without mathtext markup and spaces: ``$\\sin(0.02\\pi t)$`` is ``sin(0.02πt)``."""
    for mark, letter in ((r"\pi", "π"), (r"\tau", "τ"), (r"\phi", "φ"), (r"\theta", "θ"), (r"\cdot", ""), ("*", "")):
        text = text.replace(mark, letter)
    return re.sub(r"\\(?:mathrm|left|right|,|;|\s)|[\\${}\s·]", "", text)


def _agree(a: np.ndarray, b: np.ndarray) -> bool:
    return a.shape == b.shape and bool(np.allclose(a, b, rtol=1e-6, atol=1e-6 * (1e-300 + np.max(np.abs(b)))))
