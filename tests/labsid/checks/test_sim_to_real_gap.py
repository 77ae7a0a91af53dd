"""The sim-to-real gap on a rig of each effect: the solution passes before the judge, a wrong hypothesis does not."""

import re
from dataclasses import dataclass
from pathlib import Path

import jupytext
import matplotlib.pyplot as plt
import numpy as np
import pytest
from representatives import mostly_exhaustive

from labsid.checks import NoAnswer, Question, Verdict
from labsid.checks.notebook import load_assignment
from labsid.checks.question import Origin
from labsid.checks.values import plain
from labsid.records.record import Record, load_record
from labsid.rig.switchable.withheld import withheld_record_bytes, withheld_rig
from labsid.rig.switchable.withheld_effects import EFFECT_PARAMETERS, EFFECT_PATHS, RECORD_FILE

NAME = "sim-to-real-gap"
SECRET = b"a secret of the tests"
QUESTIONS = load_assignment(NAME).questions
ODD = (None, 3.0, "text", (1, 2), np.zeros((2, 2, 2)), ((1.0,), "a"), [], {"a": 1}, np.full(3, np.nan), 1j, True, ...)


@dataclass(frozen=True)
class Solved:
    """A student's record, and the variables of the model solution on it."""

    student: str
    effect: str
    record: Record
    variables: dict[str, object]


ONE_OF_EACH_PATH = ("input-saturation", "sqrt-outflow", "output-saturation")
"""Tried everywhere, with a delay, which is in seconds, and has no offset."""


@pytest.fixture(scope="module", params=mostly_exhaustive(EFFECT_PATHS, ["input-delay", *ONE_OF_EACH_PATH]))
def solved(request, tmp_path_factory, notebook_cells) -> Solved:
    """One rig of each effect, worked through by the model solution."""
    student = next(f"z{i}" for i in range(1000) if withheld_rig(f"z{i}", SECRET).effect == request.param)
    folder = tmp_path_factory.mktemp("work")
    (folder / RECORD_FILE).write_bytes(withheld_record_bytes(student, SECRET))
    variables: dict[str, object] = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for words, source in notebook_cells(NAME):
            if "points" not in words and "demonstration" not in words["tags"]:
                exec(compile(source, str(words["grade_id"]), "exec"), variables)
    plt.close("all")
    return Solved(student, request.param, load_record(folder / RECORD_FILE), variables)


class Asked:
    """Asks a student's variables, some of them replaced; with an origin as the judge does, without as the notebook."""

    def __init__(self, solved: Solved, origin: bool, **replaced: object) -> None:
        self._variables = solved.variables | replaced
        self.record = solved.record
        self.origin = Origin(solved.student, SECRET) if origin else None
        self.rng = np.random.default_rng(5)
        self.known = lambda name: plain(solved.variables[name])

    def value(self, name):
        if name not in self._variables:
            raise NoAnswer(f"there is no variable `{name}`")
        return plain(self._variables[name])

    def call(self, name, *arguments):
        function = self._variables.get(name)
        if not callable(function):
            raise NoAnswer(f"there is no function `{name}`")
        try:
            return plain(function(*arguments))
        except Exception as error:
            raise NoAnswer(f"`{name}` stopped with {error}") from error


def judged(solved: Solved, question: str, **replaced: object) -> Verdict:
    """What the judge, who knows the origin, says."""
    return load_assignment(NAME).question(question).verdict(Asked(solved, True, **replaced))


@pytest.mark.parametrize("origin", [True, False], ids=["judge", "notebook"])
def test_the_solution_passes_on_a_rig_of_each_effect(solved: Solved, origin: bool) -> None:
    verdicts = {question.id: question.verdict(Asked(solved, origin)) for question in QUESTIONS}
    assert {name: verdict.reason for name, verdict in verdicts.items() if not verdict.passed} == {}
    assert solved.variables["effect"] == solved.effect


@pytest.mark.parametrize("origin", [True, False], ids=["judge", "notebook"])
def test_the_name_of_the_effect_may_have_underscores(solved: Solved, origin: bool) -> None:
    asked = Asked(solved, origin, effect=solved.effect.replace("-", "_"))
    assert load_assignment(NAME).question("gap-8-effect").verdict(asked).passed


