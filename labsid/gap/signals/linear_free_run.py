"""Free run of the linear model of every output on samples that it was not fitted to."""

from dataclasses import replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.model_file import export_model
from labsid.gap.record.holdout import held_out_samples
from labsid.gap.signals.input_responses import linear_parts
from labsid.gap.signals.roles import Signals, make_role


def simulate_linear_models(signals: Signals, order: int, other: Signals | None = None) -> FloatArray:
    """Outputs of the linear models of a record, fitted without its held-out samples, or on another record.

    Parameters
    ----------
    signals : Signals
    order : int
    other : Signals, optional

    Returns
    -------
    ndarray, shape (N, ny)
    """
    runs = []
    for j in range(len(signals.outputs)):
        parts = linear_parts([signals.data(i, j) for i in range(len(signals.inputs))])
        role = make_role(signals, j, parts.strongest, parts, order)
        if other is None:
            rows = role.data.rows & ~held_out_samples(role.data.samples)
            fit = fit_baseline(replace(role.data, rows=rows), role.base.structure)
            runs.append(role.data.y_scale.back(fit.output))
            continue
        fit = fit_baseline(role.data, role.base.structure)
        scaled = {
            name: np.asarray(scale.of(other.u[:, i]))
            for i, (name, scale) in enumerate(zip(signals.inputs, signals.input_scales, strict=True))
        }
        fit = replace(fit, hypothesis=fit.hypothesis.with_signals(scaled))
        u, y = (np.ascontiguousarray(x) for x in (other.u[:, parts.strongest], other.y[:, j]))
        runs.append(export_model(role.data, fit).simulate(u, y))
    return np.column_stack(runs)
