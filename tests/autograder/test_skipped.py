"""A hand-in whose cells skip questions and sum up: the skipped question earns nothing, and nothing else changes."""

SKIP = 'check.skip("prelab-1-time")\ncheck.summary()'


def test_a_skipped_question_earns_nothing_and_costs_nothing_else(grade_code) -> None:
    results = grade_code("prelab-sinusoids", {"prelab-1-time-answer": SKIP})
    assert results["prelab-1-time"].reason == "There is no variable `t`: it is not defined."
    scores = {question: result.score for question, result in results.items() if result.status == "graded"}
    wrong = [question for question, score in scores.items() if score != results[question].max_score]
    assert wrong == ["prelab-1-time"]


def test_a_skip_beside_a_right_answer_does_not_stop_its_cell(grade_code) -> None:
    right = "t = np.linspace(0, 100, 1001).reshape(-1, 1)"
    result = grade_code("prelab-sinusoids", {"prelab-1-time-answer": f"{SKIP}\n{right}"})["prelab-1-time"]
    assert result.score == result.max_score
    assert "stopped" not in result.reason


def test_tries_and_predictions_do_nothing_at_grading(grade_code) -> None:
    left = 'check.tries.keep()\ncheck.tries()\ncheck.tries.delete()\ncheck.predict("order")\n'
    right = "t = np.linspace(0, 100, 1001).reshape(-1, 1)"
    result = grade_code("prelab-sinusoids", {"prelab-1-time-answer": left + right})["prelab-1-time"]
    assert result.score == result.max_score
    assert "stopped" not in result.reason


def test_what_the_notebook_refuses_is_refused_at_grading(grade_code) -> None:
    right = "t = np.linspace(0, 100, 1001).reshape(-1, 1)"
    for line in ("from labsid import find_offsets", "from labsid import plots; plots.figure_5"):
        result = grade_code("prelab-sinusoids", {"prelab-1-time-answer": f"{line}\n{right}"})["prelab-1-time"]
        assert result.score == 0, line
        assert "Your cell stopped in line 1 with" in result.reason
