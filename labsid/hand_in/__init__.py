"""What students do around the notebooks: get them, see how far they are, and hand them in.

The only room that needs Jupyter, and only while `labsid submit` runs the notebooks.
"""

from labsid.hand_in.from_notebook import fetch_feedback, submit
from labsid.hand_in.progress import show_progress

__all__ = ["fetch_feedback", "show_progress", "submit"]
