"""Where am I? Position from measured distances to beacons, and layouts that cannot tell."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_matrix, as_signal, freeze, frozen_array
from labsid.nonlinear.solve import NonlinearFit, levenberg_marquardt

# Two minima are told apart when the worse one's sum of squares is larger by this many noise variances: the 95 %
# point of chi-square with two degrees of freedom, one for each coordinate.
SIGNIFICANT = 5.99

# SUSTech's coding example is not in the text. This layout is chosen: five beacons around a room of 10 m by 8 m.
BEACONS = frozen_array([[0.0, 0.0], [10.0, 0.0], [10.0, 8.0], [0.0, 8.0], [5.0, 9.5]])
TARGET = frozen_array([3.2, 5.1])


@dataclass(frozen=True, slots=True, eq=False)
class RangeFix:
    """A position from ranges, and whether it is the only one.

    Attributes
    ----------
    position : ndarray, shape (2,)
        The best position, in the unit of the beacons; NaN if undetermined.
    mirror : ndarray, shape (2,)
        The other position that fits as well; NaN if there is none.
    sse : float
        Sum of squared range errors at `position`.
    dilution : float
        How much the layout magnifies range errors: ``sqrt(trace((J'J)^-1))``, standard error of the position over
        that of a range; infinite where the layout does not determine the position to first order.
    fit : NonlinearFit or None
        The iteration that found `position`.
    status : {"unique", "mirror", "ambiguous", "on the line", "undetermined"}
        "mirror": the beacons lie on one line (two always do), and the position mirrored in it fits exactly as well.
        "on the line": they do, and so does the position, which is its own mirror image; across the line it is poorly
        determined. "ambiguous": the beacons lie so close to a line that the noise hides which side it is.
        "undetermined": all beacons are in one place; the position is somewhere on a circle.
    """

    position: FloatArray
    mirror: FloatArray
    sse: float
    dilution: float
    fit: NonlinearFit | None
    status: Literal["unique", "mirror", "ambiguous", "on the line", "undetermined"]

    def __post_init__(self) -> None:
        freeze(self, position=self.position, mirror=self.mirror)


@dataclass(frozen=True, slots=True, eq=False)
class RangeExample:
    """The coding example: what was measured, and the truth.

    Attributes
    ----------
    beacons : ndarray, shape (m, 2)
        In metres.
    ranges : ndarray, shape (m,)
        Measured distances in metres.
    target : ndarray, shape (2,)
        True position in metres.
    sigma : float
        Standard deviation of the range errors in metres.
    """

    beacons: FloatArray
    ranges: FloatArray
    target: FloatArray
    sigma: float

    def __post_init__(self) -> None:
        freeze(self, beacons=self.beacons, ranges=self.ranges, target=self.target)


def coding_example(rng: np.random.Generator, sigma: float = 0.1) -> RangeExample:
    """Make the data of the coding example: ranges from five beacons to a target, with Gaussian errors.

    Parameters
    ----------
    rng : numpy.random.Generator
    sigma : float
        Standard deviation of the errors in metres.

    Returns
    -------
    RangeExample

    Raises
    ------
    ValueError
        If `sigma` is negative.

    Notes
    -----
    SUSTech lecture, "Coding Example", the last slide. It is empty in the text: beacons, target and noise are chosen.
    """
    if not sigma >= 0:
        raise ValueError(f"sigma must be zero or more; got {sigma}.")
    ranges = ranges_from(BEACONS, TARGET) + sigma * rng.standard_normal(BEACONS.shape[0])
    return RangeExample(BEACONS, ranges, TARGET, sigma)


def ranges_from(beacons: ArrayLike, position: ArrayLike) -> FloatArray:
    """Compute ``g(theta)``: the distance to every beacon.

    Parameters
    ----------
    beacons : array_like, shape (m, 2)
    position : array_like, shape (2,)

    Returns
    -------
    ndarray, shape (m,)

    Raises
    ------
    ValueError
        If the shapes do not fit.
    """
    away = _away(beacons, position)
    return np.hypot(away[:, 0], away[:, 1])


def ranges_jacobian(beacons: ArrayLike, position: ArrayLike) -> FloatArray:
    """Differentiate the ranges: row i is the unit vector from beacon i to the position.

    Parameters
    ----------
    beacons : array_like, shape (m, 2)
    position : array_like, shape (2,)

    Returns
    -------
    ndarray, shape (m, 2)
        Zero in the row of a beacon at the position itself, where the range has no derivative.

    Raises
    ------
    ValueError
        If the shapes do not fit.
    """
    away = _away(beacons, position)
    distance = np.hypot(away[:, 0], away[:, 1])[:, np.newaxis]
    return np.divide(away, distance, out=np.zeros_like(away), where=distance > 0)


def locate(beacons: ArrayLike, ranges: ArrayLike) -> RangeFix:
    """Find the position that fits measured ranges best, and whether another fits as well.

    Parameters
    ----------
    beacons : array_like, shape (m, 2)
        Known positions.
    ranges : array_like, shape (m,)
        Measured distances, none negative, in the same unit.

    Returns
    -------
    RangeFix

    Raises
    ------
    ValueError
        If the shapes do not fit, there are fewer than two beacons, or a range is negative.

    Notes
    -----
    SUSTech lecture, "Navigation by range measurement": minimise ``sum (y_i - |b_i - theta|)^2``. The sum has up to two
    minima worth the name, about mirror images in the line through the beacons: Levenberg-Marquardt starts on either
    side of it, and from the solution of the linear equations that the squared ranges give when one is subtracted from
    the others.
    """
    beacons, ranges = as_matrix("beacons", beacons), as_signal("ranges", ranges)
    if beacons.shape != (ranges.size, 2):
        raise ValueError(f"beacons must have shape ({ranges.size}, 2), a row for each range; got {beacons.shape}.")
    if ranges.size < 2:
        raise ValueError("beacons must be at least two: one range leaves a whole circle. Measure from another beacon.")
    if np.any(ranges < 0):
        raise ValueError(f"ranges must not be negative; got {ranges.min():g} from beacon {np.argmin(ranges)}.")
    centre = beacons.mean(axis=0)
    _, spread, axes = np.linalg.svd(beacons - centre)
    size = max(float(np.max(np.abs(beacons))), float(np.max(ranges)), np.finfo(float).tiny)
    if spread[0] <= 1e-9 * size:
        nowhere = np.full(2, np.nan)
        return RangeFix(nowhere, nowhere, float(np.sum((ranges - ranges.mean()) ** 2)), np.inf, None, "undetermined")

    def solve(start: FloatArray) -> NonlinearFit:
        return levenberg_marquardt(
            lambda theta: ranges_from(beacons, theta), lambda theta: ranges_jacobian(beacons, theta), ranges, start
        )

    fits = sorted((solve(start) for start in _starts(beacons - centre, ranges, axes, centre)), key=lambda fit: fit.sse)
    best = fits[0]
    position = best.theta
    dilution = _dilution(ranges_jacobian(beacons, position))
    others = [fit for fit in fits if np.linalg.norm(fit.theta - position) > 1e-4 * size]
    absent = np.full(2, np.nan)
    if spread[1] <= 1e-9 * spread[0]:
        across = axes[1]
        mirror = position - 2 * ((position - centre) @ across) * across
        on_line = np.linalg.norm(mirror - position) <= 1e-4 * size
        return (
            RangeFix(position, absent, best.sse, np.inf, best, "on the line")
            if on_line
            else RangeFix(position, mirror, best.sse, dilution, best, "mirror")
        )
    variance = best.sse / (ranges.size - 2)
    if others and others[0].sse - best.sse <= SIGNIFICANT * variance:
        return RangeFix(position, others[0].theta, best.sse, dilution, best, "ambiguous")
    return RangeFix(position, absent, best.sse, dilution, best, "unique")


def _starts(centred: FloatArray, ranges: FloatArray, axes: FloatArray, centre: FloatArray) -> list[FloatArray]:
    """Positions to start from: the linear solution, and both sides of the line through the beacons."""
    # |theta - b_i|^2 = y_i^2; less the mean over i: -2 (b_i - centre)'(theta - centre) = y_i^2 - |b_i|^2 - mean.
    squares = ranges**2 - np.sum(centred**2, axis=1)
    linear = np.linalg.lstsq(-2 * centred, squares - squares.mean(), rcond=1e-9)[0]
    along = float(linear @ axes[0])
    height = np.sqrt(
        max(float(np.mean(ranges**2 - (centred @ axes[0] - along) ** 2)), 1e-6 * float(np.mean(ranges**2)))
    )
    sides = [along * axes[0] + side * height * axes[1] for side in (1, -1)]
    return [centre + start for start in (linear, *sides)]


def _dilution(J: FloatArray) -> float:
    s = np.linalg.svd(J, compute_uv=False)
    return float(np.sqrt(np.sum(1 / s**2))) if s[-1] > 1e-8 else np.inf


def _away(beacons: ArrayLike, position: ArrayLike) -> FloatArray:
    """The way from each beacon to the position."""
    beacons, position = as_matrix("beacons", beacons), as_signal("position", position)
    if beacons.shape[1] != 2 or position.size != 2:
        raise ValueError(
            f"beacons must have shape (m, 2) and position two coordinates; got {beacons.shape} and {position.size}."
        )
    return position - beacons