def test_every_other_hypothesis_closes_too_little(solved: Solved) -> None:
    u_offset, y_offset = solved.variables["u_offset"], solved.variables["y_offset"]
    for name, (_, model, q) in solved.variables["fits"].items():
        if name == solved.effect:
            continue
        verdict = judged(
            solved, "gap-7-simulation", simulate_better=lambda u, m=model, q=q: y_offset + m(q, u - u_offset)
        )
        assert not verdict.passed, name
        assert "another effect" in verdict.reason or verdict.slip == "no effect added"


def test_every_other_name_is_wrong(solved: Solved) -> None:
    for name, path in EFFECT_PATHS.items():
        verdict = judged(solved, "gap-8-effect", effect=name)
        assert verdict.passed == (name == solved.effect)
        assert verdict.passed or (verdict.slip or "").startswith("another")
        assert solved.effect not in verdict.reason
        assert judged(solved, "gap-8-path", path=path).passed == (path == EFFECT_PATHS[solved.effect])


def test_the_notebook_does_not_know(solved: Solved) -> None:
    """It says the same of every name, so that nobody can ask it for the right one."""
    question = load_assignment(NAME).question("gap-8-effect")
    said = {question.verdict(Asked(solved, False, effect=name)).reason.replace(name, "") for name in EFFECT_PATHS}
    assert len(said) == 1


def test_parameters_must_be_near(solved: Solved) -> None:
    right = {name: float(value) for name, value in solved.variables["parameters"].items()}
    span = float(np.ptp(solved.record.u if solved.effect.startswith("input") else solved.record.y))
    for name, value in right.items():
        step = {"delay": 3.2, "c2": 0.12 * value, "empty": 0.25}.get(name, 0.03 * span)
        for moved in (value - step, value + step):
            assert not judged(solved, "gap-8-parameters", parameters=right | {name: moved}).passed
    assert judged(solved, "gap-8-parameters", parameters={}).slip == "names of parameters"
    assert judged(solved, "gap-8-parameters", parameters=list(right.values())).slip == "not a dictionary"


def test_slips_of_the_parameters(solved: Solved) -> None:
    right = {name: float(value) for name, value in solved.variables["parameters"].items()}
    u_offset, y_offset = float(solved.variables["u_offset"]), float(solved.variables["y_offset"])
    offset = u_offset if solved.effect.startswith("input") else y_offset
    wrong: dict[str, dict[str, float]] = {}
    if "delay" in right:
        wrong["samples for seconds"] = {"delay": right["delay"] / 0.75}
    elif "c2" in right:
        wrong["sign"] = {"c2": -right["c2"]}
    elif "empty" in right:
        wrong["distance for level"] = {"empty": y_offset - right["empty"]}
    else:
        wrong["offset left out"] = {name: value - offset for name, value in right.items()}
        wrong["millivolts"] = {name: 1000 * value for name, value in right.items()}
        if abs(u_offset - y_offset) > 0.1:
            wrong["the other offset"] = {
                name: value - offset + u_offset + y_offset - offset for name, value in right.items()
            }
    if "low" in right:
        wrong["low and high swapped"] = {"low": right["high"], "high": right["low"]}
    for slip, parameters in wrong.items():
        verdict = judged(solved, "gap-8-parameters", parameters=parameters)
        assert (verdict.passed, verdict.slip) == (False, slip)


def test_slips_of_the_simulation(solved: Solved) -> None:
    better = solved.variables["simulate_better"]
    of_the_record = better(solved.record.u)
    for slip, wrong in {
        "argument not used": lambda u: of_the_record,
        "another length": lambda u: better(u)[:800],
        "a column beside a flat array": lambda u: better(u).reshape(-1, 1),
        "output offset left out": lambda u: better(u) - solved.variables["y_offset"],
        "no return": lambda u: None,
    }.items():
        verdict = judged(solved, "gap-7-simulation", simulate_better=wrong)
        assert (verdict.passed, verdict.slip) == (False, slip)


def test_a_simulation_that_is_one_sample_late(solved: Solved) -> None:
    """Named, where it does not close most of the gap all the same."""
    better = solved.variables["simulate_better"]
    verdict = judged(solved, "gap-7-simulation", simulate_better=lambda u: better(np.r_[u[0], u[:-1]]))
    assert verdict.passed or verdict.slip == "lag off by one"


def test_a_share_that_only_the_record_shows_does_not_hold(solved: Solved) -> None:
    """A simulation that has the record by heart closes everything on it."""
    by_heart = np.array(solved.record.y)
    verdict = judged(solved, "gap-9-closed", simulate_better=lambda u: by_heart, closed=1.0)
    assert (verdict.passed, verdict.slip) == (False, "does not hold on fresh data")


