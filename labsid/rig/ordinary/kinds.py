"""The kinds of ordinary records."""

from collections.abc import Callable
from functools import partial

import numpy as np

from labsid.rig.ordinary.commands import draw_coarse_command, draw_coarse_log, draw_command_off
from labsid.rig.ordinary.exact import FORMS, draw_exact
from labsid.rig.ordinary.free_numbers import draw_free_far, draw_free_idle, draw_free_pair
from labsid.rig.ordinary.measured import (
    DIRECT,
    draw_clipped,
    draw_direct,
    draw_integrator,
    draw_plain,
    draw_slow_noise,
)
from labsid.rig.ordinary.record_files import OrdinaryRecord
from labsid.rig.ordinary.simulations import (
    draw_itself_function,
    draw_itself_json,
    draw_itself_output,
    draw_simulated_output,
)

DrawKind = Callable[[np.random.Generator], OrdinaryRecord | None]

KINDS: dict[str, DrawKind] = {
    **{kind: partial(draw_direct, kind=kind) for kind in DIRECT},
    **{kind: partial(draw_exact, kind=kind) for kind in FORMS},
    "itself-json": draw_itself_json,
    "itself-output": partial(draw_itself_output, other_times=False),
    "itself-output-other-times": partial(draw_itself_output, other_times=True),
    "itself-function": partial(draw_itself_function, free=False),
    "itself-free": partial(draw_itself_function, free=True),
    "coarse-log": draw_coarse_log,
    "coarse-command": draw_coarse_command,
    "command-off": partial(draw_command_off, for_a_while=False),
    "command-off-for-a-while": partial(draw_command_off, for_a_while=True),
    "simulated-output-limit": partial(draw_simulated_output, limited=True),
    "simulated-output-none": partial(draw_simulated_output, limited=False),
    "free-far": draw_free_far,
    "free-pair": draw_free_pair,
    "free-idle": draw_free_idle,
    "clipped-one-side": partial(draw_clipped, both=False),
    "clipped-both-sides": partial(draw_clipped, both=True),
    "slow-noise": draw_slow_noise,
    "integrating": draw_integrator,
    "plain": draw_plain,
}
"""A draw that fails returns None and is to be repeated."""
