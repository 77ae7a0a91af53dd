"""The difference equations of several inputs and outputs, and their identification by least squares.

    y_i(k) = -a_i1 y_i(k-1) - ... - a_in y_i(k-n) + sum over j of (b_ij1 u_j(k-1) + ... + b_ijn u_j(k-n))

is the equation of output i; of a coupled system it also holds the past of the other outputs. As for one input and one
output, ``y_i(k) = phi'(k) theta_i`` with ``theta_i = [-a_i1, ..., -a_in, b_i11, ..., b_i1n, b_i21, ...]``, and the
numbers of a coupled system, ``-a_im1, ...``, between the two; see `labsid.lab.arx` for the sign.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from labsid._arrays import FloatArray, as_matrix, freeze
from labsid.lab.equation import Equation, fit_equation
from labsid.model_structures.state_space import StateSpaceModel, simulate_states, state_space_system
from labsid.records.several_signals import check_names, joined, names_of

if TYPE_CHECKING:
    import control


@dataclass(frozen=True, slots=True, eq=False)
class ArxSystem:
    """Strictly proper difference equations of several signals about an operating point: ``A(q) y = B(q) u``.

    Attributes
    ----------
    a : ndarray, shape (ny, ny, n + 1)
        ``a[i, m]`` holds the coefficients of output m in the equation of output i: ``[1, a1, ..., an]`` for m = i,
        ``[0, a1, ..., an]`` otherwise, zero if the system is not coupled.
    b : ndarray, shape (ny, nu, n)
        ``b[i, j]`` holds ``[b1, ..., bn]`` of input j in the equation of output i.
    Ts : float
        Sampling time in seconds.
    u_offset : ndarray, shape (nu,)
    y_offset : ndarray, shape (ny,)
        The operating point; zero by default.
    inputs, outputs : tuple of str
        Names of the signals; by default as in a record.
    """

    a: FloatArray
    b: FloatArray
    Ts: float
    u_offset: FloatArray = ()  # type: ignore[assignment]
    y_offset: FloatArray = ()  # type: ignore[assignment]
    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        a, b = np.asarray(self.a, np.float64), np.asarray(self.b, np.float64)
        if a.ndim != 3 or b.ndim != 3 or a.shape != (b.shape[0], b.shape[0], b.shape[2] + 1):
            raise ValueError(f"a and b must have the shapes (ny, ny, n + 1) and (ny, nu, n); got {a.shape}, {b.shape}.")
        ny, nu, n = b.shape
        if n < 1 or not (np.isfinite(a).all() and np.isfinite(b).all()):
            raise ValueError(f"a and b must be finite and of order 1 or more; got order {n}.")
        if not np.array_equal(a[:, :, 0], np.eye(ny)):
            raise ValueError("a[i, i] must begin with 1 and a[i, m] with 0. Solve the equations for y(k).")
        if not (np.isfinite(self.Ts) and self.Ts > 0):
            raise ValueError(f"Ts must be a positive number of seconds; got {self.Ts}.")
        offsets = {}
        for name, count in (("u_offset", nu), ("y_offset", ny)):
            offsets[name] = np.zeros(count) if not np.size(getattr(self, name)) else np.asarray(getattr(self, name))
            if offsets[name].shape != (count,):
                raise ValueError(f"{name} must have {count} entries; got shape {offsets[name].shape}.")
        inputs, outputs = names_of("u", self.inputs, nu), names_of("y", self.outputs, ny)
        check_names(inputs, outputs)
        freeze(self, a=a, b=b, **offsets)
        object.__setattr__(self, "inputs", inputs)
        object.__setattr__(self, "outputs", outputs)

    @property
    def order(self) -> int:
        """Order n of each equation."""
        return int(self.b.shape[2])

    @property
    def coupled(self) -> bool:
        """Whether an equation holds the past of another output."""
        return bool(np.any(self.a[~np.eye(len(self.outputs), dtype=bool)]))

    @property
    def state_space(self) -> StateSpaceModel:
        """The system as a state-space model with n ny states, which are not past outputs and inputs."""
        ny, nu, n = self.b.shape
        # G = [-A1  I  ...  0]   H = [B1]   C = [I  0  ...  0]   D = 0
        #     [ .   .       I]       [ .]
        #     [-An  0  ...  0]       [Bn]
        G = np.eye(n * ny, k=ny)
        G[:, :ny] = -np.moveaxis(self.a[:, :, 1:], 2, 0).reshape(n * ny, ny)
        H = np.moveaxis(self.b, 2, 0).reshape(n * ny, nu)
        return StateSpaceModel(G, H, np.eye(ny, n * ny), np.zeros((ny, nu)), self.Ts)

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Poles of the system, shape (n ny,), complex, largest magnitude first."""
        return self.state_space.poles

    @property
    def static_gain(self) -> FloatArray:
        """``G(1)``, shape (ny, nu), unit of the output over that of the input; not finite with a pole at 1."""
        return self.state_space.static_gain

    @property
    def is_stable(self) -> bool:
        """Whether every pole lies inside the unit circle."""
        return self.state_space.is_stable


@dataclass(frozen=True, slots=True, eq=False)
class ArxSystemFit:
    """An identified system with the regression and least-squares result of each output.

    Attributes
    ----------
    model : ArxSystem
    equations : tuple of Equation
        ``equations[i].fit.theta`` is theta of output i, `stderr` its standard errors.
    """

    model: ArxSystem
    equations: tuple[Equation, ...]


