"""The same effects in other forms: at another place of the chain, as a special or the general case, or one fewer."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.data import Data
from labsid.gap.effects import curves, disturbance, drifts, dynamics, input, output
from labsid.gap.effects.base import Effect
from labsid.gap.fitting import Fit, finish, minimize
from labsid.gap.hypothesis import Hypothesis
from labsid.gap.plants import Plant
from labsid.gap.responses import real_rates

LIMIT_SHARE = 0.03  # of the samples, where a stop is tried
RESTART_POLE = 10.0  # rate of a pole that a fit has lost, in the record
FAST_POLE_RATIO = 10.0  # rate of the pole that is left over, where the fit has spent one on an integrator
REMOVAL_ITERATIONS = 6  # iterations after an effect was taken out

LAGS: tuple[Effect, ...] = (dynamics.ExtraLag(), dynamics.ExtraLag("ahead"))
MODES: tuple[Effect, ...] = (dynamics.Resonance(), dynamics.Resonance("ahead"), dynamics.Resonance("beside"))
SENSOR_DRIFTS: tuple[Effect, ...] = tuple(output.Drift(bends) for bends in ("1", "3", "6", "10", "16", "settle"))
POSITIONS: tuple[tuple[Effect, ...], ...] = (
    LAGS,
    MODES,
    (dynamics.CoulombFriction("speed"), dynamics.CoulombFriction("speed-lag")),
)
"""What may stand at several places of the chain, which are the same to linear dynamics."""
ACTUATOR_ORDERS: tuple[tuple[Effect, ...], ...] = (
    (input.RateLimit(), input.RateLimit("behind")),
    (input.Nonlinearity(), input.Nonlinearity("first")),
)
"""What may stand at several places of the actuator, which are the same where nothing else bends the command."""
HISTORY_FORMS: dict[Effect, tuple[Effect, ...]] = {
    input.Delay(): (input.Delay("switched"), input.Delay("no-zero switched")),
    input.Delay("no-zero"): (input.Delay("no-zero switched"),),
    input.RateLimit(): (input.RateLimit("switched"), input.RateLimit("timed")),
}
"""What remembers the command: where the record begins with a new one, and told to the first moment of each sample."""
SPLINE_FORMS: dict[Effect, Effect] = {
    input.Nonlinearity(): input.Nonlinearity("rich"),
    output.Nonlinearity(): output.Nonlinearity("rich"),
}
"""Cubic curves, and splines."""
LOAD, LEAK = disturbance.LoadStep(), disturbance.Leak("leak")
INNER_LOAD, UPSTREAM_LOAD = disturbance.InnerLoad("inside"), disturbance.InnerLoad("ahead")
"""A load on linear dynamics; the general case, whose search begins at what the former finds; on a nonlinear state."""


OTHER_OUTFLOWS: dict[str, tuple[Effect, ...]] = {
    which + side: tuple(dynamics.SqrtOutflow(other + side) for other in ("both", "upper", "lower") if other != which)
    for which in ("both", "upper", "lower")
    for side in ("", "-flipped")
}
"""By variant, the other outflows that may go with the root."""
BOTH_BRIMS: dict[Effect, Effect] = {
    dynamics.Overflow(which + side): dynamics.Overflow("both" + side)
    for which in ("upper", "lower")
    for side in ("", "-flipped")
}
"""The brim of one tank, and those of both."""
OTHER_TANK: dict[Effect, Effect] = {
    dynamics.Overflow(one + side): dynamics.Overflow(other + side)
    for one, other in (("upper", "lower"), ("lower", "upper"))
    for side in ("", "-flipped")
}
"""The brim of the same tank where the other one stands before it, not behind it."""
LOW_LIMIT, HIGH_LIMIT, BOTH_LIMITS = output.Saturation("low"), output.Saturation("high"), output.Saturation("both")
GENERAL_FORMS: dict[Effect, tuple[Effect, ...]] = HISTORY_FORMS | {
    special: (general,)
    for special, general in (SPLINE_FORMS | BOTH_BRIMS | {LOW_LIMIT: BOTH_LIMITS, HIGH_LIMIT: BOTH_LIMITS}).items()
}
"""Special cases, and the general ones on the same dynamics."""
PERIODIC, PERIODIC_LOAD = disturbance.Periodic(), disturbance.Periodic("load")
INNER_PERIODIC, UPSTREAM_PERIODIC = disturbance.InnerPeriodic("inside"), disturbance.InnerPeriodic("ahead")
"""A wave behind the sensor's curve, ahead of it, and on dynamics with a nonlinear state."""
INNER_FORMS: dict[Effect, Effect] = {LOAD: INNER_LOAD} | {
    drifts.PoleDrift(bends): drifts.InnerPoleDrift(bends) for bends in ("1", "4")
}
"""What changes linear dynamics, and the same in dynamics with a nonlinear state."""
OTHER_DRIFTS: dict[Effect, Effect] = {
    one(bends): other(bends)
    for one, other in (
        (drifts.GainDrift, drifts.InnerPoleDrift),
        (drifts.InnerPoleDrift, drifts.GainDrift),
    )
    for bends in ("1", "4")
}
"""What may drift of dynamics with a nonlinear state."""


