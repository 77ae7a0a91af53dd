"""Simulated responses of each kind of dynamics, as columns. Time is in samples."""

import numpy as np
from numpy.polynomial.chebyshev import chebval

from labsid._arrays import FloatArray, beside
from labsid.gap.dynamics import _kernels, _rates, _states
from labsid.gap.dynamics.plant_form import Named, PlantForm
from labsid.gap.dynamics.reaction_forces import Reaction

NO_BRIM = np.inf  # scaled: level of a brim that is not there; definition
REST_TIME_CONSTANTS = 6.0  # after which a free response has ended; set by hand
NODES = np.polynomial.legendre.leggauss(8)  # and weights of Gauss-Legendre quadrature; numerics
MAX_ROOT_RATE = 2.4  # per sample, of a tank with square-root outflow: a faster one follows its inflow; set by hand
WEIR_SUBSTEPS = 2  # times as many besides, over which the flow over a weir varies; numerics
MOTOR_SUBSTEPS = 3  # of a motor with dry friction; numerics
LAW_SUBSTEPS = 2  # times as many, in each of which friction that varies with the speed is linear or constant; numerics
MAX_OBSERVED_RATE = 2.0  # per sample: the record has no information on a faster pole; set by hand
ABSENT_POLE_RATE = 30.0  # per sample, of a pole without influence; numerics


def response(plant: PlantForm, own: Named, w: FloatArray, span: int, reference: float, late: float = 0.0) -> FloatArray:
    """Columns of the dynamics without additional lag or mode; NaN where the simulation diverges.

    Parameters
    ----------
    plant : PlantForm
    own : dict
        The plant's parameters by name.
    w : ndarray, shape (N,)
        The actuator's signal.
    span : int
        Length of the fitted record, the time unit of slow changes.
    reference : float
        Operating point of w for linear dynamics.
    late : float
        Fraction of each sample at which w changes, 0 to 1; used with nonlinear states.

    Returns
    -------
    ndarray, shape (N, m)
        The second column of "mechanics" and "speed" is the speed against which friction acts.
    """
    return _KINDS[plant.kind](plant, own, w, span, reference, late)


def normalized_time(samples: int, span: int) -> FloatArray:
    """-1 to 1 over the `span` samples of the fitted record, and 1 after it."""
    return np.minimum(2.0 * np.arange(samples) / max(span - 1, 1) - 1.0, 1.0)


def step_signal(onset: float, samples: int, span: int) -> FloatArray:
    """Unit step at the share `onset` of the span; its first sample holds the mean over that sample."""
    return np.clip(np.arange(1, samples + 1) - onset * span, 0.0, 1.0)


def chebyshev_course(shape: FloatArray, samples: int, span: int) -> FloatArray:
    """A slow change along the record: sum of Chebyshev polynomials of degree 1, 2, ... with coefficients `shape`."""
    return chebval(normalized_time(samples, span), np.concatenate([[0.0], shape]))


def denominator(c: float, k: float) -> tuple[float, float]:
    """Coefficients a1, a2 of s^2 + c s + k sampled at one sample."""
    s = 0.25 * c * c - k
    if s > 0:
        root = np.sqrt(s)
        up, down = np.exp(root - 0.5 * c), np.exp(-root - 0.5 * c)
        return float(-(up + down)), float(np.exp(-c))
    return float(-2.0 * np.exp(-0.5 * c) * np.cos(np.sqrt(-s))), float(np.exp(-c))


def real_rates(c: float, k: float) -> tuple[float, float]:
    """The two real decay rates, the slow one first; a complex pair gives two near its natural frequency."""
    s = np.sqrt(max(0.25 * c * c - k, 0.0))
    fast = 0.5 * c + s
    if s == 0.0:
        return float(np.sqrt(k)) * 0.8, float(np.sqrt(k)) * 1.25
    return float(k / fast), float(min(fast, 8.0))


