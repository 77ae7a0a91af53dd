"""True parameters of a rig and its effects, in the record's units and seconds, as a diagnosis states them."""

from typing import Any

import numpy as np

from labsid.rig.switchable._motion import MASS, MOTOR_SPEED, TWO_TANKS, Motion
from labsid.rig.switchable.plants import Scales
from labsid.rig.switchable.setup import Setup


def true_parameters(name: str, setup: Setup, scales: Scales, samples: int) -> dict[str, Any]:
    """True parameters of one effect of a rig.

    Parameters
    ----------
    name : str
        An effect of the table.
    setup : Setup
    scales : Scales
    samples : int
        Length of the record.

    Returns
    -------
    dict
        Levels, limits, widths and rates in units of u or y, times in seconds, frequencies in Hz, `drift` relative.
        `drag` is in units of u per square of the speed: of y where y is a speed, otherwise of y per second. `share` of
        a slow mode is its gain relative to the static gain of the rest.

    Raises
    ------
    ValueError
        If there is no such effect.
    """
    a, m, load, sensor = setup.actuator, setup.motion, setup.load, setup.sensor
    u0, us, y0, ys, Ts = scales.u0, scales.us, scales.y0, scales.ys, scales.Ts
    match name:
        case "input-delay":
            return {"delay": a.delay * Ts}
        case "input-saturation":
            return _limits(a.low, a.high, u0, us)
        case "input-dead-zone":
            return _limits(a.dead_low, a.dead_high, u0, us) | ({"jump": a.dead_jump} if a.dead_jump else {})
        case "input-backlash":
            return {"width": a.backlash * abs(us)}
        case "input-rate-limit":
            return {"rate": a.slew * abs(us) / Ts}
        case "input-nonlinearity":
            return {"c2": a.c2 / us, "c3": a.c3 / us**2}
        case "input-quantization":
            return {"step": a.step * abs(us)}
        case "input-off":
            end = a.off_stop * Ts if np.isfinite(a.off_stop) else None
            return {"onset": a.off_start * Ts, "end": end, "level": u0 + us * a.off_level}
        case "extra-lag":
            return {"tau": max(m.actuator_lag, m.sensor_lag) * Ts}
        case "resonance":
            return {"frequency": m.mode_frequency / (2 * np.pi * Ts), "damping": m.mode_damping}
        case "sqrt-outflow":
            return {"zero": y0 - ys / m.outflow_curvature}
        case "overflow":
            upper = m.kind == TWO_TANKS and np.isfinite(m.brim_upper)
            return {"level": y0 + ys * min(m.brim_upper, m.brim_lower), "upper": bool(upper)}
        case "coulomb-friction":
            return _friction(m, scales)
        case "cubic-stiffness":
            return {"cubic": m.cubic / ys**2}
        case "parameter-drift":
            pole = load.pole_change != 0.0
            return {"pole" if pole else "drift": load.pole_change if pole else a.gain_change}
        case "output-drift":
            return {"amplitude": sensor.drift * abs(ys), "course": sensor.drift_profile.kind}
        case "output-saturation":
            return _limits(sensor.low, sensor.high, y0, ys)
        case "output-nonlinearity":
            if np.isfinite(sensor.fold):
                return {"fold": y0 + ys * sensor.fold}
            return {"c2": sensor.c2 / ys, "c3": sensor.c3 / ys**2}
        case "output-quantization":
            return {"step": sensor.step * abs(ys)}
        case "output-outliers":
            return {"share": max(3, round(sensor.outlier_share * samples)) / samples}
        case "output-dropout":
            return {"share": sensor.dropout_share}
        case "load-step":
            return {"onset": load.onset * Ts, "size": load.size * us, "leak": load.leak}
        case "periodic-disturbance":
            at_load = load.amplitude != 0.0
            part = load if at_load else sensor
            return {"frequency": part.frequency / Ts, "at": "load" if at_load else "sensor"}
        case "coloured-noise":
            return {"amplitude": sensor.colour * abs(ys), "tau": sensor.colour_time * Ts}
        case "end-stop":
            return _limits(m.stop_low, m.stop_high, y0, ys)
        case "quadratic-drag":
            speed = abs(ys) if m.kind == MOTOR_SPEED else abs(ys) / Ts
            return {"drag": m.drag * abs(us) / speed**2}
        case "slow-mode":
            return {"tau": m.slow_time * Ts, "share": m.slow_share}
        case "output-backlash":
            return {"width": m.play * abs(ys)}
    raise ValueError(f"name must be an effect of the table; got {name!r}. See labsid.rig.switchable.effects.")


