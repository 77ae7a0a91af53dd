"""The same effects in other forms: at another place of the chain, as a special or the general case, or one fewer."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.data import Data
from labsid.gap.effects import curves, disturbance, drifting, dynamics, input, output
from labsid.gap.effects.base import Effect
from labsid.gap.fitting import Fit, finish, search
from labsid.gap.hypothesis import Hypothesis
from labsid.gap.plants import Plant
from labsid.gap.responses import real_rates

AT_STOP = 0.03  # of the samples, where a stop is tried
SLOW_AGAIN = 10.0  # rate of a pole that a fit has lost, in the record
QUICKER = 10.0  # rate of the pole that is left over, where the fit has spent one on an integrator
FEW = 6  # iterations after an effect was taken out

LAGS: tuple[Effect, ...] = (dynamics.ExtraLag(), dynamics.ExtraLag("ahead"))
MODES: tuple[Effect, ...] = (dynamics.Resonance(), dynamics.Resonance("ahead"), dynamics.Resonance("beside"))
SENSOR_DRIFTS: tuple[Effect, ...] = tuple(output.Drift(bends) for bends in ("1", "3", "6", "10", "16", "settle"))
PLACES: tuple[tuple[Effect, ...], ...] = (
    LAGS,
    MODES,
    (dynamics.CoulombFriction("speed"), dynamics.CoulombFriction("speed-lag")),
)
"""What may stand at several places of the chain, which are the same to linear dynamics."""
ORDERS: tuple[tuple[Effect, ...], ...] = (
    (input.RateLimit(), input.RateLimit("behind")),
    (input.Nonlinearity(), input.Nonlinearity("first")),
)
"""What may stand at several places of the actuator, which are the same where nothing else bends the command."""
SWITCHED: dict[Effect, tuple[Effect, ...]] = {
    input.Delay(): (input.Delay("switched"), input.Delay("no-zero switched")),
    input.Delay("no-zero"): (input.Delay("no-zero switched"),),
    input.RateLimit(): (input.RateLimit("switched"), input.RateLimit("timed")),
}
"""What remembers the command: where the record begins with a new one, and told to the first moment of each sample."""
RICHER: dict[Effect, Effect] = {
    input.Nonlinearity(): input.Nonlinearity("rich"),
    output.Nonlinearity(): output.Nonlinearity("rich"),
}
"""Cubic curves, and splines."""
LOAD, LEAK = disturbance.LoadStep(), disturbance.Leak("leak")
INNER_LOAD, LOAD_AHEAD = disturbance.InnerLoad("inside"), disturbance.InnerLoad("ahead")
"""A load on linear dynamics; the general case, whose search begins at what the former finds; on a nonlinear state."""


ROOTS: dict[str, tuple[Effect, ...]] = {
    which + side: tuple(dynamics.SqrtOutflow(other + side) for other in ("both", "upper", "lower") if other != which)
    for which in ("both", "upper", "lower")
    for side in ("", "-flipped")
}
"""By variant, the other outflows that may go with the root."""
BRIMS: dict[Effect, Effect] = {
    dynamics.Overflow(which + side): dynamics.Overflow("both" + side)
    for which in ("upper", "lower")
    for side in ("", "-flipped")
}
"""The brim of one tank, and those of both."""
TURNED: dict[Effect, Effect] = {
    dynamics.Overflow(one + side): dynamics.Overflow(other + side)
    for one, other in (("upper", "lower"), ("lower", "upper"))
    for side in ("", "-flipped")
}
"""The brim of the same tank where the other one stands before it, not behind it."""
STOP_LOW, STOP_HIGH, STOPS = output.Saturation("low"), output.Saturation("high"), output.Saturation("both")
GENERAL: dict[Effect, tuple[Effect, ...]] = SWITCHED | {
    special: (general,) for special, general in (RICHER | BRIMS | {STOP_LOW: STOPS, STOP_HIGH: STOPS}).items()
}
"""Special cases, and the general ones on the same dynamics."""
WAVE, LOAD_WAVE = disturbance.Periodic(), disturbance.Periodic("load")
INNER_WAVE, WAVE_AHEAD = disturbance.InnerPeriodic("inside"), disturbance.InnerPeriodic("ahead")
"""A wave behind the sensor's curve, ahead of it, and on dynamics with a nonlinear state."""
INNER: dict[Effect, Effect] = {LOAD: INNER_LOAD} | {
    drifting.PoleDrift(bends): drifting.InnerPoleDrift(bends) for bends in ("1", "4")
}
"""What changes linear dynamics, and the same in dynamics with a nonlinear state."""
DRIFTS: dict[Effect, Effect] = {
    one(bends): other(bends)
    for one, other in (
        (drifting.GainDrift, drifting.InnerPoleDrift),
        (drifting.InnerPoleDrift, drifting.GainDrift),
    )
    for bends in ("1", "4")
}
"""What may drift of dynamics with a nonlinear state."""


