"""Alternative forms of effects: another position in the chain, a more general case, or one effect fewer."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.data import Data
from labsid.gap.effects import curves, disturbance, drifts, dynamics, folded, input, motion, output
from labsid.gap.effects.base import Effect
from labsid.gap.fitting import Fit, finish, minimize
from labsid.gap.hypothesis import Hypothesis
from labsid.gap.plants import Plant
from labsid.gap.responses import real_rates

LIMIT_SHARE = 0.03  # of the samples beyond the start value of an added limit
RESTART_POLE = 10.0  # per record: start value of a pole that was fitted as an integrator
FAST_POLE_RATIO = 10.0  # start value of the second pole over the first, if one was fitted as an integrator
REMOVAL_ITERATIONS = 6  # after an effect was removed

LAGS: tuple[Effect, ...] = (dynamics.ExtraLag(), dynamics.ExtraLag("ahead"))
MODES: tuple[Effect, ...] = (dynamics.Resonance(), dynamics.Resonance("ahead"), dynamics.Resonance("beside"))
SENSOR_DRIFTS: tuple[Effect, ...] = tuple(output.Drift(bends) for bends in ("1", "3", "6", "10", "16", "settle"))
POSITIONS: tuple[tuple[Effect, ...], ...] = (
    LAGS,
    MODES,
    (dynamics.CoulombFriction("speed"), dynamics.CoulombFriction("speed-lag")),
    (motion.QuadraticDrag("speed"), motion.QuadraticDrag("speed-lag")),
)
"""Effects with several positions in the chain, which are equivalent for linear dynamics."""
ACTUATOR_ORDERS: tuple[tuple[Effect, ...], ...] = (
    (input.RateLimit(), input.RateLimit("behind")),
    (input.Nonlinearity(), input.Nonlinearity("first")),
)
"""Effects with several positions in the actuator, which are equivalent without other input effects."""
HISTORY_FORMS: dict[Effect, tuple[Effect, ...]] = {
    input.Delay(): (input.Delay("switched"), input.Delay("no-zero switched")),
    input.Delay("no-zero"): (input.Delay("no-zero switched"),),
    input.RateLimit(): (input.RateLimit("switched"), input.RateLimit("timed")),
}
"""Effects with memory of the command: with an input step at sample 0, or exact to the first moment of each sample."""
ASYMMETRIC_FORMS: dict[Effect, tuple[Effect, ...]] = {
    input.DeadZone(): (input.DeadZone("jump"), input.DeadZone("gain")),
}
"""Effects that act differently in either direction."""
SPLINE_FORMS: dict[Effect, Effect] = {
    input.Nonlinearity(): input.Nonlinearity("rich"),
    output.Nonlinearity(): output.Nonlinearity("rich"),
}
"""Splines that generalize cubic curves."""
LOAD, LEAK = disturbance.LoadStep(), disturbance.Leak("leak")
INNER_LOAD, UPSTREAM_LOAD = disturbance.InnerLoad("inside"), disturbance.InnerLoad("ahead")
"""Loads on linear dynamics (`LEAK` generalizes `LOAD`), and on nonlinear states."""
OTHER_OUTFLOWS: dict[str, tuple[Effect, ...]] = {
    which + side: tuple(dynamics.SqrtOutflow(other + side) for other in ("both", "upper", "lower") if other != which)
    for which in ("both", "upper", "lower")
    for side in ("", "-flipped")
}
"""By variant, the other choices of outflows with a square root."""
BOTH_BRIMS: dict[Effect, Effect] = {
    dynamics.Overflow(which + side): dynamics.Overflow("both" + side)
    for which in ("upper", "lower")
    for side in ("", "-flipped")
}
"""Overflow of both tanks, by the overflow of one."""
OTHER_TANK: dict[Effect, Effect] = {
    dynamics.Overflow(one + side): dynamics.Overflow(other + side)
    for one, other in (("upper", "lower"), ("lower", "upper"))
    for side in ("", "-flipped")
}
"""Overflow with the order of the tanks reversed."""
LOW_LIMIT, HIGH_LIMIT, BOTH_LIMITS = output.Saturation("low"), output.Saturation("high"), output.Saturation("both")
BOTH_STOPS: dict[Effect, Effect] = {
    motion.EndStop(side + spring): motion.EndStop("both" + spring)
    for side in ("low", "high")
    for spring in ("", "-unsprung")
}
"""Stops at both ends, by a stop at one."""
FRICTION_FORMS: dict[Effect, tuple[Effect, ...]] = {
    dynamics.CoulombFriction(place): tuple(dynamics.CoulombFriction(f"{place}-{law}") for law in ("smooth", "peak"))
    for place in dynamics.FRICTION_PLACES
}
"""Friction that is smooth about rest, or has a break-away peak."""
GENERAL_FORMS: dict[Effect, tuple[Effect, ...]] = (
    HISTORY_FORMS
    | ASYMMETRIC_FORMS
    | FRICTION_FORMS
    | {
        special: (general,)
        for special, general in (
            SPLINE_FORMS | BOTH_BRIMS | {LOW_LIMIT: BOTH_LIMITS, HIGH_LIMIT: BOTH_LIMITS} | BOTH_STOPS
        ).items()
    }
)
"""More general forms with the same dynamics."""
ABSOLUTE = folded.Absolute("absolute")
PERIODIC, PERIODIC_LOAD = disturbance.Periodic(), disturbance.Periodic("load")
INNER_PERIODIC, UPSTREAM_PERIODIC = disturbance.InnerPeriodic("inside"), disturbance.InnerPeriodic("ahead")
"""Periodic disturbances after the sensor's curve, before it, and on a nonlinear state."""
INNER_FORMS: dict[Effect, Effect] = {LOAD: INNER_LOAD} | {
    drifts.PoleDrift(bends): drifts.InnerPoleDrift(bends) for bends in ("1", "4")
}
"""By effect on linear dynamics, the same effect within dynamics that have a nonlinear state."""
OTHER_DRIFTS: dict[Effect, Effect] = {
    one(bends): other(bends)
    for one, other in (
        (drifts.GainDrift, drifts.InnerPoleDrift),
        (drifts.InnerPoleDrift, drifts.GainDrift),
    )
    for bends in ("1", "4")
}
"""By drift of nonlinear dynamics, the alternative drift."""


