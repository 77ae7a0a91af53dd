"""Names of MuJoCo models: FILE.xml, the actuator that takes the input and the joint or sensor that gives the output."""

import re
from dataclasses import dataclass
from pathlib import Path

SUFFIXES = (".xml", ".mjcf", ".urdf")
TRUSTED = "trust"
_PATTERN = re.compile(r"^(.+?\.(?:xml|mjcf|urdf))(?::(.*))?$", re.IGNORECASE | re.DOTALL)


@dataclass(frozen=True, slots=True)
class MjcfSource:
    """A model and its signals.

    Attributes
    ----------
    path : Path
    actuator, output : str
        Names, of several with commas between; empty for the only one, or for all joints with an actuator.
    trusted : bool
        Whether files outside its folder and plugins are allowed.
    """

    path: Path
    actuator: str = ""
    output: str = ""
    trusted: bool = False

    @property
    def actuators(self) -> tuple[str, ...]:
        """Names of the actuators that take the inputs."""
        return _names(self.actuator)

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs."""
        return _names(self.output)

    def __str__(self) -> str:
        """The source as `parse_mjcf` reads it."""
        parts = [str(self.path), self.actuator, self.output, TRUSTED if self.trusted else ""]
        return ":".join(parts).rstrip(":")


def _names(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",")) if text else ()


def is_mjcf(text: str) -> bool:
    """Whether `text` names a model of MuJoCo."""
    return parse_mjcf(text) is not None


def parse_mjcf(text: str) -> MjcfSource | None:
    """Read ``FILE.xml:ACTUATOR:OUTPUT:trust``, of which only the file is needed; None for another source."""
    found = _PATTERN.match(text)
    if found is None:
        return None
    names = (found[2] or "").split(":")
    actuator, output, trust = (*names, "", "", "")[:3]
    return MjcfSource(Path(found[1]), actuator, output, trust == TRUSTED)
