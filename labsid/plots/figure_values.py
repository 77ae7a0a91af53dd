"""The content of a figure as plain data, independent of matplotlib."""

from dataclasses import dataclass

from labsid._arrays import FloatArray, freeze


@dataclass(frozen=True, slots=True, eq=False)
class CurveValue:
    """One curve, or one row of points or bars.

    Attributes
    ----------
    x, y : ndarray, shape (N,)
    color : tuple of float
        Red, green and blue, 0 to 1.
    steps : bool
        Whether it is drawn in steps.
    label : str
        Its legend text.
    where : str
        Where a step changes, as in ``step``: "pre", "mid" or "post"; "" if it is not drawn in steps.
    joined : bool
        Whether lines join its points.
    style : str
        Line style, marker and width, as matplotlib has them; "" if it is no line.
    """

    x: FloatArray
    y: FloatArray
    color: tuple[float, float, float]
    steps: bool
    label: str
    where: str = ""
    joined: bool = False
    style: str = ""

    def __post_init__(self) -> None:
        freeze(self, x=self.x, y=self.y)


@dataclass(frozen=True, slots=True, eq=False)
class AxesValue:
    """Content of one set of axes.

    `is_listed` says whether the entries of its legend were given to ``legend([...])``, and are labels of no curve.
    """

    title: str
    xlabel: str
    ylabel: str
    xlim: tuple[float, float]
    ylim: tuple[float, float]
    grid: bool
    legend: tuple[str, ...]
    texts: tuple[str, ...]
    curves: tuple[CurveValue, ...]
    is_listed: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class FigureValue:
    """Content of a figure: its axes from top to bottom and from left to right."""

    axes: tuple[AxesValue, ...]
