"""The procedure of the lab on a record of several signals: offsets, Phi and theta of each output, free runs."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from labsid._arrays import FloatArray, freeze
from labsid.lab.arx_system import ArxSystem, fit_arx_system
from labsid.lab.equation import Equation
from labsid.lab.offset import SignalOffsets, find_signal_offsets
from labsid.lab.several_findings import signal_faults
from labsid.lab.system_verification import SystemVerification, verify_system
from labsid.records.record import Record, between_outputs, bridge_gaps


@dataclass(frozen=True, slots=True, eq=False)
class SystemIdentification:
    """Results of the lab's procedure on a record of several signals.

    Attributes
    ----------
    record : Record
        From its first output to its last one.
    offsets : SignalOffsets
    u : ndarray, shape (N, nu)
        Offset-free inputs.
    y : ndarray, shape (N, ny)
        Offset-free outputs; NaN where the record has none.
    equations : tuple of Equation
        Phi, theta and standard errors of each output, from the first half.
    model : ArxSystem
        The identified system about its operating point.
    verification : SystemVerification
    warnings : tuple of str
    """

    record: Record
    offsets: SignalOffsets
    u: FloatArray
    y: FloatArray
    equations: tuple[Equation, ...]
    model: ArxSystem
    verification: SystemVerification
    warnings: tuple[str, ...]

    def __post_init__(self) -> None:
        freeze(self, u=self.u, y=self.y)


def identify_system(record: Record, order: int = 2, start: int = 2, coupled: bool = False) -> SystemIdentification:
    """Identify a system from the first half of a record and verify it on the second half and on the whole.

    Parameters
    ----------
    record : Record
        With any number of inputs and outputs.
    order : int
        Order of the equation of each output.
    start : int
        First sample k with a row in Phi; below `order`, the lags before sample 0 are taken as zero, if the record
        shows a rest.
    coupled : bool
        Whether the equation of each output holds the past of the other outputs; see `fit_arx_system`.

    Returns
    -------
    SystemIdentification

    Raises
    ------
    ValueError
        If a signal never moves or is proportional to another one, the first half has too few rows, the inputs do not
        excite every parameter, or the free run of an unstable model overflows; with the name of the column.

    Notes
    -----
    UNSW lab, exercises 1c to 3a, for each output.
    """
    record = between_outputs(record)
    filled = replace(record, y=bridge_gaps(record.y))
    faults = signal_faults(filled)
    if faults:
        raise ValueError(faults[0][1])
    half = len(record) // 2
    _check_rows(record, order, start, half, coupled)
    measured = ~np.isnan(record.output_columns)
    offsets = find_signal_offsets(filled.input_columns, filled.output_columns, half)
    u, y = filled.input_columns - offsets.u_offset, filled.output_columns - offsets.y_offset
    start = start if offsets.status == "rest" else max(start, order)
    names = {"inputs": record.inputs, "outputs": record.outputs}
    fitted = fit_arx_system(u, y, record.Ts, order, start, half, measured, coupled, **names)
    for name, equation in zip(record.outputs, fitted.equations, strict=True):
        if equation.fit.status != "unique":
            raise ValueError(_why_not_unique(name, u[:half], equation, record))
    model = replace(fitted.model, u_offset=offsets.u_offset, y_offset=offsets.y_offset)
    return SystemIdentification(
        record=record,
        offsets=offsets,
        u=u,
        y=np.where(measured, y, np.nan),
        equations=fitted.equations,
        model=model,
        verification=verify_system(model.state_space, u, y, measured),
        warnings=tuple(_warnings(record, offsets, model)),
    )


def to_json_dict(identification: SystemIdentification) -> dict[str, Any]:
    """Convert the results to the JSON object of ``labsid identify --json`` for several signals.

    Parameters
    ----------
    identification : SystemIdentification

    Returns
    -------
    dict
        ``Ts, samples, signals, coupled, order, theta, stderr, a, b, poles, static_gain, mse, condition_number``: by
        name of the output, and below it by that of the input where there is one number for each pair.
    """
    model, runs, record = identification.model, identification.verification, identification.record
    nu = len(model.inputs)
    signals = zip(record.signal_names, record.units, [*model.u_offset.tolist(), *model.y_offset.tolist()], strict=True)
    listed = [{"name": name, "unit": unit, "offset": offset} for name, unit, offset in signals]
    fits = [equation.fit for equation in identification.equations]

    def by_output(values: Any) -> dict[str, Any]:
        return dict(zip(model.outputs, values, strict=True))

    def by_pair(values: FloatArray) -> dict[str, Any]:
        return by_output([dict(zip(model.inputs, row, strict=True)) for row in _numbers(values)])

    return {
        "Ts": float(model.Ts),
        "samples": len(record),
        "signals": {"inputs": listed[:nu], "outputs": listed[nu:]},
        "offsets": identification.offsets.status,
        "order": model.order,
        "coupled": model.coupled,
        "theta": by_output([fit.theta.tolist() for fit in fits]),
        "stderr": by_output([_numbers(fit.stderr) for fit in fits]),
        "a": model.a.tolist(),
        "b": model.b.tolist(),
        "poles": [[float(pole.real), float(pole.imag)] for pole in model.poles],
        "static_gain": by_pair(model.static_gain),
        "mse": {
            "all": by_output(_numbers(runs.mse_all)),
            "second_half": by_output(_numbers(runs.mse_second_half)),
            "second_half_carried": by_output(_numbers(runs.mse_second_half_carried)),
            "second_half_estimated": by_output(_numbers(runs.mse_second_half_estimated)),
            "without_input": by_pair(runs.mse_without),
        },
        "condition_number": by_output(_numbers(np.array([fit.condition_number for fit in fits]))),
    }


def _numbers(values: FloatArray) -> list[Any]:
    """Lists with None in place of what is not finite, which JSON has no number for."""
    found = values.astype(object)
    found[~np.isfinite(values)] = None
    return found.tolist()


def _check_rows(record: Record, order: int, start: int, half: int, coupled: bool) -> None:
    if order < 1:
        raise ValueError(f"order must be at least 1; got {order}.")
    blocks = len(record.inputs) + (len(record.outputs) if coupled else 1)
    if start < 0 or half - start < blocks * order:
        raise ValueError(
            f"start must be 0 or more and leave {blocks * order} rows in the first half, one for each unknown of "
            f"{record.outputs[0]}: order {order} of {blocks} signals; got start {start} and {half} samples there. Use "
            "a longer record, a lower order, or fewer inputs."
        )


def _why_not_unique(name: str, u: FloatArray, equation: Equation, record: Record) -> str:
    still = [one for one, x in zip(record.inputs, u.T, strict=True) if not np.ptp(x)]
    cause = "the inputs of the first half are too simple, or move together"
    if still:
        cause = f"{', '.join(still)} never {'changes' if len(still) == 1 else 'change'} in the first half"
    return (
        f"the inputs must be persistently exciting; got a Phi of rank {equation.fit.rank} for the "
        f"{equation.regression.Phi.shape[1]} unknowns of {name}: {cause}. Record a run in which each input moves by "
        "itself, lower the order, or leave an input out (--inputs)."
    )


def _warnings(record: Record, offsets: SignalOffsets, model: ArxSystem) -> list[str]:
    warnings = []
    if offsets.status == "means":
        warnings.append(
            "the inputs move from the first samples on, so that the record shows no rest; the means of the first half "
            "are the offsets"
        )
    else:
        words = {"too short": "begins too briefly at rest", "not settled": "is not settled before an input changes"}
        named = [(name, offset.status) for name, offset in zip(record.outputs, offsets.outputs, strict=True)]
        warnings += [f"{name} {words[status]}: its offset is uncertain" for name, status in named if status in words]
    if record.reference is not None:
        warnings.append(
            "it is a closed-loop record (it has a reference): noise reaches inputs and outputs, and biases theta"
        )
    if not model.is_stable:
        warnings.append(f"the identified model is unstable: its largest pole has magnitude {abs(model.poles[0]):.4g}")
    return warnings
