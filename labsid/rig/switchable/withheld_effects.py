"""The effects that a withheld rig may have: what everybody may know of it."""

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
"""Where in the loop each effect acts."""

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
"""Their parameters, in volts and seconds; ``empty`` is what the sensor would show of an empty tank."""

STAND_IN_STUDENT = "nobody"
"""Whose record a course without individual data hands to everybody."""

RECORD_FILE = "WithheldRig.csv"
"""Name of the record beside the notebook."""
