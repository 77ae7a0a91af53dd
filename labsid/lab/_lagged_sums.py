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


@compiled("contract", "reassoc", "nsz")
def second_order_dots(
    y: FloatArray,
    y_1: FloatArray,
    y_2: FloatArray,
    u_ahead: FloatArray,
    u: FloatArray,
    u_1: FloatArray,
    u_2: FloatArray,
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """The nine inner products of the lab's order in one pass: half the time of `dot`, which loads y and u for each."""
    yy = yy_1 = yy_2 = uu = uu_1 = yu_ahead = yu = yu_1 = yu_2 = 0.0
    for k in range(y.size):
        yy += y[k] * y[k]
        yy_1 += y[k] * y_1[k]
        yy_2 += y[k] * y_2[k]
        uu += u[k] * u[k]
        uu_1 += u[k] * u_1[k]
        yu_ahead += y[k] * u_ahead[k]
        yu += y[k] * u[k]
        yu_1 += y[k] * u_1[k]
        yu_2 += y[k] * u_2[k]
    return yy, yy_1, yy_2, uu, uu_1, yu_ahead, yu, yu_1, yu_2


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
        if order == 2:
            y_1, y_2 = y[first - 1 : last - 1], y[first - 2 : last - 2]
            u_ahead, u_1, u_2 = u[first + 1 : last + 1], u[first - 1 : last - 1], u[first - 2 : last - 2]
            sums = second_order_dots(y_now, y_1, y_2, u_ahead, u_now, u_1, u_2)
            for i in range(3):
                yy[i] += sums[i]
            for i in range(2):
                uu[i] += sums[3 + i]
            for i in range(4):
                yu[i] += sums[5 + i]
            continue
        for d in range(order + 1):
            yy[d] += dot(y_now, y[first - d : last - d])
        for d in range(order):
            uu[d] += dot(u_now, u[first - d : last - d])
        for d in range(1 - order, order + 1):
            yu[d + order - 1] += dot(y_now, u[first - d : last - d])