def alternative_forms(hypothesis: Hypothesis) -> list[Hypothesis]:
    """The same effects in another form: a lag or a mode at another place to a nonlinear state, or a special case."""
    found = []
    for i, effect in enumerate(hypothesis.effects[hypothesis.n_given :], hypothesis.n_given):
        forms: list[Effect] = [LOAD] if effect == LEAK else []
        forms += [grown] if effect == LOAD and (grown := leak_form(hypothesis.plant)) else []
        forms += [other for other in _periodic_forms(hypothesis) if effect.name == PERIODIC.name and other != effect]
        if hypothesis.plant.in_series and effect in (INNER_LOAD, UPSTREAM_LOAD):
            forms += [UPSTREAM_LOAD if effect == INNER_LOAD else INNER_LOAD]
        forms += [other for other in OTHER_OUTFLOWS.get(effect.variant, ()) if effect.name == "sqrt-outflow"]
        forms += GENERAL_FORMS.get(effect, ())
        forms += [OTHER_DRIFTS[effect]] if effect in OTHER_DRIFTS and hypothesis.plant.nonlinear else []
        forms += [OTHER_TANK[effect]] if effect in OTHER_TANK and not _has_root(hypothesis.plant) else []
        groups = POSITIONS if hypothesis.plant.nonlinear else ()
        groups += ACTUATOR_ORDERS if sum(e.name != "input-delay" for e in hypothesis.inputs) > 1 else ()
        forms += [form for group in groups if effect in group for form in group if form != effect]
        for form in forms:
            effects = (*hypothesis.effects[:i], form, *hypothesis.effects[i + 1 :])
            found.append(Hypothesis(effects, hypothesis.n_given, hypothesis.given))
    return found


def _periodic_forms(hypothesis: Hypothesis) -> list[Effect]:
    """Where a wave may enter, as far as that makes a difference."""
    waves: list[Effect] = [PERIODIC]
    waves += [PERIODIC_LOAD] if any(not effect.is_limit for effect in hypothesis.outputs) else []
    waves += [INNER_PERIODIC] if hypothesis.plant.nonlinear else []
    waves += [UPSTREAM_PERIODIC] if hypothesis.plant.in_series else []
    return waves


def leak_form(plant: Plant) -> Effect | None:
    """A load that grows with the state, as these dynamics hold it."""
    if plant.nonlinear:
        return INNER_LOAD
    return LEAK if plant.kind == "linear" else None


def transfer_theta(fit: Fit, other: Hypothesis) -> FloatArray:
    """Numbers of a fit for a hypothesis of other forms: of the same part, or, by name, of a part that it has not."""
    old = fit.hypothesis
    theta = np.zeros(len(other.parameters))
    spare: dict[str, float] = {}
    for key, place in old.slices.items():
        if key == "plant" or key not in other.slices:
            spare |= {p.name: x for p, x in zip(old.parameters[place], fit.theta[place], strict=True)}
    for i, parameter in enumerate(other.parameters):
        theta[i] = spare.get(parameter.name, 0.0)
    for key, place in other.slices.items():
        if key != "plant" and key in old.slices:
            theta[place] = fit.theta[old.slices[key]]
    for plain, rich in SPLINE_FORMS.items():
        if rich in other.effects and plain in old.effects:
            theta[other.slices[rich.key]] = curves.spline_coefficients(fit.theta[old.slices[plain.key]])
    if not other.delay_is_an_effect:
        theta[0] = fit.theta[0]
    if BOTH_LIMITS in other.effects and BOTH_LIMITS not in old.effects:
        stops = theta[other.slices[BOTH_LIMITS.key]]
        missing = 0 if HIGH_LIMIT in old.effects else 1
        stops[missing] = np.quantile(fit.output, (LIMIT_SHARE, 1.0 - LIMIT_SHARE)[missing])
    if old.plant.kind == other.plant.kind == "tanks":
        _set_second_brim(fit, other.plant, theta[other.slices["plant"]])
        _swap_tanks(old.plant, other.plant, theta[other.slices["plant"]])
        _move_roots(old.plant, other.plant, theta[other.slices["plant"]])
    return theta