def system_from_thetas(
    thetas: Sequence[ArrayLike],
    order: int,
    Ts: float,
    inputs: Sequence[str],
    outputs: Sequence[str],
    coupled: bool = False,
) -> ArxSystem:
    """Convert theta of each output to a system.

    Parameters
    ----------
    thetas : sequence of array_like
        For each output, in the order that the head of this module states.
    order : int
    Ts : float
        Sampling time in seconds.
    inputs, outputs : sequence of str
        Names of the signals.
    coupled : bool
        Whether each theta holds numbers of the other outputs.

    Returns
    -------
    ArxSystem

    Raises
    ------
    ValueError
        If a theta has another number of entries.
    """
    ny, nu = len(outputs), len(inputs)
    a, b = np.zeros((ny, ny, order + 1)), np.zeros((ny, nu, order))
    for i, given in enumerate(thetas):
        of_outputs = [i, *(m for m in range(ny) if m != i and coupled)]
        blocks = len(of_outputs) + nu
        theta = np.asarray(given, np.float64)
        if theta.shape != (blocks * order,):
            raise ValueError(
                f"theta of {outputs[i]} must have {blocks * order} entries, {order} for each of {blocks} signals; got "
                f"shape {theta.shape}."
            )
        numbers = theta.reshape(blocks, order)
        a[i, of_outputs, 1:] = -numbers[: len(of_outputs)]
        b[i] = numbers[len(of_outputs) :]
    a[range(ny), range(ny), 0] = 1.0
    return ArxSystem(a, b, Ts, inputs=tuple(inputs), outputs=tuple(outputs))


def fit_arx_system(
    u: ArrayLike,
    y: ArrayLike,
    Ts: float,
    order: int = 2,
    start: int | None = None,
    stop: int | None = None,
    measured: NDArray[np.bool_] | None = None,
    coupled: bool = False,
    inputs: Sequence[str] = (),
    outputs: Sequence[str] = (),
) -> ArxSystemFit:
    """Identify the equation of each output from offset-free data by least squares.

    Parameters
    ----------
    u : array_like, shape (N, nu)
        Offset-free inputs.
    y : array_like, shape (N, ny)
        Offset-free outputs, with any finite value where one was not measured.
    Ts : float
        Sampling time in seconds.
    order : int
        Order of each equation.
    start, stop : int, optional
        Rows to use; see `build_phi`.
    measured : ndarray of bool, shape (N, ny), optional
        Outputs that were measured; rows of Phi with another one are left out. Default: all.
    coupled : bool
        Whether the equation of each output holds the past of the other outputs, too (MIMO); otherwise each output
        depends on its own past and on all inputs (MISO for each output).
    inputs, outputs : sequence of str
        Names of the signals; by default as in a record.

    Returns
    -------
    ArxSystemFit
        ``equations[i].fit.status`` tells whether the parameters are unique.

    Raises
    ------
    ValueError
        As `build_phi`, with the name of the output.

    Notes
    -----
    UNSW lab, exercise 2a and 2b, with a block of Phi for each signal. The past of the other outputs stands in Phi as
    that of further inputs.
    """
    u, y = as_matrix("u", u), as_matrix("y", y)
    inputs, outputs = names_of("u", inputs, u.shape[1]), names_of("y", outputs, y.shape[1])
    there = np.ones(y.shape, bool) if measured is None else measured
    equations = []
    for i, name in enumerate(outputs):
        others = [y[:, m] for m in range(len(outputs)) if m != i and coupled]
        complete = np.all(there, axis=1) if coupled else there[:, i]
        try:
            equations.append(fit_equation(joined([*others, *u.T]), y[:, i], order, start, stop, complete))
        except ValueError as error:
            raise ValueError(f"{name}: {error}") from None
    thetas = [equation.fit.theta for equation in equations]
    return ArxSystemFit(system_from_thetas(thetas, order, Ts, inputs, outputs, coupled), tuple(equations))


def simulate_system(model: ArxSystem, u: ArrayLike, x0: ArrayLike | None = None) -> FloatArray:
    """Simulate a system from its inputs (free run): past outputs are simulated, not measured.

    Parameters
    ----------
    model : ArxSystem
    u : array_like, shape (N, nu)
        Offset-free inputs.
    x0 : array_like, shape (n ny,), optional
        State of `ArxSystem.state_space` at the first sample; default: zero (at rest).

    Returns
    -------
    y : ndarray, shape (N, ny)
        Offset-free simulated outputs.
    """
    return simulate_states(model.state_space, u, x0)


def system_tf(model: ArxSystem) -> "control.TransferFunction":
    """Convert a system to a matrix of transfer functions of python-control, one for each pair.

    Parameters
    ----------
    model : ArxSystem

    Returns
    -------
    control.TransferFunction

    Notes
    -----
    Without coupling the pair (i, j) is ``B_ij / A_i``. With it, all have the denominator det(zI - G), and the
    numerator of a pair is det(zI - G + H_j C_i) - det(zI - G).
    """
    import control

    ny, nu, _ = model.b.shape
    if model.coupled:
        states = model.state_space
        common = np.poly(states.G)
        num = [[np.poly(states.G - np.outer(H, C)) - common for H in states.H.T] for C in states.C]
        den = [[common] * nu] * ny
    else:
        num, den = [list(row) for row in model.b], [[model.a[i, i]] * nu for i in range(ny)]
    return control.tf(num, den, model.Ts, name="G", inputs=list(model.inputs), outputs=list(model.outputs))


def system_ss(model: ArxSystem) -> "control.StateSpace":
    """Convert a system to a state-space system of python-control.

    Parameters
    ----------
    model : ArxSystem

    Returns
    -------
    control.StateSpace
    """
    return state_space_system(model.state_space, model.inputs, model.outputs)
