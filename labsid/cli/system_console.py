"""Text output of ``labsid identify`` for several signals."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from labsid._texts import wrapped
from labsid.cli.console import theta_texts

if TYPE_CHECKING:  # a slow import
    from labsid.lab.system_identification import SystemIdentification

_MOST_PAIRS = 9  # whose transfer functions are printed


def system_text(identification: "SystemIdentification") -> str:
    """Render an identification of several signals as plain text.

    Parameters
    ----------
    identification : SystemIdentification

    Returns
    -------
    str
        Offsets, theta of each output with standard errors, transfer functions, errors by output and by pair, warnings.
    """
    from labsid.lab.arx import to_tf
    from labsid.records.record import reading_notes

    record, model = identification.record, identification.model
    lines = [
        f"{record.name}: {len(record)} samples, Ts = {record.Ts:.9g} s",
        *(wrapped(f"Read: {note}.") for note in reading_notes(record)),
        "",
        *_offsets(identification),
        *_thetas(identification),
        "",
    ]
    if len(model.inputs) * len(model.outputs) <= _MOST_PAIRS:
        lines += [str(to_tf(model)).strip(), ""]
    lines += [*_errors(identification), "", *_pairs(identification), "", _dynamics(identification)]
    lines += [wrapped(f"Warning: {warning}.") for warning in identification.warnings]
    return "\n".join(lines)


def _offsets(identification: "SystemIdentification") -> list[str]:
    record, model = identification.record, identification.model
    kinds = ["input"] * len(model.inputs) + ["output"] * len(model.outputs)
    offsets = [f"{offset:.6g}" for offset in (*model.u_offset, *model.y_offset)]
    rows = zip(record.signal_names, kinds, record.units, offsets, strict=True)
    return _table([("signal", "", "unit", "offset"), *rows])


def _thetas(identification: "SystemIdentification") -> list[str]:
    model, lines = identification.model, []
    for i, (name, equation) in enumerate(zip(model.outputs, identification.equations, strict=True)):
        rows, fit = equation.regression, equation.fit
        theta = theta_texts(fit.theta, fit.stderr)
        others = [m for m in range(len(model.outputs)) if m != i]
        of_outputs = [i, *others] if fit.theta.size > model.order * (1 + len(model.inputs)) else [i]
        blocks = [("-a", model.outputs[m]) for m in of_outputs] + [("b", name) for name in model.inputs]
        symbols = [(f"{symbol}{lag + 1}", signal) for symbol, signal in blocks for lag in range(model.order)]
        named = [f"{symbol} of {signal}" for symbol, signal in symbols]
        width = max(map(len, named)) + 3
        left_out = rows.stop - rows.start - rows.Y.size
        lines += [
            "",
            f"theta of {name}, ± one standard error; Phi: rows k = {rows.start} to {rows.stop - 1}, condition number "
            f"{fit.condition_number:.2f}{f', {left_out} rows without an output left out' if left_out else ''}",
            *(f"  {symbol:<{width}}{text}" for symbol, text in zip(named, theta, strict=True)),
        ]
    return lines


def _errors(identification: "SystemIdentification") -> list[str]:
    """Root-mean-square errors of the free runs, and the share of the motion of each output that the model follows."""
    runs, model = identification.verification, identification.model
    unseen = identification.y[runs.half :]
    fits = 1 - np.sqrt(runs.mse_second_half_carried) / np.nanstd(unseen, axis=0)
    columns = (runs.mse_all, runs.mse_second_half, runs.mse_second_half_carried, runs.mse_second_half_estimated)
    rows = [
        (name, *(f"{error:.5g}" for error in np.sqrt(errors)), f"{fit:.1%}")
        for name, fit, *errors in zip(model.outputs, fits, *columns, strict=True)
    ]
    head = ("", "whole record", "2nd half, from rest", "state carried over", "state estimated", "fit, carried over")
    return ["rms error of the free run, by output", *_table([head, *rows])]


def _pairs(identification: "SystemIdentification") -> list[str]:
    runs, model = identification.verification, identification.model
    rows = [
        (name, f"{np.sqrt(error):.5g}", *(f"{one:.5g}" for one in np.sqrt(without)))
        for name, error, without in zip(model.outputs, runs.mse_second_half_carried, runs.mse_without, strict=True)
    ]
    head = ("", "with all inputs", *(f"without {name}" for name in model.inputs))
    return ["rms error by pair: second half, state carried over, one input left at its offset", *_table([head, *rows])]


def _dynamics(identification: "SystemIdentification") -> str:
    model = identification.model
    pole = model.poles[0]
    if not model.is_stable or pole == 0:
        return f"Order {model.order} for each output, largest pole {abs(pole):.5g}."
    tau = -model.Ts / np.log(np.abs(pole))
    gains = [
        f"{name} {', '.join(f'{gain:.4g}' for gain in row)}"
        for name, row in zip(model.outputs, model.static_gain, strict=True)
    ]
    return wrapped(
        f"It is stable, with longest time constant {tau:.3g} s and static gains from {', '.join(model.inputs)}: "
        f"{'; '.join(gains)}."
    )


def _table(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows with columns of equal width: the first to the left, the others to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for first, *others in rows:
        cells = [f"{first:<{widths[0]}}", *(f"{cell:>{width}}" for cell, width in zip(others, widths[1:], strict=True))]
        lines.append(f"  {'   '.join(cells)}".rstrip())
    return lines
