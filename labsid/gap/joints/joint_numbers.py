"""Which numbers of each joint a record determines, and of the others, which combination of them."""

from dataclasses import asdict, replace
from typing import Any

from labsid.gap.fits.fitting import Problem
from labsid.gap.fits.identifiability import assess
from labsid.gap.joints.views import ArmRecord, joint_view
from labsid.gap.reports.sentences import number_sentences


def numbers_by_joint(arm: ArmRecord) -> dict[str, list[dict[str, Any]]]:
    """What all outputs together say of the numbers of a joint, its link and its actuator, at their nominal values.

    The numbers of one joint are free at a time, without those that are zero: the model has them not.

    Parameters
    ----------
    arm : ArmRecord

    Returns
    -------
    dict
        By joint, ``{name, determined, combination, group, stderr}`` of each number; stderr is None if it is not
        determined. Empty for a joint whose neighbouring values cannot be simulated.
    """
    found: dict[str, list[dict[str, Any]]] = {}
    for place, one in enumerate(arm.joints.joints):
        names = tuple(name for name, value in one.nominal().items() if value)
        view = joint_view(replace(arm, simulator=replace(arm.simulator, free=names)), place, {}, {})
        problem = Problem(view.data, view.base.structure)
        assert view.base.start is not None
        nominal = problem.start(view.base.start)
        known = {} if nominal is None else assess(problem, nominal, 1.0 / view.data.y_scale.unit)
        found[one.joint] = [
            asdict(number) | {"name": name, "stderr": number.stderr if number.determined else None}
            for name, number in known.items()
        ]
    return found


def sentences_by_joint(numbers: dict[str, list[dict[str, Any]]]) -> list[str]:
    """The same in a sentence or two for each joint."""
    texts = []
    for joint, own in numbers.items():
        said = " ".join(number_sentences([one | {"at_limit": False} for one in own]))
        texts.append(f"{joint}: {said or f'The record determines {counted_numbers(len(own))}.'}")
    return texts


def counted_numbers(count: int) -> str:
    """``all 6 numbers of the joint``."""
    return f"all {count} numbers of the joint" if count else "none of the numbers of the joint: it cannot be simulated"
