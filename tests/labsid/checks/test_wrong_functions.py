"""Wrong answers fail on every draw of the trial data: none passes by luck. `make bars` draws 200 times."""

import pytest
import wrong_draws

from labsid.checks.notebook import assignment_names, load_assignment

DRAWS = 3
QUESTIONS = [
    pytest.param(name, question.id, id=question.id)
    for name in assignment_names()
    for question in load_assignment(name).questions
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "question"), QUESTIONS)
def test_no_wrong_answer_passes_by_luck(name: str, question: str) -> None:
    passed, tried = wrong_draws.draw(name, [question], DRAWS)
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
