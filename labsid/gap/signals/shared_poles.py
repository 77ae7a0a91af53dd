"""Whether the outputs share the poles of two coupled systems of second order, as two joints do."""

from collections.abc import Sequence

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.effects.further_inputs import FurtherInput
from labsid.gap.fits.fitting import Fit, Problem, finish, fit_from
from labsid.gap.record.data import Data
from labsid.gap.signals.input_responses import LinearParts
from labsid.gap.signals.roles import Role, Signals, make_role

FREQUENCIES = 0.4, 0.6, 1.5, 2.5  # of the second pair over the first one: start values; numerics
DAMPINGS = 0.05, 0.3  # of both pairs: start values; numerics
SAME = 1.1  # mean square error with the poles of another output over that with poles of its own; set by hand


def may_be_coupled(signals: Signals, parts: Sequence[LinearParts]) -> bool:
    """Whether every one of several outputs is moved by several inputs."""
    return len(signals.outputs) > 1 and all(own.moves.sum() > 1 for own in parts)


def coupled_starts(
    signals: Signals, parts: Sequence[LinearParts], order: int, plain: Sequence[Fit]
) -> list[FloatArray]:
    """Parameters of four poles by output, that its responses to all inputs have in common; empty without a fit.

    Parameters
    ----------
    signals : Signals
    parts : sequence of LinearParts
        By output.
    order : int
        Of the responses otherwise.
    plain : sequence of Fit
        By output: the linear fit with poles for each input.

    Returns
    -------
    list of ndarray
        As of the linear structure of fourth order.
    """
    starts = []
    for j, (own, plain_fit) in enumerate(zip(parts, plain, strict=True)):
        fit = _fitted(make_role(signals, j, own.strongest, own, order, "coupled"), plain_fit)
        if fit is None:
            return []
        starts.append(fit.theta)
    return starts


def have_poles_in_common(fits: Sequence[tuple[Data, Fit]]) -> bool:
    """Whether the linear dynamics of all outputs have the same poles: each is fitted as well with those of another one.

    A mode of one actuator or one sensor does not act through every input on every output.
    """
    best = max(fits, key=lambda one: one[1].free_run)[1]
    poles = best.theta[best.hypothesis.slices["plant"]]
    for data, fit in fits:
        theta = fit.theta.copy()
        at = fit.hypothesis.slices["plant"]
        if fit is best or at.stop - at.start != poles.size:
            continue
        theta[at] = poles
        point = Problem(data, fit.hypothesis).point(theta)
        if point is None or finish(data, fit.hypothesis, point).free_run > SAME * fit.free_run:
            return False
    return True


def _fitted(role: Role, plain: Fit) -> Fit | None:
    """The fit of fourth order, from the poles of each input of the fit `plain` with poles for each."""
    structure = role.base.structure
    pairs = [plain.rates]
    for effect in plain.hypothesis.additive:
        if isinstance(effect, FurtherInput):
            c, k = np.multiply(effect.about, np.exp(plain.theta[plain.hypothesis.slices[effect.key]]))
            pairs.append((float(c), float(k)))
    names = [parameter.name for parameter in structure.parameters]
    fits = []
    for c, k in pairs[:2]:
        for ratio in FREQUENCIES:
            for damping in DAMPINGS:
                theta = np.zeros(len(names))
                theta[names.index("log_c")], theta[names.index("log_k")] = np.log(c), np.log(k)
                theta[names.index("log_frequency")] = 0.5 * np.log(k) + np.log(ratio)
                theta[names.index("log_damping")] = np.log(damping)
                fit = fit_from(role.data, structure, np.clip(theta, *structure.bounds), iterations=15)
                if fit is not None:
                    fits.append(fit)
    best = min(fits, key=lambda fit: fit.cost, default=None)
    return None if best is None else fit_from(role.data, structure, best.theta, iterations=40)
