"""The explanation of a verdict: its gates are those of the decision, its thresholds the constants that decide."""

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
from gap_answers import answered
from gap_search import searched

from labsid.cli.gap_why import EVIDENCE, format_why
from labsid.gap.diagnosis import Diagnosis, diagnose
from labsid.gap.search import beam_search
from labsid.gap.search.explanation import Explanation
from labsid.gap.verdict.answer import Answer
from labsid.gap.verdict.decision import Evidence, PartialEvidence, confidence_in, partial_probability
from labsid.gap.verdict.gates import Gate, Why
from labsid.gap.verdict.why import explain_verdict


@pytest.fixture(scope="module")
def in_part(banded: Explanation) -> Answer:
    """A dead zone, and a product of states that no effect of the table describes."""
    z = banded.best.output
    added = z * np.gradient(z)
    return answered(replace(banded, data=replace(banded.data, y=banded.data.y + 0.25 * added / added.std())))


@pytest.fixture(scope="module")
def answers(banded: Explanation, plain: Explanation, in_part: Answer) -> dict[str, Answer]:
    return {"effect": answered(banded), "none": answered(plain), "partial": in_part}


def gates_of(why: Why) -> list[Gate]:
    return [gate for stage in why.stages for gate in stage.gates]


def gate_at(why: Why, place: str) -> Gate:
    return next(gate for gate in gates_of(why) if gate.threshold.place == place)


def test_the_gates_lead_to_the_verdict(answers: dict[str, Answer]) -> None:
    """`--why` says the verdict's own word, and its gates pass and fail as that word asks."""
    for verdict, answer in answers.items():
        why = explain_verdict(answer)
        assert (why.verdict, why.names) == (verdict, answer.decision.names)
        assert gate_at(why, "verdict/decision.MIN_CONFIDENCE").passed == (verdict != "partial")
        if verdict != "partial":
            assert gate_at(why, "search/beam_search.BIC_MARGIN").passed == (verdict == "effect")
            assert len(why.stages) == 2
            continue
        assert gate_at(why, "verdict/held_out_errors.MAX_FACTOR").passed
        assert gate_at(why, "verdict/held_out_errors.MIN_T").passed


def test_thresholds_are_the_constants_that_they_name(answers: dict[str, Answer]) -> None:
    """The place of a threshold leads to a constant of that value; a reader changes it there."""
    for answer in answers.values():
        for gate in gates_of(explain_verdict(answer)):
            module, name = gate.threshold.place.split(".")
            constant = getattr(import_module(f"labsid.gap.{module.replace('/', '.')}"), name.partition("[")[0])
            if not callable(constant):
                index = name.partition("[")[2].rstrip("]")
                assert gate.threshold.value == (constant[int(index)] if index else constant)


def test_a_gate_follows_its_constant(answers: dict[str, Answer], monkeypatch: pytest.MonkeyPatch) -> None:
    """No threshold is written twice: a gate whose constant is moved has the new one."""
    monkeypatch.setattr(beam_search, "BIC_MARGIN", 1e9)
    assert not gate_at(explain_verdict(answers["effect"]), "search/beam_search.BIC_MARGIN").passed


def test_probabilities_are_the_sums_that_are_stated(answers: dict[str, Answer]) -> None:
    """Prior and evidence times weight give the probability of the report."""
    for answer in answers.values():
        for stage in explain_verdict(answer).stages:
            for one in stage.probabilities:
                if one.of:
                    assert one.value == partial_probability(answer.evidence[one.of])
                else:
                    assert one.value == confidence_in(answer.complete.evidence)
                assert one.value == pytest.approx(1.0 / (1.0 + np.exp(-one.total)))


def test_what_was_not_taken_says_why(answers: dict[str, Answer]) -> None:
    """Never an accepted combination, best first, each with the gate that stopped it."""
    for answer in answers.values():
        for stage in explain_verdict(answer).stages:
            assert all(len(one.figures) == len(stage.columns) and one.reason for one in stage.not_taken)
    searched = answers["effect"].steps.searched
    first, *_ = explain_verdict(answers["effect"]).stages
    assert searched.best.hypothesis.names not in [one.names for one in first.not_taken]
    rival = first.not_taken[0]
    fit = searched.levels[1][rival.names]
    assert rival.figures[0] == searched.path[0].bic - fit.bic
    assert "input-dead-zone has the lower BIC" in rival.reason
    nothing, *_ = explain_verdict(answers["none"]).stages
    assert {one.reason for one in nothing.not_taken} <= {
        "its BIC is worse than without it",
        "it gains too little BIC (12 needed)",
    }
    last = explain_verdict(answers["partial"]).stages[-1]
    errors = [one.figures[0] for one in last.not_taken]
    assert errors == sorted(errors)
    assert answers["partial"].decision.names not in [one.names for one in last.not_taken]


