"""Predictions on the record of the lab: a row of Phi shifted, the sign of a, an offset left in, the initial state."""

import numpy as np
from numpy.typing import NDArray

from labsid._arrays import FloatArray
from labsid.plots.predictions import Curve, View
from labsid.predictions.lab_data import LabData, fit, output_view, read_lab_data, rms, simulate
from labsid.predictions.prediction import Outcome, Prediction, Sources

SHIFTS = (-1, 0, 1, 2, 3)


class ShiftedRows:
    """A model fitted with the rows of Phi shifted against Y."""

    def __init__(self, sources: Sources) -> None:
        self._data = read_lab_data(sources)
        self._say = self._data.say

    def _fit(self, shift: int) -> tuple[FloatArray, float, float]:
        data = self._data
        theta, error = fit(data.u[: data.half], data.y[: data.half], 2, shift)
        simulated = simulate(theta, data.u)
        return simulated, np.sqrt(error), rms(data.y - simulated)

    def view(self, position: int) -> View:
        """The simulation with rows that are late by `SHIFTS[position]` samples."""
        shift = SHIFTS[position]
        simulated, of_fit, of_simulation = self._fit(shift)
        where = (
            f"{abs(shift)} sample{'s' * (abs(shift) > 1)} too {'late' if shift > 0 else 'early'}"
            if shift
            else "in place"
        )
        said = f"Error of the fit {self._say(of_fit)}, of the simulation {self._say(of_simulation)} (rms)."
        before = None if shift == 0 else self._fit(0)[0]
        return output_view(self._data, f"Rows of Φ {where}", simulated, "Simulation", said, before)

    def outcome(self) -> Outcome:
        """How the two errors change when the rows are one sample late."""
        _, fit_before, before = self._fit(0)
        _, fit_after, after = self._fit(1)
        holds = 2 if after > 3 * before else 1 if after > 1.2 * before else 0
        return Outcome(
            holds,
            f"The error of the fit is {self._say(fit_after)} in place of {self._say(fit_before)}, that of the "
            f"simulation {self._say(after)} in place of {self._say(before)}. The output hardly changes from one sample "
            "to the next, so a wrong row still predicts it; a simulation uses its own past outputs alone. (One sample "
            "too early, the row contains y(k) itself: the fit is perfect, and the simulated output stays zero.)",
        )


SIGNS = ((1, 1), (-1, 1), (1, -1), (-1, -1))


class SignOfA:
    """A model in which coefficients a have the sign of theta."""

    def __init__(self, sources: Sources) -> None:
        self._data = read_lab_data(sources)
        self._say = self._data.say
        self._theta = fit(self._data.u[: self._data.half], self._data.y[: self._data.half], 2)[0]

    def _poles(self, position: int) -> NDArray[np.complex128]:
        one, two = SIGNS[position]
        return np.roots([1.0, -one * self._theta[0], -two * self._theta[1]]).astype(np.complex128)

    def view(self, position: int) -> View:
        """The samples after the first change of the input, with the signs of a position."""
        data = self._data
        sign_1, sign_2 = SIGNS[position]
        first = int(np.flatnonzero(data.u)[0])
        part = slice(max(first - 3, 0), first + 30)
        theta = self._theta * np.array([sign_1, sign_2, 1, 1])
        poles = ", ".join(map(_pole, self._poles(position)))
        short = LabData(data.Ts, data.t[part], data.u[part], data.y[part], data.y_offset, data.unit)
        low, high = -3 * float(np.abs(data.y).max()), 3 * float(np.abs(data.y).max())
        with np.errstate(over="ignore", invalid="ignore"):
            moved = simulate(theta, data.u[: part.stop])[part]
        curves = (
            Curve("measured", "Record", short.t, short.y),
            Curve("moved", "Model", short.t, np.clip(moved, 9 * low, 9 * high)),
        )
        return View(
            "After the first change of the input",
            curves,
            (low, high),
            f"Poles of the model: {poles}.",
            ylabel=data.ylabel,
        )

    def outcome(self) -> Outcome:
        """What the pole of the largest size does when both signs are wrong."""
        poles = self._poles(3)
        largest = poles[np.argmax(np.abs(poles))]
        grows = abs(largest) > 1
        holds = (2 if largest.real < 0 else 3) if grows else 1
        return Outcome(
            holds,
            f"The wrong model has a pole at z = {_pole(largest)}. Each sample multiplies its mode by this number: its "
            "size says whether the mode grows, its sign whether it alternates.",
        )


def _pole(pole: complex) -> str:
    return f"{pole:.2f}" if abs(pole.imag) > 1e-9 else f"{pole.real:.2f}"


SHARES = (0.0, 0.1, 0.25, 0.5, 0.75, 1.0)


