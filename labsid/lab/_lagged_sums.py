"""Sums of lagged products as a compiled loop. Import it where it is used: numba takes most of a second to load."""

from labsid._arrays import FloatArray
from labsid._compiled import compiled

BLOCK = 1024  # samples of u and y that stay in the fastest cache while every lagged sum reads them


@compiled("contract", "reassoc", "nsz")
def dot(x: FloatArray, z: FloatArray) -> float:
    """Inner product, in whatever order of summation suits the processor's vectors."""
    total = 0.0
    for k in range(x.size):
        total += x[k] * z[k]
    return total


@compiled()
def lagged_sums(
    u: FloatArray, y: FloatArray, order: int, start: int, stop: int, yy: FloatArray, uu: FloatArray, yu: FloatArray
) -> None:
    """Add up ``x(k) z(k - d)`` over k = start .. stop - 1: d = 0 .. order for yy, 0 .. order - 1 for uu, and from
    1 - order to order for yu (y now, u then), the first entry of yu being that of the most negative lag.

    Block by block, so that u and y are read from memory once; the sums of short blocks also round less.
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