def rearranged(hypothesis: Hypothesis) -> list[Hypothesis]:
    """The same effects in another form: a lag or a mode at another place to a nonlinear state, or a special case."""
    found = []
    for i, effect in enumerate(hypothesis.effects[hypothesis.known :], hypothesis.known):
        forms: list[Effect] = [LOAD] if effect == LEAK else []
        forms += [grown] if effect == LOAD and (grown := growing(hypothesis.plant)) else []
        forms += [other for other in _waves(hypothesis) if effect.name == WAVE.name and other != effect]
        if hypothesis.plant.in_a_row and effect in (INNER_LOAD, LOAD_AHEAD):
            forms += [LOAD_AHEAD if effect == INNER_LOAD else INNER_LOAD]
        forms += [other for other in ROOTS.get(effect.variant, ()) if effect.name == "sqrt-outflow"]
        forms += GENERAL.get(effect, ())
        forms += [DRIFTS[effect]] if effect in DRIFTS and hypothesis.plant.nonlinear else []
        forms += [TURNED[effect]] if effect in TURNED and not _rooted(hypothesis.plant) else []
        groups = PLACES if hypothesis.plant.nonlinear else ()
        groups += ORDERS if sum(e.name != "input-delay" for e in hypothesis.inputs) > 1 else ()
        forms += [form for group in groups if effect in group for form in group if form != effect]
        for form in forms:
            effects = (*hypothesis.effects[:i], form, *hypothesis.effects[i + 1 :])
            found.append(Hypothesis(effects, hypothesis.known, hypothesis.given))
    return found


def _waves(hypothesis: Hypothesis) -> list[Effect]:
    """Where a wave may enter, as far as that makes a difference."""
    waves: list[Effect] = [WAVE]
    waves += [LOAD_WAVE] if any(not effect.last for effect in hypothesis.outputs) else []
    waves += [INNER_WAVE] if hypothesis.plant.nonlinear else []
    waves += [WAVE_AHEAD] if hypothesis.plant.in_a_row else []
    return waves


def growing(plant: Plant) -> Effect | None:
    """A load that grows with the state, as these dynamics hold it."""
    if plant.nonlinear:
        return INNER_LOAD
    return LEAK if plant.kind == "linear" else None


def carried(fit: Fit, other: Hypothesis) -> FloatArray:
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
    for plain, rich in RICHER.items():
        if rich in other.effects and plain in old.effects:
            theta[other.slices[rich.key]] = curves.richer(fit.theta[old.slices[plain.key]])
    if not other.delay_is_an_effect:
        theta[0] = fit.theta[0]
    if STOPS in other.effects and STOPS not in old.effects:
        stops = theta[other.slices[STOPS.key]]
        missing = 0 if STOP_HIGH in old.effects else 1
        stops[missing] = np.quantile(fit.output, (AT_STOP, 1.0 - AT_STOP)[missing])
    if old.plant.kind == other.plant.kind == "tanks":
        _rebrim(fit, other.plant, theta[other.slices["plant"]])
        _turn(old.plant, other.plant, theta[other.slices["plant"]])
        _reroot(old.plant, other.plant, theta[other.slices["plant"]])
    return theta


