"""Public facts of the assignment ``sim-to-real-gap``: the effects that a withheld rig may have, and its file name."""

from collections.abc import Mapping

EFFECT_PATHS: Mapping[str, str] = {
    "input-delay": "input",
    "input-saturation": "input",
    "input-dead-zone": "input",
    "input-nonlinearity": "input",
    "sqrt-outflow": "dynamics",
    "overflow": "dynamics",
    "output-saturation": "output",
    "output-nonlinearity": "output",
}
"""Part of the loop in which each effect acts."""

EFFECT_PARAMETERS: Mapping[str, tuple[str, ...]] = {
    "input-delay": ("delay",),
    "input-saturation": ("low", "high"),
    "input-dead-zone": ("low", "high"),
    "input-nonlinearity": ("c2",),
    "sqrt-outflow": ("empty",),
    "overflow": ("level",),
    "output-saturation": ("low", "high"),
    "output-nonlinearity": ("c2",),
}
"""Parameters of each effect in volts and seconds; ``empty`` is the sensor voltage of an empty tank."""

STAND_IN_STUDENT = "nobody"
"""Student ID of the shared record, for courses without individual data."""

RECORD_FILE = "WithheldRig.csv"
"""File name of the record beside the notebook."""
