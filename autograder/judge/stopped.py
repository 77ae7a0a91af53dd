"""What explains an error that stopped a student's code, for the feedback: as in the notebook, but redacted."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from labsid.checks.mended_functions import Mend
from labsid.checks.python_errors import details
from labsid.checks.stops import unpacked


def explained(error: Mapping[str, Any], source: str, outcome: Callable[[Mend], str] | None = None) -> str:
    """What stands in the line that stopped, and the usual cause; empty if nothing is known.

    Parameters
    ----------
    error : mapping
        As the student's process describes it.
    source : str
        The student's cells. Of what the process says, only what stands there is repeated, and sizes of arrays.
    outcome : callable, optional
        ``outcome(mend)``, which tries a repair before it is proposed; see `Stop`.
    """
    text = str(error.get("text", ""))
    stop = unpacked(error.get("stop"), str(error.get("kind")), text, lambda said: said in source)
    return details(replace(stop, outcome=outcome))