def loaded_starts(fit: Fit, other: Hypothesis) -> list[FloatArray]:
    """Where the search for a load that grows begins, given the fit of a load that does not."""
    starts = [carried(fit, other)]
    if other.effects[-1] != LEAK:
        return starts
    own, samples = other.slices["plant"], fit.output.size
    starts[0][own][other.plant.index("turn")] = 0.5
    slow, fast = real_rates(*fit.rates)
    if slow * samples < 1.0:  # an integrator to the load alone
        for slow, quick in ((SLOW_AGAIN / samples, fast), (fast, QUICKER * fast)):
            starts.append(starts[0].copy())
            starts[-1][own][:2] = np.log((slow + quick, slow * quick))
    return starts


def _rebrim(fit: Fit, new: Plant, theta: FloatArray) -> None:
    """Give the other tank a brim a little below its highest level; in place."""
    old, own = fit.hypothesis.plant, fit.plant_theta
    if new.brim != 3 or old.brim not in (1, 2):
        return
    level = (fit.output - fit.gains[1]) / (fit.gains[0] or 1.0)
    top = float(np.quantile(level, 1.0 - AT_STOP))
    if old.brim == 1:
        theta[new.index("brim2")] = top
        return
    theta[new.index("brim2")] = own[old.index("brim")]
    flow = np.sqrt(max(top, 0.0)) if old.lower_root else top
    theta[new.index("brim")] = flow**2 if old.upper_root else flow


def _turn(old: Plant, new: Plant, theta: FloatArray) -> None:
    """Let the tank with the brim keep its rate where it has changed places with the other one; in place."""
    if {old.brim, new.brim} == {1, 2}:
        theta[:2] = theta[1::-1].copy()
        theta[new.index("h1")], theta[new.index("h2")] = theta[new.index("h2")], theta[new.index("h1")]


def _rooted(plant: Plant) -> bool:
    return plant.upper_root or plant.lower_root


def _reroot(old: Plant, new: Plant, theta: FloatArray) -> None:
    """Let tanks run at the rates of before, their roots at other outflows; in place."""
    if not (_rooted(old) and _rooted(new)):
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


def homes(old: Hypothesis, effect: Effect) -> list[Hypothesis]:
    """One effect more; what acts on the dynamics of the parent moves inside, if it makes a state nonlinear.

    A load or a drift does, a wave may.
    """
    new = old.plus(effect)
    if not new.plant.nonlinear:
        return [new]
    inner = tuple(INNER.get(one, one) for one in old.effects)
    found = [(*inner, effect)]
    if {WAVE, LOAD_WAVE} & set(inner):
        found += [(*(INNER_WAVE if one in (WAVE, LOAD_WAVE) else one for one in inner), effect)]
    return [Hypothesis(effects, old.known, old.given) for effects in found]


def _at_home(hypothesis: Hypothesis) -> Hypothesis:
    """The same with what acts on the dynamics as these hold it."""
    if hypothesis.plant.nonlinear:
        return hypothesis
    outer: dict[Effect, Effect] = {INNER_WAVE: WAVE, WAVE_AHEAD: WAVE, LOAD_AHEAD: LOAD}
    outer |= {inner: effect for effect, inner in INNER.items()}
    return Hypothesis(tuple(outer.get(e, e) for e in hypothesis.effects), hypothesis.known, hypothesis.given)


def without(data: Data, fit: Fit, which: int) -> Fit | None:
    """A fit as it is but for one of its effects; None where that cannot be simulated."""
    old = fit.hypothesis
    other = _at_home(Hypothesis((*old.effects[:which], *old.effects[which + 1 :]), old.known, old.given))
    starts = [carried(fit, other)]
    place, before, now = other.slices["plant"], old.plant, other.plant
    if (before.kind, before.upper_root, before.lower_root) != (now.kind, now.upper_root, now.lower_root):
        rates = [base[:2] for base in now.starts(*fit.rates)]
        starts = [starts[0].copy() for _ in rates]
        for start, pair in zip(starts, rates, strict=True):
            start[place][:2] = pair
    points = [point for start in starts if (point := search(data, other, start, iterations=FEW)) is not None]
    return finish(data, other, min(points, key=lambda point: point.cost)) if points else None