def test_a_named_effect_that_the_bic_refused_is_shown(in_part: Answer) -> None:
    """As of the friction of EMPS, which cuts the error to a fifth: the reader sees that its BIC is worse."""
    found = in_part.steps.searched
    (name,) = in_part.decision.names
    worst = replace(found.levels[1][name,], bic=found.path[0].bic + 8483.0)
    refused = replace(found, levels=(found.levels[0], found.levels[1] | {(name,): worst}), path=found.path[:1])
    why = explain_verdict(replace(in_part, steps=replace(in_part.steps, searched=refused)))
    (shown,) = [one for one in why.stages[0].not_taken if one.names == (name,)]
    assert shown.figures[0] == pytest.approx(-8483.0)
    assert shown.reason == "its BIC is worse than without it"


def test_the_cap_of_a_record_unlike_the_simulated_rigs_is_a_gate(in_part: Answer) -> None:
    """A probability that is lowered says by which rule, and in what the record differs."""
    (name,) = in_part.decision.names
    certain = replace(in_part.steps.named, probability={name: 0.97})
    unlike = replace(in_part.novelty, beyond=("noise", "gap"))
    capped = replace(in_part.decision, probability={name: unlike.capped(0.97)})
    answer = replace(in_part, novelty=unlike, decision=capped, steps=replace(in_part.steps, named=certain))
    gate = gate_at(explain_verdict(answer), "verdict/novelty.OUTSIDE")
    assert (gate.value, gate.passed) == (0.97, False)
    assert "noise and gap" in gate.meaning


@pytest.fixture(scope="module")
def on_holdout(rig_record) -> Diagnosis:
    """A linear rig without a gap, and a holdout of one that clips."""
    with searched("input-delay", "output-saturation"):
        found = diagnose(rig_record("none"), holdout=rig_record("output-saturation", seed=5), why=True)
    assert isinstance(found, Diagnosis)
    return found


def test_the_gap_on_a_holdout_is_a_gate(on_holdout: Diagnosis) -> None:
    """A record without a gap passes as `none`; that its holdout has one is stated."""
    why = on_holdout.why
    assert why is not None
    assert gate_at(why, "verdict/decision.MIN_CONFIDENCE").passed
    (gate,) = why.stages[2].gates
    assert gate.threshold.place in ("verdict/scores.NO_GAP_RMS", "verdict/scores.CERTAIN")
    assert (gate.passed, why.verdict) == (False, on_holdout.verdict)


def test_a_given_simulation_has_the_gate_of_its_parameters(rig_record) -> None:
    """Whether other values of the parameters gain enough BIC is stated for a simulation that was given."""
    model = {"num": [0.0, 0.0, 0.012], "den": np.poly([0.95, 0.8]).tolist(), "dt": 0.5}
    with searched("input-delay"):
        found = diagnose(rig_record("none"), model, why=True)
    assert isinstance(found, Diagnosis)
    assert found.why is not None
    gate = gate_at(found.why, "search/beam_search.BIC_MARGIN")
    assert gate.passed == ("parameter-mismatch" in found.effects)
    assert "parameter-mismatch" in gate.meaning


@pytest.mark.parametrize("columns", [80, 120])
def test_the_text_fits_the_terminal(answers: dict[str, Answer], columns: int) -> None:
    """Lines no longer than the terminal; each gate with its result, and the verdict at the end."""
    for verdict, answer in answers.items():
        why = explain_verdict(answer)
        text = format_why(why, columns)
        assert max(map(len, text.splitlines())) <= columns
        assert text.count("   pass  ") + text.count("   FAIL  ") == len(gates_of(why))
        assert f"\nVerdict {verdict}" in text
        assert all(gate.threshold.place in text for gate in gates_of(why))


def test_every_measure_of_evidence_is_explained() -> None:
    """A measure that is added to the evidence needs its words here."""
    assert set(EVIDENCE) == {*Evidence._fields, *PartialEvidence._fields}
