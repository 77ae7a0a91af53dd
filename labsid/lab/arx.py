"""The discrete-time model of the lab, eq. (1) to (3), and its identification.

The sign convention of ``a`` for the whole package:

    A(q) y(k) = B(q) u(k),   A(q) = 1 + a1 q^-1 + ... + an q^-n,   B(q) = b1 q^-1 + ... + bn q^-n
    y(k) = -a1 y(k-1) - ... - an y(k-n) + b1 u(k-1) + ... + bn u(k-n)

so that eq. (4) reads ``y(k) = phi'(k) theta`` with ``theta = [-a1, ..., -an, b1, ..., bn]``.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from labsid._arrays import FloatArray, as_signal, freeze
from labsid.lab.arx_system import ArxSystem, system_ss, system_tf
from labsid.lab.equation import fit_equation
from labsid.least_squares.solve import LeastSquares
from labsid.model_structures.realisation import controllable_form, input_ss, input_tf, transfer_function
from labsid.model_structures.structures import PolynomialModel, Regression

if TYPE_CHECKING:
    import control


@dataclass(frozen=True, slots=True, eq=False)
class ArxModel:
    """A strictly proper difference equation about an operating point.

    Attributes
    ----------
    a : ndarray, shape (n + 1,)
        ``[1, a1, ..., an]``.
    b : ndarray, shape (n,)
        ``[b1, ..., bn]``.
    Ts : float
        Sampling time in seconds.
    u_offset, y_offset : float
        The operating point: the model relates ``u - u_offset`` to ``y - y_offset``.
    """

    a: FloatArray
    b: FloatArray
    Ts: float
    u_offset: float = 0.0
    y_offset: float = 0.0

    def __post_init__(self) -> None:
        a, b = as_signal("a", self.a, at_least=2), as_signal("b", self.b)
        if a[0] != 1 or a.size != b.size + 1:
            raise ValueError(
                f"a must be [1, a1, ..., an] and b [b1, ..., bn]; got a = {a.tolist()} and b = {b.tolist()}. "
                "Divide by the first coefficient, and pad the shorter one with zeros."
            )
        if not (np.isfinite(self.Ts) and self.Ts > 0):
            raise ValueError(f"Ts must be a positive number of seconds; got {self.Ts}.")
        freeze(self, a=a, b=b)

    @property
    def order(self) -> int:
        """Order n of the difference equation."""
        return self.b.size

    @property
    def theta(self) -> FloatArray:
        """``[-a1, ..., -an, b1, ..., bn]``, eq. (4)."""
        return np.concatenate([-self.a[1:], self.b])

    @property
    def polynomials(self) -> PolynomialModel:
        """The same model, without its operating point, in the notation of the lectures."""
        return PolynomialModel(self.a, self.b, np.ones(1), delay=1, Ts=self.Ts)

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Roots of ``z^n + a1 z^(n-1) + ... + an``, shape (n,), complex, largest magnitude first."""
        roots = np.roots(self.a).astype(np.complex128)
        return roots[np.lexsort((roots.imag, -np.abs(roots).round(12)))]

    @property
    def static_gain(self) -> float:
        """``G(1)``, unit of y over unit of u; with a pole at 1 infinite, or NaN if G(1) is 0 / 0."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return float(np.sum(self.b) / np.sum(self.a))

    @property
    def is_stable(self) -> bool:
        """Whether every pole lies inside the unit circle."""
        return bool(np.all(np.abs(self.poles) < 1))


@dataclass(frozen=True, slots=True, eq=False)
class ArxFit:
    """An identified model with its regression and least-squares result.

    Attributes
    ----------
    model : ArxModel
    regression : Regression
    fit : LeastSquares
    """

    model: ArxModel
    regression: Regression
    fit: LeastSquares


def arx_from_theta(theta: ArrayLike, Ts: float, u_offset: float = 0.0, y_offset: float = 0.0) -> ArxModel:
    """Convert ``theta = [-a1, ..., -an, b1, ..., bn]`` to a model.

    Parameters
    ----------
    theta : array_like, shape (2 * n,)
        Parameters in the order of eq. (4).
    Ts : float
        Sampling time in seconds.
    u_offset, y_offset : float
        Operating point.

    Returns
    -------
    ArxModel

    Raises
    ------
    ValueError
        If theta has an odd number of entries or `Ts` is not positive.

    Notes
    -----
    UNSW lab, the remark after eq. (8).
    """
    theta = as_signal("theta", theta, at_least=2)
    if theta.size % 2:
        raise ValueError(f"theta must be [-a1, ..., -an, b1, ..., bn], an even number of entries; got {theta.size}.")
    n = theta.size // 2
    return ArxModel(np.concatenate([[1.0], -theta[:n]]), theta[n:], Ts, u_offset, y_offset)


def fit_arx(
    u: ArrayLike,
    y: ArrayLike,
    Ts: float,
    order: int = 2,
    start: int | None = None,
    stop: int | None = None,
    measured: NDArray[np.bool_] | None = None,
) -> ArxFit:
    """Identify a model of the given order from offset-free data.

    Parameters
    ----------
    u, y : array_like, shape (N,)
        Offset-free input and output.
    Ts : float
        Sampling time in seconds.
    order : int
        Order of the model.
    start, stop : int, optional
        Rows to use; see `build_phi`.
    measured : ndarray of bool, shape (N,), optional
        Samples of y that were measured; rows of Phi with another one are left out. Default: all.

    Returns
    -------
    ArxFit
        ``fit.status`` tells whether the parameters are unique.

    Raises
    ------
    ValueError
        As `build_phi`, or if too few rows are complete.

    Notes
    -----
    UNSW lab, exercise 2a and 2b (order 2) and the post-lab exercise, eq. (9) (order 1).
    """
    equation = fit_equation(as_signal("u", u), y, order, start, stop, measured)
    return ArxFit(arx_from_theta(equation.fit.theta, Ts), equation.regression, equation.fit)


def to_tf(model: ArxModel | ArxSystem) -> "control.TransferFunction":
    """Convert the model to a transfer function of python-control, eq. (1).

    Parameters
    ----------
    model : ArxModel or ArxSystem

    Returns
    -------
    control.TransferFunction
        ``(b1 z^(n-1) + ... + bn) / (z^n + a1 z^(n-1) + ... + an)``, offset-free input to offset-free output; of a
        system with several signals one for each pair.

    Notes
    -----
    UNSW lab, eq. (1), exercise 2c.
    """
    return system_tf(model) if isinstance(model, ArxSystem) else input_tf(model.polynomials)


def canonical_form(model: ArxModel) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return the matrices G, H, C, D of the controllable canonical form, eq. (2).

    Parameters
    ----------
    model : ArxModel

    Returns
    -------
    G : ndarray, shape (n, n)
    H : ndarray, shape (n, 1)
    C : ndarray, shape (1, n)
    D : ndarray, shape (1, 1)

    Notes
    -----
    UNSW lab, eq. (2), for order n instead of 2.
    """
    return controllable_form(*transfer_function(model.polynomials))


def to_ss(model: ArxModel | ArxSystem) -> "control.StateSpace":
    """Convert the model to a state-space system of python-control in the canonical form of eq. (2).

    Parameters
    ----------
    model : ArxModel or ArxSystem
        A system with several signals has the form of `ArxSystem.state_space`.

    Returns
    -------
    control.StateSpace

    Notes
    -----
    UNSW lab, eq. (2), exercise 2c. ``control.tf2ss`` orders the states in reverse.
    """
    return system_ss(model) if isinstance(model, ArxSystem) else input_ss(model.polynomials)


def to_gap_model(model: ArxModel) -> dict[str, Any]:
    """Convert the model to the JSON object that ``labsid gap --sim`` reads.

    Parameters
    ----------
    model : ArxModel

    Returns
    -------
    dict
        ``{"num", "den", "dt", "u0", "y0"}``: coefficients in descending powers of z, ``num`` padded with a
        leading zero.
    """
    return {
        "num": [0.0, *model.b.tolist()],
        "den": model.a.tolist(),
        "dt": float(model.Ts),
        "u0": float(model.u_offset),
        "y0": float(model.y_offset),
    }