def decay_rates(c: float, k: float) -> tuple[float, float]:
    """The rates at which the free response of s^2 + c s + k decays, the slow one first."""
    return (0.5 * c, 0.5 * c) if c * c < 4.0 * k else real_rates(c, k)


def damping_ratio(c: float, k: float) -> float:
    """Damping ratio of s^2 + c s + k."""
    return float(0.5 * c / np.sqrt(k))


def force_unit(c: float, k: float) -> float:
    """Force per unit of position by which the motion of a mass is scaled; also without a spring it is not zero."""
    return float(max(k, 0.02 * c * c))


def single_pole(rate: float) -> tuple[float, float]:
    """c and k of a single pole of `rate` per sample: the other pole is too fast to matter."""
    return rate + ABSENT_POLE_RATE, rate * ABSENT_POLE_RATE


def section(c: float, k: float, w: FloatArray) -> FloatArray:
    """Columns of a second-order section: two for its numerator, two for its initial state."""
    return _kernels.section(w, *denominator(c, k))


def lag_mean(w: FloatArray, tau: float) -> FloatArray:
    """Mean over each sample of a first-order lag driven by `w` from rest; `tau` in samples."""
    pole = float(np.exp(-1.0 / tau))
    behind = w[0] + _kernels.first_order(w - w[0], pole) - w
    return np.asarray(w + behind * tau * (1.0 - pole))


def lag_output(y: FloatArray, slope: FloatArray, tau: float) -> FloatArray:
    """First-order lag driven by `y` from zero, with cubic Hermite interpolation of y; `tau` in samples."""
    pole = float(np.exp(-1.0 / tau))
    if tau > 1.0:
        times, weights = 0.5 * (NODES[0] + 1.0), 0.5 * NODES[1] / tau
        m1, m2, m3 = (float(weights @ (np.exp((times - 1.0) / tau) * times**n)) for n in (1, 2, 3))
    else:
        m1 = 1.0 - tau * (1.0 - pole)
        m2 = 1.0 - 2.0 * tau * m1
        m3 = 1.0 - 3.0 * tau * m2
    m1, m2, m3 = (moment / (1.0 - pole) for moment in (m1, m2, m3))
    rise, ahead, behind = 3.0 * m2 - 2.0 * m3, m1 - 2.0 * m2 + m3, m3 - m2
    following, onward = np.append(y[1:], y[-1]), np.append(slope[1:], slope[-1])
    return _kernels.first_order(y + rise * (following - y) + ahead * slope + behind * onward, pole)


def mode_mean(w: FloatArray, frequency: float, damping_ratio: float) -> FloatArray:
    """Mean over each sample of a lightly damped mode of unit gain driven by `w` from rest."""
    c, k = 2.0 * damping_ratio * frequency, frequency**2
    motion = _states.simulate_linear(w - w[0], c, k)
    change = np.diff(motion, axis=0, append=motion[-1:])  # the mean follows from z'' = -c z' - k z + w, integrated
    return np.asarray(w - change @ [c, 1.0])


def _linear(plant: PlantForm, own: Named, w: FloatArray, span: int, reference: float, late: float) -> FloatArray:
    c, k = float(np.exp(own["log_c"])), float(np.exp(own["log_k"]))
    if plant.zero:
        return _kernels.linear_columns(w, reference, *denominator(c, k), not comes_to_rest(c, k, span))
    ramp = _offset_ramp(c, k, w.size, span)
    exact = _states.simulate_linear(w - reference, c, k)[:, :1] * k
    return beside([exact, section(c, k, np.zeros(w.size))[:, 2:], ramp])


def _offset_ramp(c: float, k: float, samples: int, span: int) -> FloatArray:
    """Response to an input offset if the plant does not settle within the record; otherwise zero.

    Such an offset is not a constant of the output: after an integrator it is a ramp.
    """
    if comes_to_rest(c, k, span):
        return np.zeros((samples, 1))
    return section(c, k, np.ones(samples))[:, :1]


