"""What students do around the notebooks: get them, see how far they are, and hand them in.

The only room that needs Jupyter, and only while `labsid submit` runs the notebooks.
"""

from labsid.hand_in.progress import show_progress

__all__ = ["show_progress"]
