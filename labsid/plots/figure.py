"""A figure with its own notebook representation."""

from io import BytesIO

from matplotlib.figure import Figure


class ShownFigure(Figure):
    """A matplotlib figure that a notebook displays as an image.

    IPython displays figures only after pyplot has created one or ``%matplotlib inline`` has run. Without either, a
    figure would appear as one line of text.
    """

    def _repr_png_(self) -> bytes:
        buffer = BytesIO()
        self.savefig(buffer, format="png", dpi=100)
        return buffer.getvalue()
