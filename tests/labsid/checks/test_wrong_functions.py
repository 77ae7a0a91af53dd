"""Wrong answers fail on every draw of the trial data: none passes by luck. `make bars` draws 200 times."""

import pytest
import wrong_draws

from labsid.checks.notebook import assignment_names, load_assignment

QUESTIONS = [
    pytest.param(name, question.id, id=question.id)
    for name in assignment_names()
    for question in load_assignment(name).questions
]


@pytest.mark.slow
@pytest.mark.parametrize("draws", [1, pytest.param(2, marks=pytest.mark.exhaustive)])
@pytest.mark.parametrize(("name", "question"), QUESTIONS)
def test_no_wrong_answer_passes_by_luck(name: str, question: str, draws: int) -> None:
    passed, tried = wrong_draws.draw(name, [question], draws)
    assert passed == []
    assert tried > 0


def test_an_answer_that_passes_by_luck_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """A right answer, planted as a wrong one."""
    source = "def kind(M):\n    raise ValueError\n"
    planted = wrong_draws.Wrong("ls-1-kind", "stops", {"ls-1-kind-answer": source}, "")
    model = wrong_draws.solve("least-squares").cells["ls-1-kind-answer"]
    lucky = wrong_draws.Wrong("ls-1-kind", "right", {"ls-1-kind-answer": model}, "")
    monkeypatch.setattr(wrong_draws, "variants_of", lambda name: [planted, lucky])
    passed, tried = wrong_draws.draw("least-squares", ["ls-1-kind"], 3)
    assert passed == ["ls-1-kind: right passes with 3 of 3 seeds, as 0"]
    assert tried == 6


def test_a_fault_with_which_an_estimate_runs_away_is_named_on_every_draw() -> None:
    """Rounding differs between the student's lines and the check's, and grows with the estimate."""
    name, question, fault = "armax-and-instruments", "ai-6-rels", "gain from the old P"
    (wrong,) = (one for one in wrong_draws.variants_of(name) if (one.question, one.name) == (question, fault))
    solved = wrong_draws.solve(name)
    with wrong_draws.quietly():
        variables = solved.run(question, wrong.code)
        verdicts = [solved.verdict_and_draws(question, variables, seed)[0] for seed in range(20)]
    assert {verdict.slip for verdict in verdicts} == {fault}
