"""The content of a figure as plain data, independent of matplotlib."""

from dataclasses import dataclass

from labsid._arrays import FloatArray, freeze


@dataclass(frozen=True, slots=True, eq=False)
class CurveValue:
    """One curve: data, colour (red, green, blue), whether it is drawn in steps, and legend text."""

    x: FloatArray
    y: FloatArray
    color: tuple[float, float, float]
    steps: bool
    label: str

    def __post_init__(self) -> None:
        freeze(self, x=self.x, y=self.y)


@dataclass(frozen=True, slots=True, eq=False)
class AxesValue:
    """Content of one set of axes."""

    title: str
    xlabel: str
    ylabel: str
    xlim: tuple[float, float]
    ylim: tuple[float, float]
    grid: bool
    legend: tuple[str, ...]
    texts: tuple[str, ...]
    curves: tuple[CurveValue, ...]


@dataclass(frozen=True, slots=True, eq=False)
class FigureValue:
    """Content of a figure: its axes from top to bottom and from left to right."""

    axes: tuple[AxesValue, ...]