def comes_to_rest(c: float, k: float, span: int) -> bool:
    """Whether the free response of s^2 + c s + k ends within so many samples, and so the gain at rest shows."""
    return real_rates(c, k)[0] * span > REST_TIME_CONSTANTS


def _tanks(plant: PlantForm, own: Named, w: FloatArray, span: int, reference: float, late: float) -> FloatArray:
    a, b = np.exp(own["log_a"]), np.exp(own["log_b"])
    flow = (-w if plant.flipped else w) - own.get("zero", 0.0)
    upper_root, lower_root = "upper" in plant.roots, "lower" in plant.roots
    level = max(flow[0], 0.0) if upper_root else flow[0]
    h1 = level**2 if upper_root else level
    h2 = level**2 if lower_root else level
    brim = own.get("brim", NO_BRIM)
    level_slope = max(2.0 * float(np.mean(flow)), 0.5)  # derivative of a level by the flow, at the mean flow
    a = min(a, MAX_ROOT_RATE * level_slope) if upper_root else a
    b = min(b, MAX_ROOT_RATE * level_slope) if lower_root else b
    upper, lower = a / level_slope if upper_root else a, b / level_slope if lower_root else b
    pace = _rate_factor(plant, own, w.size, span)
    if pace is not None:
        pace = np.minimum(pace, MAX_ROOT_RATE * level_slope / b) if lower_root else pace
        lower *= float(pace.max())
    root_rates = [rate for rate, root in ((upper, upper_root), (lower, lower_root)) if root]
    fastest = max(root_rates, default=0.0)  # linear tanks are integrated exactly at any rate
    substeps = int(max(np.ceil(fastest / 0.3), np.ceil(min(upper, lower) / 0.2), 2)) * (1 + WEIR_SUBSTEPS * plant.weir)
    flow, loads = _apply_load(plant, own, flow, span)
    return _states.simulate_tanks(
        flow,
        a,
        b,
        upper_root,
        lower_root,
        brim if "upper" in plant.brims else NO_BRIM,
        own.get("brim2", brim) if "lower" in plant.brims else NO_BRIM,
        own.get("share", 0.0),
        h1 + own["h1"],
        h2 + own["h2"],
        substeps,
        late,
        *loads,
        pace,
        float(np.exp(own["log_weir"])) if plant.weir else 0.0,
    )[:, None]


def _apply_load(
    plant: PlantForm, own: Named, w: FloatArray, span: int
) -> tuple[FloatArray, tuple[FloatArray | None, FloatArray | None]]:
    """The drive less the loads ahead of the dynamics; and the load and the leak within them, one value per sample."""
    if not plant.load and not plant.sinusoid:
        return w, (None, None)
    load, leak = np.zeros(w.size), np.zeros(w.size)
    if plant.load:
        active = step_signal(own["onset"], w.size, span)
        leak = own.get("leak", 0.0) * active
        if plant.load == "ahead":
            w = w - own["load"] * active
        else:
            load = own["load"] * active
    if plant.sinusoid:
        phase = 2.0 * np.pi * own["cycles"] / span * (np.arange(w.size) + 0.5)
        cosine, sine = own["shake_cos"] * np.cos(phase), own["shake_sin"] * np.sin(phase)
        if plant.sinusoid == "ahead":
            w = w - cosine - sine
        else:
            load = load + (cosine + sine)
    return w, (load, leak)


def _rate_factor(plant: PlantForm, own: Named, samples: int, span: int) -> FloatArray | None:
    """Factor of the drifting rate of the second state, or of the spring; None without drift."""
    return np.exp(_course(plant, own, samples, span)) if plant.drift_degree else None


