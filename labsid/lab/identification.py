"""The complete procedure of the lab: offsets, Phi, theta, model, free runs, mean squared errors."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from labsid._arrays import FloatArray, freeze
from labsid.lab.arx import ArxModel, arx_from_theta, fit_arx
from labsid.lab.excitation import Excitation, excited_in_other_units, persistent_excitation
from labsid.lab.offset import Offsets, find_offsets, remove_offsets
from labsid.lab.verification import Verification, verify
from labsid.least_squares.solve import LeastSquares
from labsid.model_structures.structures import Regression
from labsid.records.record import Record, between_outputs, bridge_gaps
from labsid.records.several_signals import one_signal_each


@dataclass(frozen=True, slots=True, eq=False)
class Identification:
    """Results of the lab's procedure on a record.

    Attributes
    ----------
    record : Record
        The record as it was loaded.
    offsets : Offsets
        Exercise 1c.
    u, y : ndarray, shape (N,)
        Offset-free input and output (Fig. 6); NaN where the record has no output.
    regression : Regression
        Phi and Y of the first half, exercise 2a.
    fit : LeastSquares
        Exercise 2b.
    excitation : Excitation
        Test of Phi'Phi for positive definiteness.
    model : ArxModel
        The identified model about its operating point, exercise 2c.
    verification : Verification
        The free runs, exercise 3.
    warnings : tuple of str
        Empty for the lab's own file.
    """

    record: Record
    offsets: Offsets
    u: FloatArray
    y: FloatArray
    regression: Regression
    fit: LeastSquares
    excitation: Excitation
    model: ArxModel
    verification: Verification
    warnings: tuple[str, ...]

    def __post_init__(self) -> None:
        freeze(self, u=self.u, y=self.y)

    @property
    def incomplete_rows(self) -> int:
        """Rows left out of Phi because an output in them is missing from the record."""
        return self.regression.stop - self.regression.start - self.regression.Y.size


def identify(record: Record, order: int = 2, start: int = 2) -> Identification:
    """Identify a model from the first half of a record and verify it on the second half and on the whole.

    Parameters
    ----------
    record : Record
    order : int
        Order of the model.
    start : int
        First sample k with a row in Phi; below `order`, the lags before sample 0 are taken as zero.

    Returns
    -------
    Identification

    Raises
    ------
    ValueError
        If the input never changes, the first half has too few rows, the input does not excite every parameter,
        or the free run of an unstable model overflows.

    Notes
    -----
    UNSW lab, exercises 1c to 3a, and with ``order=1`` the post-lab exercise. The rows are the samples
    k = start .. N // 2 - 1, less those with an output that is missing from the record,
    which begins with its first output and ends with its last one.
    """
    record = between_outputs(one_signal_each(record, "identify (identify_system takes several)"))
    half = len(record) // 2
    if order < 1:
        raise ValueError(f"order must be at least 1; got {order}.")
    if start < 0 or half - start < 2 * order:
        raise ValueError(
            f"start must be 0 or more and leave {2 * order} rows in the first half, one for each unknown of "
            f"order {order}; got start {start} and {half} samples there. Use a longer record or lower order."
        )
    measured = ~record.missing
    offsets = find_offsets(record.u, bridge_gaps(record.y))
    u, y = remove_offsets(record.u, bridge_gaps(record.y), offsets)
    arx = fit_arx(u, y, record.Ts, order, start, half, measured)
    if arx.fit.status != "unique":
        raise ValueError(_why_not_unique(u[:half], y[:half], arx.regression.Phi, arx.fit, order))
    model = arx_from_theta(arx.fit.theta, record.Ts, offsets.u_offset, offsets.y_offset)
    return Identification(
        record=record,
        offsets=offsets,
        u=u,
        y=np.where(measured, y, np.nan),
        regression=arx.regression,
        fit=arx.fit,
        excitation=persistent_excitation(arx.regression.Phi),
        model=model,
        verification=verify(model, u, y, measured),
        warnings=_warnings(offsets, model, start),
    )


def to_json_dict(identification: Identification) -> dict[str, Any]:
    """Convert the results to the JSON object of ``labsid identify --json``.

    Parameters
    ----------
    identification : Identification

    Returns
    -------
    dict
        Numbers and lists: ``Ts, samples, u_offset, y_offset, settled, order, theta, a, b, poles, mse,
        condition_number``; indices zero-based and half-open, poles as [real, imaginary].
    """
    model, verification = identification.model, identification.verification
    return {
        "Ts": float(model.Ts),
        "samples": len(identification.record),
        "u_offset": float(model.u_offset),
        "y_offset": float(model.y_offset),
        "settled": list(identification.offsets.settled),
        "order": model.order,
        "theta": model.theta.tolist(),
        "a": model.a.tolist(),
        "b": model.b.tolist(),
        "poles": [[float(pole.real), float(pole.imag)] for pole in model.poles],
        "mse": {
            "all": verification.mse_all,
            "second_half": verification.mse_second_half,
            "second_half_carried": verification.mse_second_half_carried,
        },
        "condition_number": identification.fit.condition_number,
    }


def _why_not_unique(u: FloatArray, y: FloatArray, Phi: FloatArray, fit: LeastSquares, order: int) -> str:
    if excited_in_other_units(Phi):
        return (
            f"the columns of Phi must be of sizes that one matrix can hold; got outputs up to {np.abs(y).max():.3g} "
            f"and inputs up to {np.abs(u).max():.3g}. Convert one of them to other units."
        )
    if np.all(u == u[0]):
        cause = "the input never changes in the first half"
    elif np.all(y == y[0]):
        cause = "the output never changes in the first half"
    else:
        cause = "the signals of the first half are too simple for this order"
    return (
        f"the input must be persistently exciting; got a Phi of rank {fit.rank} for {2 * order} unknowns: "
        f"{cause}. Record a run with more changes of the input, or lower the order."
    )


def _warnings(offsets: Offsets, model: ArxModel, start: int) -> tuple[str, ...]:
    texts = []
    k0, k1 = offsets.settled
    if offsets.status == "too short":
        texts.append(
            f"the input first changes at sample {offsets.first_period}, too early to see whether the output was "
            "settled; its mean until then may not be the output offset, which shifts every free run by a constant"
        )
    elif offsets.status == "not settled":
        texts.append(
            f"the output does not settle before the first change of the input; its mean over samples {k0} to "
            f"{k1 - 1} is used as the output offset"
        )
    if k0 > 0:
        texts.append(
            f"the record does not start at rest: samples 0 to {k0 - 1} are a start-up, which a simulation "
            "from rest cannot reproduce; the MSE over the whole record includes it"
        )
        if start < model.order:
            texts.append(
                f"rows from sample {start} take the lags before sample 0 as zero, but the record does not start at "
                f"rest; start at {model.order} or later"
            )
    if not model.is_stable:
        texts.append(f"the identified model is unstable: its largest pole has magnitude {abs(model.poles[0]):.4g}")
    return tuple(texts)
