"""The regression of the lab: rows of past outputs and inputs, eq. (4) to (7)."""

from dataclasses import replace

from numpy.typing import ArrayLike

from labsid.model_structures.structures import Regression, Structure, build_equations


def build_phi(
    u: ArrayLike, y: ArrayLike, order: int = 2, start: int | None = None, stop: int | None = None
) -> Regression:
    """Stack past outputs and inputs into Phi and the outputs into Y.

    Parameters
    ----------
    u : array_like, shape (N,), or (N, nu) with several inputs
        Offset-free inputs.
    y : array_like, shape (N,)
        Offset-free output.
    order : int
        Order of the model; a row has (1 + nu) * order entries.
    start : int, optional
        First sample k with a row; default: `order`, the first for which every lag was recorded. Below that, the
        lags before sample 0 are taken as zero: the rig at rest at its operating point.
    stop : int, optional
        One past the last sample with a row; default: N.

    Returns
    -------
    Regression
        Row k - start of Phi is ``[y(k-1) .. y(k-order), u(k-1) .. u(k-order)]``, with a block of lags for each input.

    Raises
    ------
    ValueError
        If the lengths differ, `order`, `start` or `stop` is out of range, or there are fewer rows than
        unknowns.

    Notes
    -----
    UNSW lab, eq. (4) to (7), exercise 2a. With ``start=1`` and ``order=2`` the first row is the one printed in
    the lab, with y(-1) = u(-1) = 0.
    """
    if order < 1:
        raise ValueError(f"order must be at least 1; got {order}.")
    regression = build_equations(Structure(order, order), u, y, start=start, stop=stop)
    Phi = regression.Phi.copy()
    Phi[:, :order] *= -1.0  # the lab's sign: phi(k) holds y(k-1), theta holds -a1
    return replace(regression, Phi=Phi)