def alternative_forms(hypothesis: Hypothesis) -> list[Hypothesis]:
    """Hypotheses with one of the found effects in another form."""
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
    """Periodic disturbances at all positions that differ for this hypothesis."""
    forms: list[Effect] = [PERIODIC]
    forms += [PERIODIC_LOAD] if any(not effect.is_limit for effect in hypothesis.outputs) else []
    forms += [INNER_PERIODIC] if hypothesis.plant.nonlinear else []
    forms += [UPSTREAM_PERIODIC] if hypothesis.plant.in_series else []
    return forms


def leak_form(plant: Plant) -> Effect | None:
    """The form of a leak for these dynamics; None if there is none."""
    if plant.nonlinear:
        return INNER_LOAD
    return LEAK if plant.kind == "linear" else None


def transfer_theta(fit: Fit, other: Hypothesis) -> FloatArray:
    """Transfer theta of a fit to another hypothesis: by effect, or by parameter name for effects without one."""
    old = fit.hypothesis
    theta = np.array([parameter.start for parameter in other.parameters])
    spare: dict[str, float] = {}
    for key, place in old.slices.items():
        if key == "plant" or key not in other.slices:
            spare |= {p.name: x for p, x in zip(old.parameters[place], fit.theta[place], strict=True)}
    for i, parameter in enumerate(other.parameters):
        theta[i] = spare.get(parameter.name, parameter.start)
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
    if len(old.plant.stops) == 1 and len(other.plant.stops) == 2:
        (missing_side,) = set(other.plant.stops) - set(old.plant.stops)
        position = (fit.output - fit.gains[1]) / (fit.gains[0] or 1.0)
        at = other.slices["plant"].start + other.plant.index(f"stop_{missing_side}")
        theta[at] = np.quantile(position, 1.0 - LIMIT_SHARE if missing_side == "high" else LIMIT_SHARE)
    if old.plant.kind == other.plant.kind == "tanks":
        _set_second_brim(fit, other.plant, theta[other.slices["plant"]])
        _swap_tanks(old.plant, other.plant, theta[other.slices["plant"]])
        _move_roots(old.plant, other.plant, theta[other.slices["plant"]])
    return theta


def leak_starts(fit: Fit, other: Hypothesis) -> list[FloatArray]:
    """Start values for a leak from the fit of a load step."""
    starts = [transfer_theta(fit, other)]
    if other.effects[-1] != LEAK:
        return starts
    own, samples = other.slices["plant"], fit.output.size
    starts[0][own][other.plant.index("turn")] = 0.5
    slow, fast = real_rates(*fit.rates)
    if slow * samples < 1.0:  # the fit has used a pole to integrate the load
        for slow, quick in ((RESTART_POLE / samples, fast), (fast, FAST_POLE_RATIO * fast)):
            starts.append(starts[0].copy())
            starts[-1][own][:2] = np.log((slow + quick, slow * quick))
    return starts


def _set_second_brim(fit: Fit, new: Plant, theta: FloatArray) -> None:
    """Set the brim of the other tank slightly below its highest level, in place."""
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
    """Swap rates and levels if the order of the tanks is reversed, in place."""
    if {old.brim, new.brim} == {1, 2}:
        theta[:2] = theta[1::-1].copy()
        theta[new.index("h1")], theta[new.index("h2")] = theta[new.index("h2")], theta[new.index("h1")]


def _has_root(plant: Plant) -> bool:
    return plant.upper_root or plant.lower_root


def _move_roots(old: Plant, new: Plant, theta: FloatArray) -> None:
    """Preserve the linearized rates and brims of tanks whose square-root outflows change, in place."""
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
    """Hypotheses with one more effect.

    If the effect makes a state nonlinear, loads and drifts of the parent move inside the dynamics. A periodic
    disturbance may: there is one hypothesis for each case.
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
    """Replace inner effects by their forms for linear dynamics, if no state is nonlinear."""
    if hypothesis.plant.nonlinear:
        return hypothesis
    outer: dict[Effect, Effect] = {INNER_PERIODIC: PERIODIC, UPSTREAM_PERIODIC: PERIODIC, UPSTREAM_LOAD: LOAD}
    outer |= {inner: effect for effect, inner in INNER_FORMS.items()}
    return Hypothesis(tuple(outer.get(e, e) for e in hypothesis.effects), hypothesis.n_given, hypothesis.given)


def remove_named_effect(data: Data, fit: Fit, name: str) -> Fit | None:
    """Refit without the effect of this name that was found; None if the result cannot be simulated."""
    hypothesis = fit.hypothesis
    return remove_effect(data, fit, [effect.name for effect in hypothesis.found].index(name) + hypothesis.n_given)


def remove_effect(data: Data, fit: Fit, which: int) -> Fit | None:
    """Refit without the effect of index `which`; None if the result cannot be simulated."""
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
