"""What every effect says of itself: its name, its path, its parameters, and where the search for them begins."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.data import Data
from labsid.gap.effects.context import Context, Structure
from labsid.gap.plant_form import Parameter
from labsid.gap.plants import Plant

RICHER_FORM_BIC = 12.0  # BIC that a richer form of an effect has to gain over a simpler one


@dataclass(frozen=True, slots=True)
class Effect:
    """Something real that a linear simulation leaves out.

    Attributes
    ----------
    name, path : str
        From the table of effects.
    bic_penalty : dict
        By variant, by how much its BIC has to be the better one before it takes the place of a simpler form.
    variant : str
        Which form of it, where there are several.
    """

    name: ClassVar[str]
    path: ClassVar[str]
    bic_penalty: ClassVar[dict[str, float]] = {}
    variant: str = ""

    @property
    def key(self) -> str:
        """Name and variant, as ranking and export write them."""
        return f"{self.name}/{self.variant}" if self.variant else self.name

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The searched numbers that this effect brings; those inside the plant are the plant's."""
        return ()

    def extend(self, plant: Plant) -> Plant:
        """The plant with this effect in it."""
        return plant

    def applies(self, context: Context) -> bool:
        """Whether the record could show this effect at all."""
        return True

    def starts(self, context: Context) -> list[FloatArray]:
        """Where the search begins: values of `parameters`."""
        return [np.zeros(0)]

    def is_plausible(self, fit: "Fitted") -> bool:
        """Whether the fit is this effect and not, by its numbers, the work of another one."""
        return True

    def active_samples(self, fit: "Fitted") -> np.ndarray:
        """The samples at which it acts, shape (N,); all False where it acts everywhere."""
        return np.zeros(fit.data.samples, bool)

    def values(self, fit: "Fitted") -> "dict[str, Value]":
        """Its parameters in the record's units, as the report prints them."""
        return {}


@dataclass(frozen=True, slots=True)
class Value:
    """A number of the report.

    Attributes
    ----------
    value : float
    unit : str
        "u" and "y" stand for the record's own.
    """

    value: float
    unit: str


@dataclass(frozen=True, slots=True, eq=False)
class Fitted:
    """A fitted hypothesis as `values` sees it: theta may be moved to find how a value depends on it.

    Attributes
    ----------
    hypothesis : Structure
    theta, gains : ndarray
        The searched numbers, and the projected ones.
    data : Data
    """

    hypothesis: Structure
    theta: FloatArray
    gains: FloatArray
    data: Data

    def theta_of(self, effect: Effect) -> FloatArray:
        """The effect's part of theta."""
        return self.theta[self.hypothesis.slices[effect.key]]

    def plant_value(self, name: str) -> float:
        """One of the plant's parameters."""
        part = self.theta[self.hypothesis.slices["plant"]]
        return float(part[self.hypothesis.plant.index(name)])

    def u(self, scaled: float) -> float:
        """An input in the record's unit."""
        return float(self.data.u_scale.back(scaled))

    def y(self, scaled: float) -> float:
        """An output in the record's unit."""
        return float(self.data.y_scale.back(scaled))


class InputEffect(Effect):
    """Bends the command before it reaches the dynamics."""

    path = "input"
    position: ClassVar[int] = 0
    variant_positions: ClassVar[dict[str, int]] = {}

    @property
    def order(self) -> int:
        """Its place in the actuator's chain; a variant may have another one."""
        return self.variant_positions.get(self.variant, self.position)

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """The actuator's signal, shape (N,); `span` is the length of the record by which slow changes are counted."""
        raise NotImplementedError


class PlantEffect(Effect):
    """Changes the dynamics."""

    path = "dynamics"

    def extend(self, plant: Plant) -> Plant:
        """The plant with this effect in it."""
        raise NotImplementedError

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Where the search of the plant's further parameters begins, by name."""
        return [{}]


class OutputEffect(Effect):
    """Bends the output on its way through the sensor; the `last` ones also what is added there."""

    path = "output"
    position: ClassVar[int] = 0
    is_limit: ClassVar[bool] = False

    def apply(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """The sensor's reading of z, shape (N,)."""
        raise NotImplementedError

    def slope(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """Derivative of the reading with respect to z."""
        raise NotImplementedError


class AdditiveEffect(Effect):
    """Adds signals that no input explains; their sizes are gains, found by least squares."""

    path = "disturbance"

    @property
    def at_load(self) -> bool:
        """Whether it enters ahead of the sensor."""
        return False

    @property
    def width(self) -> int:
        """How many columns it adds."""
        return 2

    def columns(self, own: FloatArray, samples: int, span: int, plant: Plant, rates: FloatArray) -> FloatArray:
        """The signals, shape (samples, q)."""
        raise NotImplementedError
