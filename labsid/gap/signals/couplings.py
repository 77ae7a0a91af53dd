"""Paths that a given simulation lacks, found in the record and told in the report of an output."""

from collections.abc import Sequence
from typing import Any

from labsid.gap.effects.inside import MISMATCH
from labsid.gap.fits.fitting import Fit
from labsid.gap.reports.quantities import chance
from labsid.gap.search.beam_search import BIC_MARGIN
from labsid.gap.signals.given import Coupling, find_couplings
from labsid.gap.signals.input_responses import linear_parts
from labsid.gap.signals.roles import Signals, make_role
from labsid.gap.verdict.scores import NO_GAP_MEAN_SQUARE, closed_share

COUPLING = "coupling"
BESIDE_OTHERS = 0.9  # largest probability of a coupling where something else is left; set by hand


def couplings_of(signals: Signals, j: int) -> tuple[Coupling, ...]:
    """The paths from inputs to output j that the given simulation of `signals` lacks."""
    assert signals.given is not None
    if signals.given.paths[j].all():
        return ()
    pairs = [signals.data(i, j) for i in range(len(signals.inputs))]
    parts = linear_parts(pairs)
    # through an input that moves the output in the simulation, so that the output depends on it
    main = max(range(len(pairs)), key=lambda i: (signals.given.paths[j, i], parts.strength[i]))  # type: ignore[union-attr]
    base = make_role(signals, j, main, parts, 2, "given").base
    return find_couplings(signals.given, [pairs[main], *pairs], base, j, parts, signals.inputs)


def with_couplings(report: dict[str, Any], signals: Signals, j: int, before: Fit) -> dict[str, Any]:
    """The report of output j with the couplings that the given simulation lacks, ahead of its effects.

    They take the place of wrong parameters, if these explain no more.

    Parameters
    ----------
    report : dict
        Of output j.
    signals : Signals
    j : int
    before : Fit
        From which effects were searched.
    """
    given = signals.given
    couplings: Sequence[Coupling] = given.couplings[j] if given is not None and given.couplings else ()
    if given is None or not couplings:
        return report
    effects = report["effects"]
    freed = bool(given.simulator.free) or (given.linear and couplings[-1].bic - before.bic > BIC_MARGIN)
    effects = [effect for effect in effects if freed or effect["name"] != MISMATCH]
    own = [_effect(coupling, signals, j, report, alone=not effects) for coupling in couplings]
    verdict = "effect" if report["verdict"] in ("none", "effect") else "partial"
    gap = report["gap"]
    if gap["closed"] is None and gap["before"] ** 2 > NO_GAP_MEAN_SQUARE * gap["noise_floor"] ** 2:
        gap = gap | {"closed": closed_share(*(gap[key] ** 2 for key in ("before", "after", "noise_floor")))}
    return report | {"verdict": verdict, "effects": [*own, *effects], "gap": gap}


def _effect(one: Coupling, signals: Signals, j: int, report: dict[str, Any], alone: bool) -> dict[str, Any]:
    """One coupling, as an effect of a report."""
    gap, sure = report["gap"], report["explanation"]["confidence"]
    certain = report["verdict"] in ("none", "effect") and alone
    probability = one.probability * (sure if certain else min(sure + BESIDE_OTHERS, BESIDE_OTHERS))
    before, floor = gap["before"] ** 2, gap["noise_floor"] ** 2
    return {
        "name": COUPLING,
        "from": signals.inputs[one.input],
        "to": signals.outputs[j],
        "path": "dynamics",
        "parameters": {"gain": {"value": one.gain, "stderr": None, "unit": "y/u"}},
        "probability": probability,
        "chance": chance(probability, report["reference"]),
        "closed": closed_share(before, one.left * before, floor) if before > NO_GAP_MEAN_SQUARE * floor else None,
        "evidence": None,
    }