def _course(plant: PlantForm, own: Named, samples: int, span: int) -> FloatArray:
    """Logarithm of the factor of a rate that drifts or steps."""
    if plant.steps:
        return np.asarray(own["drift"] * step_signal(own["onset"], samples, span))
    shape = np.array([own["drift"], *(own[f"bend{n}"] for n in range(1, plant.drift_degree))])
    return np.clip(chebyshev_course(shape, samples, span), -6.0, 6.0)


def _mechanics(plant: PlantForm, own: Named, w: FloatArray, span: int, reference: float, late: float) -> FloatArray:
    c, k = np.exp(own["log_c"]), np.exp(own["log_k"])
    unit = force_unit(c, k)
    drive = w - own.get("centre", reference)
    turn = float(np.exp(own.get("log_turn", 0.0))) * unit
    stiffest = own.get("torque", 0.0) * turn
    bristles = _bristles(own) * unit
    fastest = max(c, np.sqrt(max(k + stiffest + bristles, 0.0)))
    substeps = int(min(max(np.ceil(fastest / (0.15 if plant.abrupt else 0.3)), 2), 12))
    substeps *= LAW_SUBSTEPS if plant.friction in ("smooth", "peak") else 1
    cubic = own.get("cubic", 0.0) * unit**3
    pace = _rate_factor(plant, own, w.size, span)
    # Without a centre the initial position is absolute: the spring may be too weak for an equilibrium.
    rests = "centre" in own and not plant.unsprung
    rest = _equilibrium(drive[0], k if pace is None else k * pace[0], cubic) if rests else 0.0
    z0, v0 = rest + own["z0"] / unit, own["v0"] / np.sqrt(unit)
    drive, loads = _apply_load(plant, own, drive, span)
    friction, law = own.get("friction", 0.0), _friction_law(own, float(1.0 / np.sqrt(unit)))
    drag = own.get("drag", 0.0) * unit
    stops = own.get("stop_low", -np.inf) / unit, own.get("stop_high", np.inf) / unit, own.get("rebound", 0.0)
    z0 = min(max(z0, stops[0]), stops[1])
    limit = own.get("limit", np.inf), sprung_share(plant, own), damped_share(plant, own)
    given = own.get("driven_share", 0.0) if plant.friction == "drive" else _states.ALL_FORCES
    weight = own.get("torque", 0.0), turn, own.get("angle", 0.0)
    joint = (*limit, *weight, own.get("load_share", 0.0), bristles, given)
    return (
        _states.simulate_mass(
            drive, c, k, friction, cubic, z0, v0, substeps, late, *loads, pace, law, drag, stops, joint
        )
        * unit
    )


def sprung_share(plant: PlantForm, own: Named) -> float:
    """Share of the stiffness that the loop of the drive gives, so that it ends at the limit."""
    return own["sprung_share"] if plant.limit == "loaded" else float(plant.limit != "speed")


def damped_share(plant: PlantForm, own: Named) -> float:
    """Share of the damping that the loop of the drive gives, so that it ends at the limit."""
    return own["damped_share"] if plant.limit == "damped" else float(plant.limit == "speed")


def _bristles(own: Named) -> float:
    """Stiffness of the bristles of the friction; zero if they are rigid."""
    return own["friction"] * float(np.exp(-own["log_give"])) if "log_give" in own else 0.0


def _friction_law(own: Named, speed: float) -> tuple[float, float, float]:
    """Law of friction of `_states`, with speeds in the unit `speed`."""
    smooth = float(np.exp(own["log_smooth"])) if "log_smooth" in own else 0.0
    peak = own.get("peak", 0.0) * own.get("friction", 0.0)
    return smooth * speed, peak, float(np.exp(own.get("log_decay", 0.0))) * speed


def _equilibrium(force: float, k: float, cubic: float) -> float:
    """Equilibrium of k z + cubic z^3 under a constant force: the real root nearest to the linear one."""
    roots = np.roots([cubic, 0.0, k, -force]) if cubic != 0.0 else np.array([force / k])
    real = roots[np.abs(roots.imag) < 1e-9 * (1.0 + np.abs(roots.real))].real
    linear = force / k
    return float(real[np.argmin(np.abs(real - linear))]) if real.size else linear


