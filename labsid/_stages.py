"""Progress over stages whose number is not known before: one share that never falls."""

from collections.abc import Callable

STAGE = 0.35  # of what is left, taken by each stage: a diagnosis has two to eight


def over_stages(show: Callable[[str, float], None]) -> Callable[[str, float], None]:
    """Pass on descriptions with the share of all stages in the place of that of one.

    Parameters
    ----------
    show : callable
        ``show(step, share)``, whose share never falls then, and stays below 1.

    Returns
    -------
    callable
        ``passed(step, share)``, with the completed share of the current stage; a smaller one begins another stage.

    Notes
    -----
    How many stages a search has is decided by what it finds, so that no time that remains can be told from the share.
    """
    begun, last = 0.0, 0.0

    def passed(step: str, share: float) -> None:
        nonlocal begun, last
        if share < last:
            begun += STAGE * (1.0 - begun) * last
        last = share
        show(step, begun + STAGE * (1.0 - begun) * share)

    return passed
