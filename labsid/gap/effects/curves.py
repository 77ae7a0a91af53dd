"""Smooth static curves of actuators and sensors: a cubic, or a natural cubic spline."""

from typing import ClassVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics import _kernels
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.effects.base import Effect, Fitted, Planted, Value
from labsid.gap.effects.context import ParentFit, Structure

CUBIC = (Parameter("c2", -3.0, 3.0), Parameter("c3", -2.0, 2.0))
KNOTS = np.array([-2.8, -1.9, -1.4, -0.8, 0.0, 0.8, 1.4, 1.9, 2.8])  # scaled; set by hand
SPLINE = tuple(Parameter(f"s{k}", -10.0, 10.0) for k in range(1, KNOTS.size - 1))
_GRID = np.linspace(-2.2, 2.2, 45)  # scaled: points at which a spline is fitted to a cubic and vice versa; numerics


class Curve(Effect):
    """A curve of the input or the output, `signal` "u" or "y"; the `variant` "rich" is a spline."""

    signal: ClassVar[str]
    planted_variants = ("",)
    richer: ClassVar[dict[str, tuple[str, ...]]] = {"": ("rich",)}

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Coefficients in scaled units."""
        return SPLINE if self.variant == "rich" else CUBIC

    def carry_over(self, fit: ParentFit, hypothesis: Structure, theta: FloatArray) -> None:
        """Begin a spline at the cubic."""
        plain = type(self)()
        if self.variant == "rich" and plain in fit.hypothesis.effects:
            theta[hypothesis.slices[self.key]] = spline_coefficients(fit.theta[fit.hypothesis.slices[plain.key]])

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`c2` and `c3` about `centre`, the mean of the signal; of a spline, those of the nearest cubic."""
        own = fit.theta_of(self)
        cubic = np.linalg.lstsq(np.column_stack([_GRID**2, _GRID**3]), evaluate(_GRID, own) - _GRID, rcond=None)[0]
        c2, c3 = (float(x) for x in cubic)
        scale = fit.data.u_scale if self.signal == "u" else fit.data.y_scale
        return {
            "c2": Value(c2 / scale.unit, f"1/{self.signal}"),
            "c3": Value(c3 / scale.unit**2, f"1/{self.signal}^2"),
            "centre": Value(float(scale.back(0.0)), self.signal),
        }

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A quadratic and a cubic curve of either sign, by their distance from a straight line at half the range."""
        half = 0.5 * (fit.input_range if self.signal == "u" else fit.range)
        bend = 2.0 * share * half
        coefficients = ("c2", bend / half**2), ("c3", bend / half**3)
        return [
            Planted(name, {"c2": 0.0, "c3": 0.0} | {name: sign * size})
            for name, size in coefficients
            for sign in (1.0, -1.0)
        ]


def evaluate(x: FloatArray, own: FloatArray) -> FloatArray:
    """Value of the curve at x; at zero it is zero with slope one.

    x + c2 x^2 + c3 x^3, or x + s1 n1(x) + ... with the natural cubic splines n on `KNOTS`.
    """
    if own.size == len(CUBIC):
        return np.asarray(x * (1.0 + x * (own[0] + x * own[1])))
    return np.asarray(x + _kernels.piecewise(x, KNOTS, np.tensordot(own, _SPLINES, 1)))


def slope(x: FloatArray, own: FloatArray) -> FloatArray:
    """Derivative of the curve at x."""
    if own.size == len(CUBIC):
        return np.asarray(1.0 + x * (2.0 * own[0] + 3.0 * x * own[1]))
    powers = np.tensordot(own, _SPLINES, 1)
    powers[:, :3] = powers[:, 1:] * (1.0, 2.0, 3.0)
    powers[:, 3] = 0.0
    return np.asarray(1.0 + _kernels.piecewise(x, KNOTS, powers))


def spline_coefficients(own: FloatArray) -> FloatArray:
    """Coefficients of the spline nearest to a cubic."""
    each = [_kernels.piecewise(_GRID, KNOTS, powers) for powers in _SPLINES]
    return np.asarray(np.linalg.lstsq(np.column_stack(each), evaluate(_GRID, own) - _GRID, rcond=None)[0])


def _splines() -> FloatArray:
    """Natural splines less their linear part about zero, as polynomials; shape (splines, intervals, powers)."""
    last = KNOTS.size - 1
    cubes = np.array([[-(knot**3), 3.0 * knot**2, -3.0 * knot, 1.0] for knot in KNOTS])
    share = np.zeros((last, KNOTS.size))
    for k in range(last):
        share[k, k], share[k, last] = 1.0 / (KNOTS[last] - KNOTS[k]), -1.0 / (KNOTS[last] - KNOTS[k])
    natural = share[:-1] - share[-1]
    behind = np.tri(KNOTS.size + 1, KNOTS.size, -1)  # knots below each interval
    powers = np.einsum("ki,ji,ip->kjp", natural, behind, cubes)
    powers[:, :, :2] -= powers[:, np.searchsorted(KNOTS, 0.0), :2][:, None]
    powers[:, -1, 2:] = 0.0  # linear above the last knot: remove rounding errors
    return np.asarray(powers)


_SPLINES = _splines()
