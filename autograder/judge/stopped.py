"""What explains an error that stopped a student's code, for the feedback: as in the notebook, but redacted."""

from collections.abc import Mapping
from typing import Any

from labsid.checks.python_errors import details
from labsid.checks.stops import unpacked


def explained(error: Mapping[str, Any], source: str) -> str:
    """What stands in the line that stopped, and the usual cause; empty if nothing is known.

    Parameters
    ----------
    error : mapping
        As the student's process describes it.
    source : str
        The student's cells. Of what the process says, only what stands there is repeated, and sizes of arrays.
    """
    text = str(error.get("text", ""))
    return details(unpacked(error.get("stop"), str(error.get("kind")), text, lambda said: said in source))
