"""A figure that a notebook shows as it is."""

from io import BytesIO

from matplotlib.figure import Figure


class ShownFigure(Figure):
    """A matplotlib figure that knows its own picture.

    IPython learns to show figures only when pyplot makes one or ``%matplotlib inline`` has run; importing
    pyplot is not enough, and a figure made without it would appear as one line of text.
    """

    def _repr_png_(self) -> bytes:
        picture = BytesIO()
        self.savefig(picture, format="png", dpi=100)
        return picture.getvalue()