class OffsetLeftIn:
    """A model fitted while a share of the output's offset is left in y."""

    def __init__(self, sources: Sources) -> None:
        self._data = read_lab_data(sources)
        self._say = self._data.say

    def _fit(self, share: float) -> tuple[FloatArray, float, float]:
        data = self._data
        theta = fit(data.u[: data.half], data.y[: data.half] + share * data.y_offset, 2)[0]
        simulated = simulate(theta, data.u)
        slowest = float(np.abs(np.roots(np.r_[1.0, -theta[:2]])).max())
        return simulated, slowest, rms(data.y - simulated)

    def view(self, position: int) -> View:
        """The simulation of the model, without offset."""
        simulated, slowest, error = self._fit(SHARES[position])
        said = f"Slow pole at z = {slowest:.4f} ({_speed(slowest, self._data.Ts)}); error {self._say(error)} (rms)."
        before = None if position == 0 else self._fit(0.0)[0]
        title = f"{SHARES[position]:.0%} of the offset left in y while fitting"
        return output_view(self._data, title, simulated, "Simulation", said, before)

    def outcome(self) -> Outcome:
        """What the whole offset does to the slow pole and to the error."""
        _, pole_before, before = self._fit(0.0)
        _, pole_after, after = self._fit(1.0)
        slower = 1 - pole_after < 0.5 * (1 - pole_before)
        holds = 2 if slower and after > 3 * before else 1 if after > 3 * before else 0
        return Outcome(
            holds,
            f"The slow pole goes from {pole_before:.3f} to {pole_after:.4f}, the error from {self._say(before)} to "
            f"{self._say(after)}. A model without a constant term can hold a constant output at zero input only by a "
            "pole at 1: the constant, not the dynamics, decides the parameters.",
        )


def _speed(pole: float, Ts: float) -> str:
    return f"time constant {-Ts / np.log(pole):.3g} s" if 0 < pole < 0.9999 else "it never settles"


STARTS = (0.0, 0.5, 1.0, 1.5, 2.0)
_SETTLED = 0.05  # of the largest difference


class InitialState:
    """The second half simulated from a multiple of the right initial state."""

    def __init__(self, sources: Sources) -> None:
        data = read_lab_data(sources)
        theta = fit(data.u[: data.half], data.y[: data.half], 2)[0]
        part = slice(data.half, None)
        self._data = LabData(data.Ts, data.t[part], data.u[part], data.y[part], data.y_offset, data.unit)
        self._limits, self._say = data.limits, data.say
        self._rest = simulate(theta, data.u[part])
        self._free = simulate(theta, data.u)[part] - self._rest

    def _settling(self, start: float) -> float:
        """Time (s) until the difference from the right simulation stays below 5 % of its largest value."""
        difference = np.abs((start - 1) * self._free)
        if not difference.any():
            return 0.0
        return float(np.flatnonzero(difference > _SETTLED * difference.max())[-1] + 1) * self._data.Ts

    def view(self, position: int) -> View:
        """The second half from a multiple of the state carried over."""
        start = STARTS[position]
        error = rms(self._data.y - self._rest - start * self._free)
        said = f"Error {self._say(error)} (rms); the start matters for {self._settling(start):.3g} s."
        curves = (
            Curve("measured", "Record", self._data.t, self._data.y),
            Curve("before", "From the right state", self._data.t, self._rest + self._free),
            Curve("moved", "From the chosen state", self._data.t, self._rest + start * self._free),
        )
        return View(
            f"Second half, from {start:g} times the right state", curves, self._limits, said, ylabel=self._data.ylabel
        )

    def outcome(self) -> Outcome:
        """Which of the two wrong starts matters longer."""
        from_rest, twice = self._settling(0.0), self._settling(2.0)
        holds = 1 if abs(twice - from_rest) <= 0.1 * from_rest else 2 if twice > from_rest else 0
        return Outcome(
            holds,
            f"From rest the start matters for {from_rest:.3g} s, from twice the state for {twice:.3g} s. The model is "
            "linear: both differences are the same free response, with opposite signs, and its poles alone say how "
            "fast it decays.",
        )


LAB_PLACES = (
    Prediction(
        "row-of-phi",
        "Suppose the rows of Φ stand one sample too late: beside y(k) stands the row that belongs to y(k−1). The error "
        "of the fit stays small. How well does the fitted model simulate your record?",
        (
            "About as well as before.",
            "A little worse: about as much as the error of the fit grows.",
            "Much worse: the error is several times as large.",
        ),
        "Rows late by (samples)",
        tuple(f"{shift:+d}" if shift else "0" for shift in SHIFTS),
        SHIFTS.index(0),
        SHIFTS.index(1),
        ShiftedRows,
    ),
    Prediction(
        "sign-of-a",
        "Suppose you forget the minus signs, and build G with a1 = theta_hat[0] and a2 = theta_hat[1]. What does the "
        "simulated output do after the first change of the input?",
        (
            "It goes in the wrong direction, as far as the record goes in the right one.",
            "It settles, at a wrong level.",
            "It grows without end, with another sign at each sample.",
            "It grows without end, in one direction.",
        ),
        "Wrong signs",
        ("none", "a1", "a2", "a1 and a2"),
        0,
        3,
        SignOfA,
    ),
    Prediction(
        "offset-left-in",
        "Suppose you subtract the offset from u and forget it in y, then fit. The model is simulated with the same u "
        "as before. How does it differ from the right one?",
        (
            "Hardly: a constant does not change the dynamics.",
            "It has the right speed and a wrong gain.",
            "Its slow pole moves toward 1: the model hardly settles any more.",
        ),
        "Offset left in y",
        tuple(f"{share:.0%}" for share in SHARES),
        0,
        len(SHARES) - 1,
        OffsetLeftIn,
    ),
    Prediction(
        "initial-state",
        "From rest, the simulation of the second half begins too near zero. Suppose it begins from twice the right "
        "state. For how long does this wrong start matter?",
        ("Shorter than the start from rest.", "As long as the start from rest.", "Longer than the start from rest."),
        "Times the right state",
        tuple(f"{start:g}" for start in STARTS),
        STARTS.index(1.0),
        STARTS.index(2.0),
        InitialState,
    ),
)
