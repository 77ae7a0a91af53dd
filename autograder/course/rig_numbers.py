"""What the passages on a rig say of its record, as text: levels, and what the lab finds.

``u.rest``, ``u.low``, ``u.high``, ``y.rest``
    Levels of the record.
``tau``, ``settling``, ``condition``, ``rms``, ``share``, ``signs``
    Time constant and four of them (s), condition number of Phi, error of the simulation, as a share of the range of y,
    and what the signs of the signals without their offsets are.
``start``
    What the right initial state saves in the second half.
``loop.change``, ``loop.step``, ``loop.target``, ``loop.wrong``
    The loop of Fig. 3: what its set point does to the output, the step as a number, the set point as code, and what
    happens without the output offset.
``order1.pole``, ``order1.tau``, ``mse1``, ``mse2``, ``rms1``, ``rms2``, ``saving``
    Of the models of first and second order: pole and time constant of the first, errors of both, and a sentence on what
    the second saves.
``step.K``, ``step.tau``, ``step.td``
    First-order model with delay of the first step.
"""

import numpy as np

from labsid.lab.identification import Identification, identify
from labsid.lab.step_response import cut_held_step, fit_step_response
from labsid.records.record import Record

_SIGNED = 0.05
"""Share of the range of a signal by which it must be below zero, and above, to be said to have both signs."""

_SET_POINT = 0.1
"""Set point of the loop, as a share of the range of the output."""

_ROOM = 1.5
"""How many times the set point the input's range must allow, so that the controller reaches it."""

START_MATTERS = 2.0
"""From this factor on the error of the second half depends more on the initial state than on the model."""


def numbers_of_record(record: Record, output_unit: str) -> dict[str, str]:
    """The numbers of a record, and the phrases that depend on them.

    Parameters
    ----------
    record : Record
    output_unit : str
        Unit of the output.

    Raises
    ------
    ValueError
        If the lab cannot be carried out on the record.
    """
    first, second = identify(record, 1), identify(record, 2)
    t, y, amplitude = cut_held_step(record.u, record.y, record.Ts, 0, before=min(first.offsets.first_period, 20))
    step = fit_step_response(t, y, amplitude).reading
    slowest = float(max(abs(pole) for pole in second.model.poles))
    pole = float(first.model.poles[0].real)
    if not (0 < slowest < 1 and 0 < pole < 1):
        raise ValueError("the models of the record do not settle")
    tau, tau_1 = (-record.Ts / float(np.log(one)) for one in (slowest, pole))
    mse_1, errors = first.verification.mse_all, second.verification
    levels = {
        "u.rest": second.model.u_offset,
        "u.low": float(record.u.min()),
        "u.high": float(record.u.max()),
        "y.rest": second.model.y_offset,
    }
    numbers = {
        "tau": tau,
        "settling": 4 * tau,
        "condition": second.fit.condition_number,
        "rms": float(np.sqrt(errors.mse_all)),
        "order1.tau": tau_1,
        "rms1": float(np.sqrt(mse_1)),
        "rms2": float(np.sqrt(errors.mse_all)),
        "step.K": step.K,
        "step.tau": step.tau,
        "step.td": step.td,
    }
    return (
        {key: _short(value, 4) for key, value in levels.items()}
        | {key: _short(value, 2) for key, value in numbers.items()}
        | _loop(second, output_unit)
        | {
            "share": f"{np.sqrt(errors.mse_all) / np.ptp(record.y):.1%}".replace("%", " %"),
            "signs": _signs(second),
            "start": _start(errors.mse_second_half, errors.mse_second_half_carried),
            "order1.pole": f"{pole:.3f}",
            "mse1": f"{mse_1:.3g}",
            "mse2": f"{errors.mse_all:.3g}",
            "saving": _saving(1 - errors.mse_all / mse_1),
        }
    )


def _signs(found: Identification) -> str:
    both = all(min(-x.min(), x.max()) > _SIGNED * np.ptp(x) for x in (found.u, found.y))
    return "; both now take positive and negative values" if both else ""


def _start(from_rest: float, carried: float) -> str:
    if from_rest < START_MATTERS * carried:
        return "On the course's record this hardly changes the error: the second half begins near the level at rest."
    return (
        "With the right initial state, the mean squared error is smaller, on the course's record by a factor of about "
        f"{_short(from_rest / carried, 2)}. So `mse_half` depended more on the initial state than on the model."
    )


def _loop(found: Identification, unit: str) -> dict[str, str]:
    """A set point that the input can reach, and where the loop ends that omits the output offset."""
    record, model = found.record, found.model
    ends = [model.y_offset + model.static_gain * (u - model.u_offset) for u in (record.u.min(), record.u.max())]
    low, high = min(ends), max(ends)
    size = float(_short(_SET_POINT * float(np.ptp(record.y)), 2))
    is_up = high - model.y_offset >= min(_ROOM * size, model.y_offset - low)
    r = size if is_up else -size
    if low <= r <= high:
        wrong = f"and leads the output itself to {r:g} {unit}"
    else:
        is_lower = (r < low) == (model.static_gain > 0)
        limit = float(record.u.min() if is_lower else record.u.max())
        side = "lower" if is_lower else "upper"
        goes = "stays at" if limit == model.u_offset else "goes to"
        wrong = f"and the input {goes} its {side} limit"
    return {
        "loop.change": f"{'raises' if is_up else 'lowers'} the output by {_short(size, 2)} {unit}",
        "loop.step": _short(r, 2),
        "loop.target": f"y_offset {'+' if is_up else '-'} {_short(size, 2)}",
        "loop.wrong": wrong,
    }


def _saving(share: float) -> str:
    if share > 0:
        return f"On the course's record the step from order 1 to 2 saves {100 * share:.0f} %."
    return "On the course's record the step from order 1 to 2 saves nothing."


def _short(value: float, digits: int) -> str:
    """A number with few digits, without a power of ten where it can be."""
    rounded = float(f"{value:.{digits}g}")
    return f"{rounded:.0f}" if 10**digits <= abs(rounded) < 1e6 else f"{rounded:g}"
