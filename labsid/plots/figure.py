"""A figure with its own notebook representation."""

from base64 import b64encode
from collections.abc import Collection
from html import escape
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
    ) -> dict[str, str]:
        """The image as HTML with its description, if there is one: for a bare image, notebooks show none."""
        if not self.alt:
            return {}
        data = b64encode(self._repr_png_()).decode("ascii")
        return {
            "text/html": f'<img alt="{escape(self.alt)}" src="data:image/png;base64,{data}" style="max-width: 100%">'
        }
