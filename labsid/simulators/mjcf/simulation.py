"""A model of MuJoCo as a simulation."""

from collections.abc import Mapping

import numpy as np

from labsid._arrays import FloatArray
from labsid.simulators.mjcf.one_joint import PREFIX, OneJoint
from labsid.simulators.mjcf.opening import open_model
from labsid.simulators.mjcf.playing import Player
from labsid.simulators.mjcf.sources import MjcfSource
from labsid.simulators.simulator import Simulator

MOST = 1e9
PLAYS = ("play", "seen_play")  # changes that the model as it is loaded cannot make
FREE_SIGN = (":springref", ":stiffness", ":cubic")  # numbers that may be negative
CONTACTS = PREFIX + "contacts"
"""Among the numbers of a run: the output is the pair of geoms in contact at each sample, or -1.

With several outputs each of them is.
"""


def open_mjcf(source: MjcfSource) -> Simulator:
    """Open a model of one joint, or of several.

    Raises
    ------
    ValueError
        If it cannot be opened.
    """
    player = Player(open_model(source))
    opened = player.opened

    def run(t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> FloatArray:
        if CONTACTS in numbers:
            pairs = np.asarray(player.play(t, u, numbers)[1], float)
            return (
                pairs if isinstance(player.one, OneJoint) else np.repeat(pairs[:, None], len(player.one.names), axis=1)
            )
        if any(value and name.rpartition(":")[2].removeprefix(PREFIX) in PLAYS for name, value in numbers.items()):
            return player.one.run(t, u, numbers)  # the model of MuJoCo has no joint for a play
        return player.run(t, u, numbers)

    nominal = player.one.nominal()
    ranges = {name: (0.0, MOST) for name, value in nominal.items() if value >= 0.0 and not name.endswith(FREE_SIGN)}
    label = f"{source.path.name}:{opened.source.actuator}:{opened.source.output}"
    signals = (
        {}
        if isinstance(player.one, OneJoint)
        else {
            "inputs": tuple(opened.joints[place].actuator_name for place in opened.inputs),
            "outputs": player.one.names,
        }
    )
    return Simulator(
        run,
        label,
        nominal,
        ranges=ranges,
        source=str(opened.source),
        joint=player.one,
        **signals,  # type: ignore[arg-type]
    )