def leak_starts(fit: Fit, other: Hypothesis) -> list[FloatArray]:
    """Where the search for a load that grows begins, given the fit of a load that does not."""
    starts = [transfer_theta(fit, other)]
    if other.effects[-1] != LEAK:
        return starts
    own, samples = other.slices["plant"], fit.output.size
    starts[0][own][other.plant.index("turn")] = 0.5
    slow, fast = real_rates(*fit.rates)
    if slow * samples < 1.0:  # an integrator to the load alone
        for slow, quick in ((RESTART_POLE / samples, fast), (fast, FAST_POLE_RATIO * fast)):
            starts.append(starts[0].copy())
            starts[-1][own][:2] = np.log((slow + quick, slow * quick))
    return starts


def _set_second_brim(fit: Fit, new: Plant, theta: FloatArray) -> None:
    """Give the other tank a brim a little below its highest level; in place."""
    old, own = fit.hypothesis.plant, fit.plant_theta
    if new.brim != 3 or old.brim not in (1, 2):
        return
    level = (fit.output - fit.gains[1]) / (fit.gains[0] or 1.0)
    top = float(np.quantile(level, 1.0 - LIMIT_SHARE))
    if old.brim == 1:
        theta[new.index("brim2")] = top
        return
    theta[new.index("brim2")] = own[old.index("brim")]
    flow = np.sqrt(max(top, 0.0)) if old.lower_root else top
    theta[new.index("brim")] = flow**2 if old.upper_root else flow


def _swap_tanks(old: Plant, new: Plant, theta: FloatArray) -> None:
    """Let the tank with the brim keep its rate where it has changed places with the other one; in place."""
    if {old.brim, new.brim} == {1, 2}:
        theta[:2] = theta[1::-1].copy()
        theta[new.index("h1")], theta[new.index("h2")] = theta[new.index("h2")], theta[new.index("h1")]


def _has_root(plant: Plant) -> bool:
    return plant.upper_root or plant.lower_root


def _move_roots(old: Plant, new: Plant, theta: FloatArray) -> None:
    """Let tanks run at the rates of before, their roots at other outflows; in place."""
    if not (_has_root(old) and _has_root(new)):
        return
    slope = new.root_slope(theta)
    changed = (int(new.upper_root) - int(old.upper_root), int(new.lower_root) - int(old.lower_root))
    for sign, rate, brims in zip(
        changed, ("log_a", "log_b"), ((1, "brim"), (2, "brim" if new.brim == 2 else "brim2")), strict=True
    ):
        theta[new.index(rate)] += sign * np.log(slope)
        if sign and new.brim in (brims[0], 3):
            at = new.index(brims[1])
            theta[at] = max(theta[at], 0.0) ** (2.0 if sign > 0 else 0.5)
    if any(changed):
        theta[new.index("h1")] = theta[new.index("h2")] = 0.0


def extended_hypotheses(old: Hypothesis, effect: Effect) -> list[Hypothesis]:
    """One effect more; what acts on the dynamics of the parent moves inside, if it makes a state nonlinear.

    A load or a drift does, a wave may.
    """
    new = old.plus(effect)
    if not new.plant.nonlinear:
        return [new]
    inner = tuple(INNER_FORMS.get(one, one) for one in old.effects)
    found = [(*inner, effect)]
    if {PERIODIC, PERIODIC_LOAD} & set(inner):
        found += [(*(INNER_PERIODIC if one in (PERIODIC, PERIODIC_LOAD) else one for one in inner), effect)]
    return [Hypothesis(effects, old.n_given, old.given) for effects in found]


def _in_outer_form(hypothesis: Hypothesis) -> Hypothesis:
    """The same with what acts on the dynamics as these hold it."""
    if hypothesis.plant.nonlinear:
        return hypothesis
    outer: dict[Effect, Effect] = {INNER_PERIODIC: PERIODIC, UPSTREAM_PERIODIC: PERIODIC, UPSTREAM_LOAD: LOAD}
    outer |= {inner: effect for effect, inner in INNER_FORMS.items()}
    return Hypothesis(tuple(outer.get(e, e) for e in hypothesis.effects), hypothesis.n_given, hypothesis.given)


def remove_effect(data: Data, fit: Fit, which: int) -> Fit | None:
    """A fit as it is but for one of its effects; None where that cannot be simulated."""
    old = fit.hypothesis
    other = _in_outer_form(Hypothesis((*old.effects[:which], *old.effects[which + 1 :]), old.n_given, old.given))
    starts = [transfer_theta(fit, other)]
    place, before, now = other.slices["plant"], old.plant, other.plant
    if (before.kind, before.upper_root, before.lower_root) != (now.kind, now.upper_root, now.lower_root):
        rates = [base[:2] for base in now.starts(*fit.rates)]
        starts = [starts[0].copy() for _ in rates]
        for start, pair in zip(starts, rates, strict=True):
            start[place][:2] = pair
    points = [
        point for start in starts if (point := minimize(data, other, start, iterations=REMOVAL_ITERATIONS)) is not None
    ]
    return finish(data, other, min(points, key=lambda point: point.cost)) if points else None
