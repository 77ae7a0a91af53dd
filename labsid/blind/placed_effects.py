"""Labels of effects at one of several signals, and whether an answer names them there."""

from collections.abc import Sequence
from typing import Any

from labsid.blind.metrics import CaseOutcome, Metric, all_named, rate, stated_verdict
from labsid.rig.switchable.coupled.placed_effect import PlacedEffect
from labsid.rig.switchable.coupled.setup import CoupledSetup
from labsid.rig.switchable.coupled.units import Units

SIGNAL_ROWS = ("signals", "signals-hard", "signals-none", "loop")
"""Rows with such labels."""

LIKELY, SURE = 0.5, 0.9
"""Probabilities above which a wrong name or signal counts."""

VISIBLE = 0.5
"""Change of an output over its noise from which an answer has to say that it is changed."""


def placed_label(placed: PlacedEffect, setup: CoupledSetup, units: Units, changes: dict[str, float]) -> dict[str, Any]:
    """Label of one effect.

    Parameters
    ----------
    placed : PlacedEffect
    setup : CoupledSetup
        The rig with the effect.
    units : Units
    changes : dict
        Rms change of each output by the effect, over its noise.

    Returns
    -------
    dict
        ``name``; ``signal``, and all right ``signals``; ``outputs`` that the effect changes, and those of them whose
        change is ``visible``; ``parameters``.
    """
    return {
        "name": placed.name,
        "signal": placed.signal,
        "signals": list(placed.signals),
        "outputs": [name for name, change in changes.items() if change > 0.0],
        "visible": [name for name, change in changes.items() if change > VISIBLE],
        "parameters": placed.parameters(setup, units),
    }


def names_effect(case: CaseOutcome) -> bool:
    """Whether exactly the true effects are named, at whatever signal, and the verdict is none where there are none."""
    return all_named(case) and (stated_verdict(case) == "none") == (not case.label["labels"])


def names_effect_and_signal(case: CaseOutcome) -> bool:
    """Whether exactly the true effects are named, each at a right signal."""
    return names_effect(case) and not any(_is_wrong(case, one) for one in _said(case))


def wrong_claims(case: CaseOutcome, above: float, with_signal: bool = True) -> list[dict[str, Any]]:
    """Stated effects with a probability above `above` whose name or signal is wrong.

    Parameters
    ----------
    case : CaseOutcome
    above : float
    with_signal : bool
        Whether a wrong signal counts.

    Returns
    -------
    list of dict
    """
    likely = [effect for effect in _said(case) if float(effect.get("probability") or 0.0) > above]
    return [effect for effect in likely if _is_wrong(case, effect, with_signal)]


def names_outputs(case: CaseOutcome) -> bool:
    """Whether each effect has all outputs that it changes visibly, and none that it cannot change."""
    true = {one["name"]: one for one in case.label["truth"]["effects"]}
    return all(
        set(true[one["name"]]["visible"]) <= set(one.get("outputs") or []) <= set(true[one["name"]]["outputs"])
        for one in _said(case)
    )


def signal_metrics(
    clear: Sequence[CaseOutcome],
    hard: Sequence[CaseOutcome],
    none: Sequence[CaseOutcome],
    loop: Sequence[CaseOutcome],
) -> list[Metric]:
    """Metrics of the rows of several signals and of closed loops.

    Parameters
    ----------
    clear, hard, none, loop : sequence of CaseOutcome
        Of `SIGNAL_ROWS`, in this order.
    """
    effects, every = [*clear, *hard], [*clear, *hard, *none]
    right = [case for case in effects if names_effect_and_signal(case)]
    return [
        rate("several signals: name and signal right, clear", map(names_effect_and_signal, clear), 0.95, 0.985),
        rate("several signals: name and signal right, hard", map(names_effect_and_signal, hard), 0.88, 0.94),
        rate("several signals, no effect: none reported", map(names_effect, none), 0.99, 0.995),
        rate("  several signals: name right at whatever signal, clear and hard", map(names_effect, effects)),
        rate("  several signals: outputs of the effects that are named rightly", map(names_outputs, right)),
        *(
            rate(
                f"several signals: a wrong name or signal above {p}",
                (bool(wrong_claims(c, p)) for c in every),
                below=True,
            )
            for p in (LIKELY, SURE)
        ),
        rate("closed loop: right effect named, or none", map(names_effect, loop)),
        rate("  closed loop: free or stabilised as the rig needs it", map(_has_right_mode, loop)),
        *(
            rate(f"closed loop: a wrong name above {p}", (bool(wrong_claims(c, p, False)) for c in loop), below=True)
            for p in (LIKELY, SURE)
        ),
    ]


def _said(case: CaseOutcome) -> list[dict[str, Any]]:
    return list((case.result or {}).get("effects") or [])


def _is_wrong(case: CaseOutcome, said: dict[str, Any], with_signal: bool = True) -> bool:
    named = [one for one in case.label["truth"]["effects"] if one["name"] == said.get("name")]
    return not any(said.get("signal") in one["signals"] or not with_signal for one in named)


def _has_right_mode(case: CaseOutcome) -> bool:
    gap = (case.result or {}).get("gap") or {}
    return gap.get("mode") == case.label["truth"]["mode"]
