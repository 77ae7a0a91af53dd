"""Input signals of several inputs, which move independently of each other, together or one at a time."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.rig.switchable.inputs import draw_input

TURNS = 2
"""Times that each input moves, where they move one at a time."""

ONE_AT_A_TIME = "one at a time"


def draw_inputs(
    rng: np.random.Generator, kinds: tuple[str, ...], count: int, samples: int, time: float, in_turn: bool
) -> FloatArray:
    """Draw a signal for each input.

    Parameters
    ----------
    rng : Generator
    kinds : tuple of str
        Of `labsid.rig.switchable.inputs.INPUT_KINDS`, of which one is drawn for each input.
    count : int
        Number of inputs.
    samples : int
    time : float
        Time scale of the rig in samples.
    in_turn : bool
        Whether only one input moves at a time; the others hold their rest level.

    Returns
    -------
    ndarray, shape (samples, count)
        Within [-1, 1].
    """
    from_rest = bool(rng.random() < 0.6)
    v = np.column_stack([draw_input(rng, str(rng.choice(kinds)), samples, time, from_rest) for _ in range(count)])
    if in_turn:
        turn = np.arange(samples) * TURNS * count // samples % count
        v = np.where(turn[:, np.newaxis] == np.arange(count), v, 0.0)
    return v
