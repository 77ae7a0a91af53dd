"""State-space models of any number of inputs and outputs, and their simulation.

x(k+1) = G x(k) + H u(k),   y(k) = C x(k) + D u(k)
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from labsid._arrays import FloatArray, as_matrix, freeze
from labsid.model_structures.prediction import LARGEST

if TYPE_CHECKING:
    import control


@dataclass(frozen=True, slots=True, eq=False)
class StateSpaceModel:
    """A discrete-time state-space model, offset-free inputs to offset-free outputs.

    Attributes
    ----------
    G : ndarray, shape (n, n)
    H : ndarray, shape (n, nu)
    C : ndarray, shape (ny, n)
    D : ndarray, shape (ny, nu)
    Ts : float
        Sampling time in seconds.
    """

    G: FloatArray
    H: FloatArray
    C: FloatArray
    D: FloatArray
    Ts: float

    def __post_init__(self) -> None:
        G, H, C, D = (as_matrix(name, getattr(self, name)) for name in "GHCD")
        shapes = [x.shape for x in (G, H, C, D)]
        n, nu, ny = G.shape[0], H.shape[1], C.shape[0]
        if shapes != [(n, n), (n, nu), (ny, n), (ny, nu)]:
            raise ValueError(f"G, H, C and D must fit each other; got the shapes {', '.join(map(str, shapes))}.")
        if not (np.isfinite(self.Ts) and self.Ts > 0):
            raise ValueError(f"Ts must be a positive number of seconds; got {self.Ts}.")
        freeze(self, G=G, H=H, C=C, D=D)

    @property
    def order(self) -> int:
        """Number of states n."""
        return int(self.G.shape[0])

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Eigenvalues of G, shape (n,), complex, largest magnitude first."""
        roots = np.linalg.eigvals(self.G).astype(np.complex128)
        return roots[np.lexsort((roots.imag, -np.abs(roots).round(12)))]

    @property
    def is_stable(self) -> bool:
        """Whether every pole lies inside the unit circle."""
        return bool(np.all(np.abs(self.poles) < 1))

    @property
    def static_gain(self) -> FloatArray:
        """``C (I - G)^-1 H + D``, shape (ny, nu); not finite with a pole at 1."""
        try:
            return np.asarray(self.C @ np.linalg.solve(np.eye(self.order) - self.G, self.H) + self.D)
        except np.linalg.LinAlgError:
            return np.full(self.D.shape, np.inf)


def simulate_states(model: StateSpaceModel, u: ArrayLike, x0: ArrayLike | None = None) -> FloatArray:
    """Simulate a model from its inputs alone (free run).

    Parameters
    ----------
    model : StateSpaceModel
    u : array_like, shape (N, nu)
        Offset-free inputs.
    x0 : array_like, shape (n,), optional
        State at the first sample; default: zero (at rest).

    Returns
    -------
    y : ndarray, shape (N, ny)

    Raises
    ------
    ValueError
        If the number of inputs is another one, or the output of an unstable model overflows.
    """
    u = as_matrix("u", u)
    if u.shape[1] != model.H.shape[1]:
        raise ValueError(f"u must have a column for each of the {model.H.shape[1]} inputs; got {u.shape[1]}.")
    driven = u @ model.H.T
    states = np.empty_like(driven)
    x = np.zeros(model.order) if x0 is None else np.asarray(x0, np.float64)
    with np.errstate(over="ignore", invalid="ignore"):
        for k, forced in enumerate(driven):
            states[k] = x
            x = model.G @ x + forced
        y: FloatArray = states @ model.C.T + u @ model.D.T
    if not np.all(np.abs(y) < LARGEST):
        raise ValueError(
            f"the simulated output must stay within the range of numbers; the model has a pole of magnitude "
            f"{abs(model.poles[0]):.4g}, outside the unit circle: it is unstable. Check the data, or try another order."
        )
    return y


def free_responses(model: StateSpaceModel, samples: int) -> FloatArray:
    """Outputs of the undriven model from each unit state: ``C G^k``, shape (samples, ny, n)."""
    found = np.empty((samples, *model.C.shape))
    row = model.C
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(samples):
            found[k] = row
            row = row @ model.G
    return found


def estimate_state(
    model: StateSpaceModel, u: ArrayLike, y: ArrayLike, measured: NDArray[np.bool_] | None = None
) -> FloatArray:
    """Estimate the state at the first sample by least squares on the simulated outputs.

    Parameters
    ----------
    model : StateSpaceModel
    u : array_like, shape (N, nu)
    y : array_like, shape (N, ny)
        Offset-free inputs and outputs.
    measured : ndarray of bool, shape (N, ny), optional
        Which outputs to fit; default: all.

    Returns
    -------
    x0 : ndarray, shape (n,)
        Of minimum norm if the outputs do not determine it.

    Notes
    -----
    The error of each output counts relative to its standard deviation, because units differ.
    """
    y = as_matrix("y", y)
    scale = np.where(np.ptp(y, axis=0) > 0, np.std(y, axis=0), 1.0)
    there = np.ones(y.shape, bool) if measured is None else measured
    unexplained = ((y - simulate_states(model, u)) / scale)[there]
    responses = (free_responses(model, len(y)) / scale[:, np.newaxis])[there]
    return np.linalg.lstsq(responses, unexplained, rcond=None)[0].astype(np.float64)


def state_space_system(model: StateSpaceModel, inputs: Sequence[str], outputs: Sequence[str]) -> "control.StateSpace":
    """Convert a model to a state-space system of python-control.

    Parameters
    ----------
    model : StateSpaceModel
    inputs, outputs : sequence of str
        Names of the signals.

    Returns
    -------
    control.StateSpace
    """
    import control

    matrices = (model.G, model.H, model.C, model.D)
    return control.ss(*matrices, model.Ts, name="G", inputs=list(inputs), outputs=list(outputs))