def _speed(plant: PlantForm, own: Named, w: FloatArray, span: int, reference: float, late: float) -> FloatArray:
    a, b = np.exp(own["log_a"]), np.exp(own["log_b"])
    drive = w - own["centre"]
    friction, drag = own.get("friction", 0.0), own.get("drag", 0.0)
    v = np.sign(drive[0]) * max(abs(drive[0]) - friction, 0.0)
    v /= 0.5 + np.sqrt(0.25 + drag * abs(v))  # at constant speed, v + drag v |v| is the drive
    v += own["v0"]
    i = (drive[0] if plant.lag_first else v) + own["i0"]
    drive, loads = _apply_load(plant, own, drive, span)
    pace = _rate_factor(plant, own, w.size, span)
    law = _friction_law(own, 1.0)
    substeps = MOTOR_SUBSTEPS * (LAW_SUBSTEPS if plant.friction in ("smooth", "peak") else 1)
    bristles = own.get("load_share", 0.0), _bristles(own)
    return _states.simulate_motor(
        drive, a, b, friction, plant.lag_first, v, i, substeps, late, *loads, pace, law, drag, bristles
    )


def _varying(plant: PlantForm, own: Named, w: FloatArray, span: int, reference: float, late: float) -> FloatArray:
    course = _course(plant, own, w.size, span)
    change = np.expm1(course)  # of one lag of two, or of a spring
    c, unit = np.exp(own["log_c"]), np.exp(own["log_k"])
    out = _rates.simulate_varying(w - reference, course, change, c, unit, own["share_c"], own["turn"])
    return beside([out[:, :6] * unit, out[:, 6:]])


def _leak(plant: PlantForm, own: Named, w: FloatArray, span: int, reference: float, late: float) -> FloatArray:
    """A leak that starts at an instant: c and k step, and the gain at the input stays."""
    change = np.expm1(own["drift"])
    c, unit = np.exp(own["log_c"]), np.exp(own["log_k"])
    c1, k1 = _rates.changed_rates(c, unit, own["share_c"], 0.0)
    c2, k2 = _rates.changed_rates(c, unit, own["share_c"], change)
    turned = own["turn"] * own["share_c"] * c  # the part of c inside the derivative
    # If the plant settles, the load and constant columns already include the response to a constant force.
    constant = np.full(w.size, 0.0 if comes_to_rest(c1, k1, span) else 1.0)
    forces = np.column_stack([w - reference, constant])
    out = _rates.simulate_stepped(forces, (c1, c2), (k1, k2), own["onset"] * span, turned * change, turned / unit)
    return beside([out[:, :3] * unit, out[:, 4:5] * unit, out[:, [6, 8]]])


def _given(plant: PlantForm, own: Named, w: FloatArray, span: int, reference: float, late: float) -> FloatArray:
    given, numbers = plant.simulation, plant.numbers(own.values())
    if plant.reactions:
        at_rest, spring = "speed" in plant.reactions, own.get("spring", 0.0)
        reaction = Reaction(own.get("friction", 0.0), at_rest, spring, given.standstill)
        output = given.react(w, numbers, reaction)[:, None]
    else:
        output = given.run(w, numbers)[:, None]
    if not given.takes_input or given.port is not None:
        return output
    return beside([output, free_responses(w.size, *given.rates)])


def free_responses(samples: int, c: float, k: float) -> FloatArray:
    """Columns of the response of linear dynamics to their initial state, shape (samples, 2)."""
    return section(c, k, np.zeros(samples))[:, 2:]


_KINDS = {
    "given": _given,
    "linear": _linear,
    "tanks": _tanks,
    "mechanics": _mechanics,
    "speed": _speed,
    "varying": _varying,
    "leak": _leak,
}
