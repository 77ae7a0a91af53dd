"""Compiled sums of lagged products. Import it inside functions: numba takes most of a second to load."""

from labsid._arrays import FloatArray
from labsid._compiled import compiled

BLOCK = 1024  # samples of u and y that fit into the level-1 cache


@compiled("contract", "reassoc", "nsz")
def dot(x: FloatArray, z: FloatArray) -> float:
    """Inner product; the compiler may reorder the summation."""
    total = 0.0
    for k in range(x.size):
        total += x[k] * z[k]
    return total


@compiled()
def lagged_sums(
    u: FloatArray, y: FloatArray, order: int, start: int, stop: int, yy: FloatArray, uu: FloatArray, yu: FloatArray
) -> None:
    """Add the sums of ``x(k) z(k - d)`` over k = start .. stop - 1 to yy, uu and yu.

    The lags are d = 0 .. order for yy, 0 .. order - 1 for uu, and 1 - order .. order for yu (x = y, z = u). Summation
    by blocks reads u and y from memory once and reduces rounding errors.
    """
    for first in range(start, stop, BLOCK):
        last = min(first + BLOCK, stop)
        u_now, y_now = u[first:last], y[first:last]
        for d in range(order + 1):
            yy[d] += dot(y_now, y[first - d : last - d])
        for d in range(order):
            uu[d] += dot(u_now, u[first - d : last - d])
        for d in range(1 - order, order + 1):
            yu[d + order - 1] += dot(y_now, u[first - d : last - d])
