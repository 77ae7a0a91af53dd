"""What the tests of the figures ask of any figure."""

import matplotlib as mpl
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch
from matplotlib.path import Path
from matplotlib.text import Text
from matplotlib.transforms import Bbox


@pytest.fixture
def covered():
    """Function: which texts and legends of a laid-out figure lie on a curve, an arrow or another text."""
    return _covered


@pytest.fixture(autouse=True)
def untouched_matplotlib():
    """Hold every test of a figure to leaving the global settings as they were."""
    before = dict(mpl.rcParams)
    yield
    assert dict(mpl.rcParams) == before


def _covered(figure: Figure) -> list[str]:
    figure.draw_without_rendering()
    found = []
    for ax in figure.axes:
        boxes = [(text.get_text(), _extent(text)) for text in ax.texts]
        legend = ax.get_legend()
        if legend is not None:
            boxes.append(("legend", legend.get_window_extent()))
        paths = [line.get_transform().transform_path(line.get_path()) for line in ax.lines]
        paths += [_arrow_path(patch) for patch in ax.patches if isinstance(patch, FancyArrowPatch)]
        for i, (name, box) in enumerate(boxes):
            found += [f"{name!r} on a curve" for path in paths if path.intersects_bbox(box, filled=False)]
            found += [f"{name!r} on {other!r}" for other, its in boxes[:i] if Bbox.intersection(box, its)]
            if not _within(box, figure.bbox):
                found.append(f"{name!r} leaves the figure")
    return found


def _arrow_path(arrow: FancyArrowPatch) -> Path:
    path = arrow.get_transform().transform_path(arrow.get_path())
    # The vertex of a closing code is a placeholder at the origin; it would count as passed through.
    real = path.codes != Path.CLOSEPOLY
    return Path(path.vertices[real], path.codes[real])


def _extent(text: Text) -> Bbox:
    patch = text.get_bbox_patch()
    return text.get_window_extent() if patch is None else patch.get_window_extent()


def _within(box: Bbox, outer: Bbox) -> bool:
    return outer.x0 <= box.x0 and outer.y0 <= box.y0 and box.x1 <= outer.x1 and box.y1 <= outer.y1
