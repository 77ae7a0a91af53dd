"""A model of MuJoCo as a simulation."""

from collections.abc import Mapping

import numpy as np

from labsid._arrays import FloatArray
from labsid.simulators.mjcf.one_joint import PREFIX
from labsid.simulators.mjcf.opening import open_model
from labsid.simulators.mjcf.playing import Player
from labsid.simulators.mjcf.sources import MjcfSource
from labsid.simulators.simulator import Simulator

MOST = 1e9
FREE_SIGN = (":springref", ":stiffness", ":cubic")  # numbers that may be negative
CONTACTS = PREFIX + "contacts"
"""Among the numbers of a run: the output is the pair of geoms in contact at each sample, or -1."""


def open_mjcf(source: MjcfSource) -> Simulator:
    """Open a model of one joint.

    Raises
    ------
    ValueError
        If it cannot be opened.
    """
    player = Player(open_model(source))

    def run(t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> FloatArray:
        if CONTACTS in numbers:
            return np.asarray(player.play(t, u, numbers)[1], float)
        return player.run(t, u, numbers)

    nominal = player.one.nominal()
    ranges = {name: (0.0, MOST) for name, value in nominal.items() if value >= 0.0 and not name.endswith(FREE_SIGN)}
    label = f"{source.path.name}:{player.opened.actuator_name}:{player.opened.source.output}"
    return Simulator(run, label, nominal, ranges=ranges, source=str(player.opened.source), joint=player.one)