def test_what_is_carried_forward_never_holds_the_label(solved: Solved) -> None:
    for question in QUESTIONS:
        given = {} if question.gives is None else question.gives(Asked(solved, True))
        assert set(given) <= {
            "u_offset",
            "y_offset",
            "noise_sd",
            "u",
            "y",
            "theta_hat",
            "theta_arx",
            "y_lin",
            "gap_before",
        }


@pytest.fixture(scope="module")
def delayed(tmp_path_factory) -> Solved:
    """A rig, and no work on it."""
    student = "z0"
    path = tmp_path_factory.mktemp("odd") / RECORD_FILE
    path.write_bytes(withheld_record_bytes(student, SECRET))
    record = load_record(path)
    at_rest = record.y[:120]
    variables = {
        "u_offset": record.u[0],
        "y_offset": at_rest.mean(),
        "noise_sd": at_rest.std(),
        "u": record.u - record.u[0],
        "y": record.y - at_rest.mean(),
        "theta_hat": np.array([1.6, -0.64, 0.01, 0.01]),
        "y_lin": 0 * record.y,
        "gap_before": 0.1,
    }
    return Solved(student, withheld_rig(student, SECRET).effect, record, variables)


NAMES = ("u_offset", "y_offset", "noise_sd", "u", "y", "theta_arx", "theta_hat", "y_lin", "gap_before", "share_t")
MORE = ("worst", "share_u", "share_y", "effect", "path", "parameters", "closed")
CALLED = ("time_shares", "band_shares", "cell_shares", "simulate_better", "share_closed")


@pytest.mark.parametrize("question", QUESTIONS, ids=lambda question: question.id)
def test_odd_answers_get_a_reason_and_never_an_exception(question: Question, delayed: Solved) -> None:
    for odd in ODD:
        for origin in (True, False):
            replaced = dict.fromkeys(NAMES + MORE, odd) | dict.fromkeys(CALLED, lambda *_, it=odd: it)
            verdict = question.verdict(Asked(delayed, origin, **replaced))
            assert verdict.reason
            assert not verdict.passed


def test_an_empty_release_fails_kindly(shipped_record_path: Path, run_notebook, capsys) -> None:
    said = run_notebook(NAME, shipped_record_path.parent / RECORD_FILE, release=True)
    printed = capsys.readouterr().out
    assert "First answer steps 8 and 9. Not there yet: effect, path, parameters, closed\n" in printed
    assert "verdict" not in printed  # the program names the effect only after the student has
    assert list(said) == [question.id for question in QUESTIONS]
    for question, text in said.items():
        assert re.match(rf"{question}:", text), text
        assert "Error" not in text


def test_the_notebook_lists_what_a_rig_may_have() -> None:
    path = Path(__file__).resolve().parents[3] / "notebooks" / NAME / f"{NAME}.md"
    text = jupytext.read(path, fmt="md:myst").cells[0].source
    rows = re.findall(r"^\| `(\w+)` \| `([\w-]+)` \| .*? \| ((?:`\w+`(?:, )?)+)", text, re.M)
    assert {effect: path for path, effect, _ in rows} == dict(EFFECT_PATHS)
    assert {effect: tuple(re.findall(r"`(\w+)`", names)) for _, effect, names in rows} == dict(EFFECT_PARAMETERS)


def test_the_program_runs_only_after_the_answer_is_on_record(notebook_cells, monkeypatch, capsys) -> None:
    """The last given cell prints the student's answers to steps 8 and 9 before it calls the program."""
    [source] = [source for words, source in notebook_cells(NAME) if words["grade_id"] == "gap-10-diagnose"]
    printed: list[str] = []

    def stop(_record: object) -> None:
        printed.append(capsys.readouterr().out)
        raise InterruptedError

    monkeypatch.setattr("labsid.gap.diagnosis.diagnose", stop)
    answers = {"effect": "overflow", "path": "dynamics", "parameters": {"level": np.float64(3.21)}}
    exec(source, dict(answers))
    assert printed == []
    assert capsys.readouterr().out == "First answer steps 8 and 9. Not there yet: closed\n"
    with pytest.raises(InterruptedError):
        exec(source, answers | {"closed": 0.9, "record": None})
    assert printed == ["your answer: overflow (dynamics): {'level': 3.21}\n"]
