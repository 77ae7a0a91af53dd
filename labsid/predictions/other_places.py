"""Predictions of the post-lab and of recursive identification: a pole moved, the order, a forgetting factor."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.estimation.recursive import recursive_least_squares
from labsid.plots.predictions import Curve, View
from labsid.predictions.lab_data import fit, output_view, read_lab_data, rms, simulate
from labsid.predictions.prediction import Outcome, Prediction, Sources

FACTORS = (0.1, 0.3, 1.0, 2.0, 3.0, 10.0)


class MovedPole:
    """The first-order model with its pole moved and its gain kept; a factor multiplies the time constant."""

    def __init__(self, sources: Sources) -> None:
        self._data = read_lab_data(sources)
        self._say = self._data.say
        self._pole, b = fit(self._data.u[: self._data.half], self._data.y[: self._data.half], 1)[0]
        self._gain = b / (1 - self._pole)

    def _simulate(self, factor: float) -> tuple[float, FloatArray]:
        pole = float(self._pole ** (1 / factor))
        return pole, simulate(np.array([pole, self._gain * (1 - pole)]), self._data.u)

    def view(self, position: int) -> View:
        """The simulation with the pole at a position."""
        pole, simulated = self._simulate(FACTORS[position])
        said = f"Time constant {-self._data.Ts / np.log(pole):.1f} s; error {self._say(rms(self._data.y - simulated))}."
        before = None if FACTORS[position] == 1 else self._simulate(1.0)[1]
        return output_view(self._data, f"Pole at z = {pole:.3f}", simulated, "Pole moved", said, before)

    def outcome(self) -> Outcome:
        """How the time constant grows when the distance of the pole from 1 is divided by three."""
        pole = self._simulate(3.0)[0]
        ratio = float(np.log(self._pole) / np.log(pole))
        before, after = (-self._data.Ts / np.log(one) for one in (self._pole, pole))
        return Outcome(
            2 if ratio > 2 else 1 if ratio > 1.1 else 0,
            f"The pole goes from {self._pole:.3f} to {pole:.3f}, and the time constant from {before:.3g} s to "
            f"{after:.3g} s. Near 1 the distance of the pole from 1 counts: τ is about Ts / (1 − p). The levels are "
            "the same, but the input does not hold long enough for the slow model to reach them.",
        )


ORDERS = (1, 2, 3, 4, 5, 6)


class ModelOrder:
    """Models of several orders, fitted to the first half and simulated over the whole record."""

    def __init__(self, sources: Sources) -> None:
        data = self._data = read_lab_data(sources)
        self._say = data.say
        fits = [fit(data.u[: data.half], data.y[: data.half], n) for n in ORDERS]
        self._simulated = [simulate(theta, data.u) for theta, _ in fits]
        self._of_fit = [float(np.sqrt(error)) for _, error in fits]
        self._mse = [rms(data.y - simulated) ** 2 for simulated in self._simulated]

    def view(self, position: int) -> View:
        """The error of the simulation at one order, beside that at order 1."""
        data, n = self._data, ORDERS[position]
        errors = [data.y - simulated for simulated in self._simulated]
        largest = float(np.abs(errors[0]).max())
        curves = [Curve("before", "Order 1", data.t, errors[0])] if position else []
        curves.append(Curve("moved", f"Order {n}", data.t, errors[position]))
        of_fit, mse = self._say(self._of_fit[position]), self._mse[position]
        said = f"Error of the fit {of_fit} (rms); MSE of the simulation {mse:.2e} {self._data.unit}²."
        limits = (-1.1 * largest, 1.1 * largest)
        return View(
            f"Error of the simulation, order {n}",
            tuple(curves),
            limits,
            said,
            ylabel=f"y minus simulation ({data.unit})",
        )

    def outcome(self) -> Outcome:
        """How much order 3 saves, beside what order 2 saved."""
        first, second = self._mse[0] - self._mse[1], self._mse[1] - self._mse[2]
        holds = 2 if second < 0 else 0 if second >= 0.75 * first else 1
        return Outcome(
            holds,
            f"MSE of the simulation: {self._mse[0]:.2e} with order 1, {self._mse[1]:.2e} with 2, "
            f"{self._mse[2]:.2e} with 3, {self._mse[5]:.2e} {self._data.unit}² with 6. The error of the fit falls with "
            "every order, as each model contains the smaller ones; that of the simulation need not. What remains is "
            "noise, and what no linear model has, such as a gain that changes with the level.",
        )


FORGETTING = (1.0, 0.999, 0.995, 0.99, 0.97, 0.95, 0.9)
_LAST = 300  # samples, when the estimate has long followed the change


class ForgettingFactor:
    """The estimate of b1 in Example 6-1 with several forgetting factors."""

    def __init__(self, sources: Sources) -> None:
        try:
            u, y, true = (np.asarray(sources.variables[name], dtype=float) for name in ("u_61", "y_61", "theta_true"))
        except (KeyError, TypeError, ValueError):
            raise ValueError("the record of Example 6-1 is not there: run the cell of step 4 that makes it") from None
        if u.shape != y.shape or true.shape != (u.size, 3) or u.size <= 2 * _LAST:
            raise ValueError("the record of Example 6-1 has been changed: run the cell of step 4 that makes it")
        Phi, Y = np.column_stack([-y[1:-1], -y[:-2], u[1:-1]]), y[2:]
        self._true = true[2:, 2]
        self._estimates = [recursive_least_squares(Phi, Y, forgetting=lam).theta[:, 2] for lam in FORGETTING]

    def _spread(self, position: int) -> float:
        return rms((self._estimates[position] - self._true)[-_LAST:])

    def view(self, position: int) -> View:
        """The history of one estimate."""
        n = np.arange(self._true.size, dtype=float)
        curves = [Curve("measured", "True $b_1$", n, self._true)]
        curves += [Curve("before", "λ = 1", n, self._estimates[0])] if position else []
        curves.append(Curve("moved", f"λ = {FORGETTING[position]:g}", n, self._estimates[position]))
        said = f"Deviation from the true value over the last {_LAST} samples: {self._spread(position):.3f} (rms)."
        return View("Estimate of b1", tuple(curves), (0.0, 3.0), said, "Sample t", "Estimate", mark=500.0)

    def outcome(self) -> Outcome:
        """How much more the estimate fluctuates with 0.9 than with 0.99."""
        slow, fast = self._spread(FORGETTING.index(0.99)), self._spread(FORGETTING.index(0.9))
        ratio = fast / slow
        holds = 0 if ratio < 1.5 else 1 if ratio < 7 else 2
        return Outcome(
            holds,
            f"The deviation is {fast:.3f} in place of {slow:.3f} (rms): {ratio:.1f} times. The memory is ten times "
            "shorter, 10 samples in place of 100, and a mean of ten times fewer samples fluctuates √10, about 3, times "
            "as much.",
        )


OTHER_PLACES = (
    Prediction(
        "pole-moved",
        "Suppose the pole of your first-order model moves toward 1, to a third of its distance from 1, and the gain "
        "stays as it is. How does the response change?",
        (
            "It gets faster.",
            "It gets a little slower: the pole hardly moves.",
            "It gets about three times slower.",
        ),
        "Time constant, times",
        tuple(f"{factor:g}" for factor in FACTORS),
        FACTORS.index(1.0),
        FACTORS.index(3.0),
        MovedPole,
    ),
    Prediction(
        "order",
        "From order 1 to order 2 the mean squared error of the simulation falls. What does it do from order 2 to "
        "order 3?",
        ("It falls by about as much again.", "It falls by less.", "It grows."),
        "Order",
        tuple(map(str, ORDERS)),
        0,
        ORDERS.index(3),
        ModelOrder,
    ),
    Prediction(
        "forgetting-factor",
        "Long after the change the estimates fluctuate about the true values. How much more does the estimate of b1 "
        "fluctuate with λ = 0.9 than with λ = 0.99?",
        ("About as much.", "About 3 times as much.", "About 10 times as much."),
        "λ",
        tuple(f"{lam:g}" for lam in FORGETTING),
        0,
        FORGETTING.index(0.9),
        ForgettingFactor,
    ),
)
