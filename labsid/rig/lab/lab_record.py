"""The lab's records: the stand-in, or an individual record for each student."""

from dataclasses import replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.rig.lab.instruments import AVERAGED, converter, noise_reduced, sensor_noise
from labsid.rig.lab.integration import simulate_rig
from labsid.rig.lab.log import LabLog
from labsid.rig.lab.plan import STAND_IN, LabPlan, staircase, student_plan
from labsid.rig.lab.tanks import TankParameters, steady_levels, tank_rig, zero_level

TS = 0.75
"""Sampling time of the lab's rig (s)."""

SENSOR_NOISE = 0.013
"""Standard deviation of the level sensor's noise (V)."""

_SAMPLES = 903
_SAMPLES_TO_FILL = 300

# The verification run uses other levels about the same rest level, and other hold times. Differences in volts.
_VERIFICATION_STEPS = (0.0, -0.2, 0.1, -0.3, 0.15, -0.1)
_VERIFICATION_STARTS = (0, 61, 181, 341, 421, 621)
_VERIFICATION_SAMPLES = 741

_LAB_NOISE, _VERIFICATION_NOISE, _EMPTY_START_NOISE = 1, 2, 3


def make_lab_record(student: str | None = None, secret: bytes | None = None) -> LabLog:
    """Make the record that the lab identifies; the rig starts settled.

    Parameters
    ----------
    student : str, optional
        Student ID for an individual rig, levels and hold times; by default the stand-in.
    secret : bytes, optional
        The course's secret; required with `student`.

    Returns
    -------
    LabLog
        903 samples at 0.75 s. The stand-in has the lab's levels 2.0, 1.6, 2.2, 2.0, 1.6 and 2.2 V, with changes
        at samples 51, 251, 451, 651 and 851.

    Raises
    ------
    ValueError
        If only one of `student` and `secret` is given, or one of them is invalid.
    """
    plan = _plan(student, secret)
    u = staircase(plan.levels, plan.starts, _SAMPLES)
    return _settled_log(plan, u, _LAB_NOISE, "SysIdenData_StudentVersion")


def make_verification_record(student: str | None = None, secret: bytes | None = None) -> LabLog:
    """Make a second record of the same rig, for verification on data not used in the fit (Fig. 4).

    Parameters
    ----------
    student, secret : optional
        As for `make_lab_record`.

    Returns
    -------
    LabLog
        741 samples at 0.75 s from the same rest level, with other levels within the range of the first record.

    Raises
    ------
    ValueError
        As for `make_lab_record`.
    """
    plan = _plan(student, secret)
    levels = tuple(round(plan.levels[0] + step, 2) for step in _VERIFICATION_STEPS)
    u = staircase(levels, _VERIFICATION_STARTS, _VERIFICATION_SAMPLES)
    return _settled_log(plan, u, _VERIFICATION_NOISE, "SysIdenData_Verification")


def make_empty_start_record(student: str | None = None, secret: bytes | None = None) -> LabLog:
    """Make the lab's record with the tanks empty at the start, like several logs of the real rig.

    Parameters
    ----------
    student, secret : optional
        As for `make_lab_record`.

    Returns
    -------
    LabLog
        1203 samples at 0.75 s: 300 samples in which the tanks fill, then those of `make_lab_record`. The upper tank
        starts empty and the lower one at the level where the sensor reads 0 V. The rig is switched on with the log,
        so its moving average begins with zeros.

    Raises
    ------
    ValueError
        As for `make_lab_record`.
    """
    plan = _plan(student, secret)
    filling = np.full(_SAMPLES_TO_FILL, plan.levels[0])
    u = np.concatenate([filling, staircase(plan.levels, plan.starts, _SAMPLES)])
    seed = plan.seed(_EMPTY_START_NOISE)
    return log_run(plan.parameters, u, seed, "SysIdenData_EmptyStart", is_settled=False)


def _plan(student: str | None, secret: bytes | None) -> LabPlan:
    if student is None and secret is None:
        return STAND_IN
    if student is None or secret is None:
        missing = "student" if student is None else "secret"
        raise ValueError(f"student and secret go together; got no {missing}. Give both, or neither for the stand-in.")
    return student_plan(student, secret)


def _settled_log(plan: LabPlan, u: FloatArray, noise: int, name: str) -> LabLog:
    return log_run(plan.parameters, u, plan.seed(noise), name)


def log_run(
    parameters: TankParameters,
    u: FloatArray,
    seed: np.random.SeedSequence,
    name: str,
    Ts: float = TS,
    noise: float = SENSOR_NOISE,
    is_settled: bool = True,
    max_step: float = 0.1,
) -> LabLog:
    """Log one run of a rig.

    Parameters
    ----------
    parameters : TankParameters
    u : ndarray, shape (N,)
        Pump voltage (V).
    seed : SeedSequence
        Of the sensor noise.
    name : str
        Name of the record.
    Ts : float
        Sampling time (s).
    noise : float
        Standard deviation of the sensor noise (V).
    is_settled : bool
        Whether the rig ran at its rest level before the log, so that the moving average uses samples from before it.
        If not, the upper tank starts empty and the lower one at the level where the sensor reads 0 V, and the moving
        average begins with zeros, because the rig is switched on with the log.
    max_step : float
        Longest integration step (s).

    Returns
    -------
    LabLog
    """
    averaged = AVERAGED - 1
    rig = replace(
        tank_rig(parameters),
        # 12 bits over -10..10 V: the step of 0.0048828125 V of the real logs.
        sensor=(sensor_noise(noise, seed), converter(bits=12, low=-10.0, high=10.0)),
    )
    if is_settled:
        x0 = steady_levels(parameters, float(u[0]))
        running = np.concatenate([np.full(averaged, u[0]), u])
        measured = simulate_rig(rig, running, Ts, x0, max_step).y
        earlier, measured = measured[:averaged], measured[averaged:]
    else:
        earlier = np.zeros(averaged)
        measured = simulate_rig(rig, u, Ts, (0.0, zero_level(parameters)), max_step).y
    t: FloatArray = Ts * np.arange(u.size, dtype=np.float64)
    return LabLog(t, u, measured, noise_reduced(measured, earlier), Ts, name)
