"""A figure with its own notebook representation."""

from collections.abc import Collection
from io import BytesIO

from matplotlib.figure import Figure


class ShownFigure(Figure):
    """A matplotlib figure that a notebook displays as an image.

    IPython displays figures only after pyplot has created one or ``%matplotlib inline`` has run. Without either, a
    figure would appear as one line of text.

    Attributes
    ----------
    alt : str
        Description for readers who do not see the image; empty if the text beside the figure describes it.
    """

    alt: str = ""

    def _repr_png_(self) -> bytes:
        buffer = BytesIO()
        self.savefig(buffer, format="png", dpi=100)
        return buffer.getvalue()

    def _repr_mimebundle_(
        self, include: Collection[str] | None = None, exclude: Collection[str] | None = None
    ) -> tuple[dict[str, bytes], dict[str, dict[str, str]]]:
        """The image with its description; the inline backend replaces the image and keeps the description."""
        if not self.alt:
            return {}, {}
        return {"image/png": self._repr_png_()}, {"image/png": {"alt": self.alt}}
