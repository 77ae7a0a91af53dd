"""Units and operating points of the signals of a record."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray
from labsid.rig.switchable.plants import Scales, draw_scales


@dataclass(frozen=True, slots=True)
class Units:
    """Conversion from rig units to the record's units, one sampling time for all signals.

    Attributes
    ----------
    Ts : float
        Sampling time (s).
    u0, us : tuple of float
        Operating point and scale of each input.
    y0, ys : tuple of float
        Operating point and scale of each output.
    """

    Ts: float
    u0: tuple[float, ...]
    us: tuple[float, ...]
    y0: tuple[float, ...]
    ys: tuple[float, ...]

    def u(self, v: FloatArray) -> FloatArray:
        """Inputs in the record's units.

        Parameters
        ----------
        v : ndarray, shape (N, nu)
        """
        return np.array(self.u0) + np.array(self.us) * v

    def y(self, x: FloatArray) -> FloatArray:
        """Outputs in the record's units.

        Parameters
        ----------
        x : ndarray, shape (N, ny)
        """
        return np.array(self.y0) + np.array(self.ys) * x

    def pair(self, i: int, j: int) -> Scales:
        """Units of one input and one output.

        Parameters
        ----------
        i, j : int
        """
        return Scales(Ts=self.Ts, u0=self.u0[i], us=self.us[i], y0=self.y0[j], ys=self.ys[j])


def draw_units(rng: np.random.Generator, inputs: int, outputs: int) -> Units:
    """Draw the units and the operating points.

    Parameters
    ----------
    rng : Generator
    inputs, outputs : int

    Returns
    -------
    Units
    """
    scales = [draw_scales(rng) for _ in range(max(inputs, outputs))]
    return Units(
        Ts=scales[0].Ts,
        u0=tuple(scale.u0 for scale in scales[:inputs]),
        us=tuple(scale.us for scale in scales[:inputs]),
        y0=tuple(scale.y0 for scale in scales[:outputs]),
        ys=tuple(scale.ys for scale in scales[:outputs]),
    )
