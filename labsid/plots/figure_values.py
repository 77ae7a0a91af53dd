"""A figure as plain data: what a reader sees in it, without matplotlib."""

from dataclasses import dataclass

from labsid._arrays import FloatArray, freeze


@dataclass(frozen=True, slots=True, eq=False)
class CurveValue:
    """One drawn curve: its data, colour (red, green, blue), whether it is drawn in steps, and its legend text."""

    x: FloatArray
    y: FloatArray
    color: tuple[float, float, float]
    steps: bool
    label: str

    def __post_init__(self) -> None:
        freeze(self, x=self.x, y=self.y)


@dataclass(frozen=True, slots=True, eq=False)
class AxesValue:
    """One pair of axes of a figure as a reader sees it."""

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
    """A figure: its axes from top to bottom, left to right."""

    axes: tuple[AxesValue, ...]
