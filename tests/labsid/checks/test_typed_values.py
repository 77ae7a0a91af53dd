"""Whether typed-in values are right elsewhere, and what a check says of them."""

import re

import pytest
from one_answer import solve
from record_draws import NOT_OF_THE_RIG, with_record
from tries import ACCEPTED, Try, fault_of, said_to

from labsid.checks import CheckFailed, notebook_checks
from labsid.checks.notebook import NotebookAsk
from labsid.checks.question import FollowsFrom
from labsid.checks.reference_values import find_reference_values
from labsid.checks.typed_values import told, wrong_elsewhere
from labsid.checks.written_values import typed_names
from labsid.records.record import load_record


@pytest.mark.parametrize("name", with_record())
def test_each_typed_in_value_of_the_rig_is_wrong_on_the_public_record(name: str) -> None:
    solved = solve(name)
    assert solved.record is not None
    right = find_reference_values(solved.assignment, solved.record)
    tried = 0
    for question in solved.assignment.questions:
        if question.follows_from is not FollowsFrom.DATA or question.id == "gap-2-linear":
            continue  # of its theta_arx, with which no later step starts, there is no right value
        variables = solved.run(question.id, {})
        ask = NotebookAsk(variables, solved.record, solved.known[question.id], question.id)
        names = set(right.get(question.id, {})) & solved.names_read(question.id) - set(NOT_OF_THE_RIG)
        for one in sorted(names):
            asked = (question, solved.assignment, solved.record, [one], variables, ask.call)
            assert wrong_elsewhere(*asked), (question.id, one)
            tried += 1
        assert not wrong_elsewhere(question, solved.assignment, solved.record, [], variables, ask.call)
    assert tried >= {"step-response": 5, "sim-to-real-gap": 6}.get(name, 8), tried


def test_what_may_be_typed_is_not_tried() -> None:
    solved = solve("lab-identification")
    question = solved.assignment.question("lab-1a-sampling-time")
    variables = {"Ts": 99.0}
    ask = NotebookAsk(variables, solved.record, {}, question.id)
    assert not wrong_elsewhere(question, solved.assignment, solved.record, ["Ts"], variables, ask.call)


def test_what_is_told() -> None:
    assert told(["u"]).reason.startswith("`u` is right on your record, but typed in")
    assert told(["y", "u"]).reason.startswith("`u` and `y` are right")
    assert not told(["u"]).passed


_RUN = "for k in range(2, len(u)):\n    "
_APPENDED = {
    "lab-2a-phi": "half = len(y) // 2\nPhi = []\nY = []\nfor k in range(2, half):\n    Phi.append([y[k-1], y[k-2], "
    "u[k-1], u[k-2]])\n    Y.append(y[k])",
    "lab-3a-all": f"y_sim = [0.0, 0.0]\n{_RUN}y_sim.append(-a1*y_sim[k-1] - a2*y_sim[k-2] + b1*u[k-1] + b2*u[k-2])",
    "postlab-1-phi": "Phi_1 = []\nY_1 = []\nfor k in range(1, half):\n    Phi_1.append((y[k-1], u[k-1]))\n    "
    "Y_1.append(y[k])",
    "step-6-cut": "changes = np.flatnonzero(np.diff(u_act)) + 1\nfirst, second = changes[0], changes[1]\n"
    "t_held = []\ny_held = []\nfor k in range(first, second):\n    t_held.append(t_act[k] - t_act[first])\n"
    "    y_held.append(y_act[k] - np.mean(y_act[first-20:first]))\na_held = u_act[first] - u_act[first - 1]",
}


@pytest.mark.parametrize("question", _APPENDED)
def test_lists_that_a_loop_fills_are_right_and_not_typed_in(question: str) -> None:
    code = _APPENDED[question]
    one = Try(question, "lists", code, "", ACCEPTED)
    solved = solve(next(name for name in with_record() if question in solve(name).known))
    assert fault_of(one, said_to(one, solved)) == ""
    assert typed_names([code], ["Phi", "Y", "y_sim", "Phi_1", "Y_1", "t_held", "y_held"]) == set()


def test_in_a_notebook_the_check_says_what_grading_will_find(tmp_path, monkeypatch, shipped_record_path) -> None:
    from IPython.core.interactiveshell import InteractiveShell

    monkeypatch.chdir(tmp_path)
    (tmp_path / shipped_record_path.name).write_bytes(shipped_record_path.read_bytes())
    shell = InteractiveShell()
    shell.run_cell("import numpy as np\nfrom labsid.checks import notebook_checks\nfrom labsid import load_record")
    shell.run_cell("check = notebook_checks('lab-identification', globals())")
    assert isinstance(shell.user_ns["check"], notebook_checks)
    shell.run_cell(
        f"r = load_record('{shipped_record_path.name}')\n"
        "t, y_act, y_actm, u_act = r.t, r.y_noise_reduced, r.y_measured, r.u\nTs = 0.75"
    )
    shell.run_cell("check('lab-1a-extract'); check('lab-1a-sampling-time')", silent=False).raise_error()
    shell.run_cell("n = int(np.argmax(u_act != u_act[0]))\ny_offset = np.mean(y_act[:n])\nu_offset = 2.0")
    shell.run_cell("y, u = y_act - y_offset, u_act - u_offset")
    failed = shell.run_cell("check('lab-1c-offsets')").error_in_exec
    assert isinstance(failed, CheckFailed)
    assert re.search("`u_offset` is right on your record, but typed in", str(failed))
    shell.run_cell("u_offset = u_act[0]\ny, u = [], u_act - u_offset")
    shell.run_cell("for one in y_act:\n    y.append(one - y_offset)")
    shell.run_cell("check('lab-1c-offsets')").raise_error()


def test_a_wrong_number_that_is_typed_in_is_told_as_such(tmp_path, monkeypatch, shipped_record_path) -> None:
    from IPython.core.interactiveshell import InteractiveShell

    monkeypatch.chdir(tmp_path)
    (tmp_path / shipped_record_path.name).write_bytes(shipped_record_path.read_bytes())
    shell = InteractiveShell()
    shell.run_cell("import numpy as np\nfrom labsid.checks import notebook_checks\nfrom labsid import load_record")
    shell.run_cell("check = notebook_checks('lab-identification', globals())")
    shell.run_cell(
        f"r = load_record('{shipped_record_path.name}')\n"
        "t, y_act, y_actm, u_act = r.t, r.y_noise_reduced, r.y_measured, r.u\nTs = 0.75"
    )
    shell.run_cell("check('lab-1a-extract'); check('lab-1a-sampling-time')").raise_error()
    shell.run_cell("u_offset = u_act[0]\nu = u_act - u_offset")

    def said(code: str) -> str:
        shell.run_cell(code + "\ny = y_act - y_offset")
        return str(shell.run_cell("check('lab-1c-offsets')").error_in_exec)

    typed = "`y_offset` is typed in, and computed by no code"
    assert typed in said("y_offset = 1.234")
    assert typed not in said("y_offset = np.median(y_act) + 0.01")  # wrong, too, and computed
    known = said(f"y_offset = {load_record(shipped_record_path).y_noise_reduced.mean()!r}")
    assert typed not in known  # typed in, but of a cause that is known
    assert "y_offset" in known