def true_linear_model(setup: Setup, scales: Scales, steps: int = 0) -> dict[str, Any]:
    """Discrete transfer function of the linearised rig without effects.

    Parameters
    ----------
    setup : Setup
    scales : Scales
    steps : int
        0 for exact discretisation; otherwise the number of Euler steps per sample.

    Returns
    -------
    dict
        ``{"num", "den", "dt", "u0", "y0"}``, coefficients in descending powers of z.
    """
    from scipy.signal import cont2discrete

    A, B, C = _state_space(setup)
    if steps:
        step = np.block([[np.eye(2) + A / steps, B / steps], [np.zeros((1, 2)), np.eye(1)]])
        whole = np.linalg.matrix_power(step, steps)
        Ad, Bd = whole[:2, :2], whole[:2, 2:]
    else:
        Ad, Bd, *_ = cont2discrete((A, B, C, np.zeros((1, 1))), 1.0, method="zoh")
    den = np.real(np.poly(Ad))
    num = np.real(np.poly(Ad - Bd @ C)) - den
    gain = scales.ys / scales.us
    return {
        "num": [0.0, *(gain * num[1:]).tolist()],
        "den": den.tolist(),
        "dt": scales.Ts,
        "u0": scales.u0,
        "y0": scales.y0,
    }


def _state_space(setup: Setup) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    m = setup.motion
    if m.kind == MASS:
        A = np.array([[0.0, 1.0], [-1 / m.T0**2, -2 * m.damping / m.T0]])
        return A, np.array([[0.0], [1 / m.T0**2]]), np.array([[1.0, 0.0]])
    if m.kind in (4, 5):
        A = np.array(
            [
                [-(m.coupling + m.loss) / m.T0, m.coupling / m.T0],
                [m.coupling / m.T1, -(m.coupling + 1 - m.loss) / m.T1],
            ]
        )
        C = np.array([[1.0, 0.0]]) if m.kind == 5 else np.array([[0.0, 1.0]])
        return A, np.array([[1 / m.T0], [0.0]]), C
    A = np.array([[-1 / m.T0, 0.0], [1 / m.T1, -1 / m.T1]])
    return A, np.array([[1 / m.T0], [0.0]]), np.array([[0.0, 1.0]])


def _friction(m: Motion, scales: Scales) -> dict[str, float]:
    """Dry friction; in its other forms also the value against a falling y, the peak and the speed of the change."""
    unit = abs(scales.us)
    truth = {"friction": m.dry_friction * unit}
    if m.friction_back:
        truth["friction_back"] = m.dry_friction * (1.0 + m.friction_back) * unit
        if scales.ys < 0:
            truth = {"friction": truth["friction_back"], "friction_back": truth["friction"]}
    if m.friction_peak:
        truth["break_away"] = m.dry_friction * (1.0 + m.friction_peak) * unit
    if m.friction_speed:
        truth["speed"] = m.friction_speed * abs(scales.ys) / (scales.Ts if m.kind == MASS else 1.0)
    return truth


def _limits(low: float, high: float, zero: float, scale: float) -> dict[str, float]:
    ends = {"low": zero + scale * low, "high": zero + scale * high}
    if scale < 0:
        ends = {"low": ends["high"], "high": ends["low"]}
    return {name: value for name, value in ends.items() if np.isfinite(value)}
