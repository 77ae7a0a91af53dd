"""One slip costs one question: what follows from it is judged on the student's own values, or on right ones."""

import re
from collections.abc import Mapping

import pytest
from course_work import GradeCode
from own_styles import STYLES as OWN_STYLES
from representatives import mostly_exhaustive
from variants import define, questions_lost

from autograder.course.layout import Course, read_template
from labsid.checks.notebook import load_assignment

Cells = Mapping[str, str]


def answers(**cells: str) -> Cells:
    """Answers by their questions, with ``_`` for ``-``."""
    return {f"{question.replace('_', '-')}-answer": source for question, source in cells.items()}


RLS_STEP = define(
    "rls_step(theta, P, phi, y)",
    "P = P - np.outer(P @ phi, P @ phi) / (phi @ P @ phi)\nreturn theta + P @ phi * (y - phi @ theta), P",
)
RUNS = "theta_1, theta_099 = rls(Phi_61, Y_61, 1.0, 1e6), rls(Phi_61, Y_61, 0.99, 1e6)\n"
RECURSIVE = answers(
    ri_5_forgetting=define(
        "rls(Phi, Y, lam, LN)",
        "theta, P, history = np.zeros(Phi.shape[1]), LN * np.eye(Phi.shape[1]), []\nfor phi, y in zip(Phi, Y):\n"
        "    theta, P = rls_step(theta, P / lam, phi, y)\n    history.append(theta)\nreturn np.array(history)",
    )
    + RUNS,
    ri_7_online=define(
        "arx_step(theta, P, past, u, y, lam)",
        "theta, P = rls_step(theta, P / lam, past, y)\nreturn theta, P, np.array([-y, past[0], u])",
    ),
    ri_9_windup=define(
        "rls_bounded(Phi, Y, lam, LN, bound)",
        "theta, P = np.zeros(Phi.shape[1]), LN * np.eye(Phi.shape[1])\nhistory, traces = [], []\n"
        "for phi, y in zip(Phi, Y):\n    now = 1.0 if np.trace(P) / lam > bound else lam\n"
        "    theta, P = rls_step(theta, P / now, phi, y)\n    history.append(theta)\n    traces.append(np.trace(P))\n"
        "return np.array(history), np.array(traces)",
    ),
)
APPENDIX = answers(
    step_8_loss=define("loss(Phi, Y, theta)", "return np.sum(error_vector(Phi, Y, theta) ** 2) / 2"),
    step_8_gradient=define("gradient(Phi, Y, theta)", "return -Phi.T @ error_vector(Phi, Y, theta)"),
)
ROW = answers(
    prelab_1_time="t = np.linspace(0, 100, 1001).reshape(1, -1)",
    prelab_3_cut="t_new, y1_new, y2_new = t[:, 200:] - t[0, 200], y1[:, 200:], y2[:, 200:]",
    prelab_4_matrix="data_new = np.vstack([t_new, y1_new, y2_new]).T",
)
CALLS = r"\(This calls your `{}`, which is wrong: it was judged with a right one in its place\.\)$"
RIGHT_THETA = r"\(Judged on the right values of lab-2b-theta\.\)$"


@pytest.mark.parametrize(
    ("assignment", "cells", "lost", "said"),
    [
        pytest.param(
            "recursive-identification",
            RECURSIVE | answers(ri_3_step=RLS_STEP),
            {"ri-3-step"},
            {name: CALLS.format("rls_step") for name in ("ri-5-forgetting", "ri-7-online", "ri-9-windup")}
            | {"ri-6-figures": r"\(This depends on your `rls_step`"},
            id="a function that three others call",
        ),
        pytest.param(
            "recursive-identification",
            RECURSIVE
            | answers(ri_3_step="", ri_7_online=RECURSIVE["ri-7-online-answer"].replace("-y, past", "y, past")),
            {"ri-3-step", "ri-7-online"},
            {"ri-7-online": r"^Judged with a right `rls_step` in place of yours: `arx_step` remembers \+y"},
            id="a missing function, and a slip in one that calls it",
        ),
        pytest.param(
            "recursive-identification",
            answers(
                ri_7_online=define(
                    "arx_step(theta, P, past, u, y, lam)",
                    "P = inv(lam * inv(P) + np.outer(past, past))\nreturn theta + P @ past * (y - past @ theta), P, "
                    "np.array([-y, past[0], u])",
                )
            ),
            set(),
            {},
            id="a name that a demonstration defines",
        ),
        pytest.param(
            "least-squares",
            answers(
                ls_2_delays=define(
                    "delayed_inputs(u, n)",
                    "return scipy.linalg.toeplitz(u, np.zeros(n)) + 0 * bowl[0, 0]",
                ).replace("def", "import scipy.linalg\ndef")
            ),
            set(),
            {},
            id="a value that a demonstration computes",
        ),
        pytest.param(
            "step-response",
            APPENDIX | answers(step_8_error=define("error_vector(Phi, Y, theta)", "return Phi @ theta")),
            {"step-8-error"},
            {name: CALLS.format("error_vector") for name in ("step-8-loss", "step-8-gradient")},
            id="the error vector",
        ),
        pytest.param(
            "step-response",
            answers(
                step_2_response=define("first_order_response(t, K, tau, td, amplitude)", "return K * amplitude * t"),
                step_5_function=define("read_step(t, y, amplitude)", "return 1.0, 2.0, 3.0"),
            ),
            {"step-2-response", "step-5-function"},
            {},
            id="the reading and the response of a step",
        ),
        pytest.param(
            "model-structures",
            answers(
                ms_4_equations=define("equations(u, y, na, nb, d)", "return np.eye(3), np.ones(3)"),
                ms_5_example_3_1=define("example_3_1(u, y)", "return np.linalg.lstsq(*equations(u, y, 1, 1, 1))[0]")
                + "theta_1, theta_2 = example_3_1(u_1, y_1), example_3_1(u_2, y_2)",
            ),
            {"ms-4-equations"},
            {"ms-5-example-3-1": CALLS.format("equations")},
            id="the equations",
        ),
        pytest.param(
            "prelab-sinusoids",
            answers(prelab_3_cut="t_new = t[200:]\nt_new -= 20\ny1_new, y2_new = y1[200:], y2[200:]"),
            {"prelab-3-cut"},
            {"prelab-3-cut": "^`t` itself has changed"},
            id="a view changed in place",
        ),
        pytest.param("prelab-sinusoids", ROW, {"prelab-1-time"}, {}, id="rows in place of columns, from the start"),
        pytest.param(
            "lab-identification",
            answers(
                lab_2b_theta="theta_hat = np.linalg.lstsq(Phi, Y)[0] * [-1, -1, 1, 1]",
                lab_2b_parameters="a1, a2, b1, b2 = theta_hat",
            ),
            {"lab-2b-theta"},
            {"lab-2b-parameters": r"^(?!.*\(Judged)"},
            id="the signs turned too early",
        ),
        pytest.param(
            "lab-identification",
            answers(
                lab_2b_theta="theta_hat = np.linalg.lstsq(Phi, Y)",
                lab_2b_parameters="a1, a2 = -theta_hat[0][:2]\nb1, b2 = theta_hat[0][2:]",
            ),
            {"lab-2b-theta"},
            {"lab-2b-parameters": r"^(?!.*\(Judged)"},
            id="all of lstsq",
        ),
        pytest.param(
            "lab-identification",
            answers(lab_2b_theta="theta_hat = np.linalg.lstsq(Phi, Y)[0].reshape(1, -1)"),
            {"lab-2b-theta"},
            {"lab-2b-parameters": RIGHT_THETA, "lab-3a-all": RIGHT_THETA},
            id="a row, in which later steps cannot be right",
        ),
        pytest.param(
            "lab-identification",
            answers(
                lab_2b_theta="theta_hat = np.array([1.0, -0.2, 0.01, 0.02])",
                lab_2b_parameters="a1, a2, b1, b2 = -1.0, 0.2, 0.01, 0.02",
            ),
            {"lab-2b-theta", "lab-2b-parameters"},
            {"lab-2b-parameters": "^Judged on the right values of lab-2b-theta: "},
            id="numbers of one's own choosing, and what follows from them",
        ),
        pytest.param(
            "lab-identification",
            answers(lab_2b_theta="theta_hat = np.zeros(4)", lab_2b_parameters="a1 = a2 = b1 = b2 = 0.0"),
            {"lab-2b-theta", "lab-2b-parameters"},
            {"lab-2b-parameters": "^Judged on the right values of lab-2b-theta: "},
            id="zeros, after which everything is zero",
        ),
        pytest.param(
            "sim-to-real-gap",
            answers(
                gap_2_linear="Phi = np.column_stack([y[1 : half - 1], y[: half - 2], u[1 : half - 1], u[: half - 2]])\n"
                "theta_arx = np.linalg.lstsq(Phi, y[2:half])[0]\ntheta_hat = theta_arx * [1, 1, 20, 20]\n"
                "y_lin = free_run(theta_hat, u)",
                gap_7_simulation=define(
                    "simulate_better(u_act)", "return y_offset + free_run(theta_arx, u_act - u_offset)"
                ),
                gap_8_effect='effect = ""',
            ),
            {"gap-2-linear", "gap-7-simulation", "gap-8-effect", "gap-8-path", "gap-8-parameters", "gap-9-closed"},
            {},
            id="a bad model that any other one is better than",
        ),
    ],
)
def test_one_slip_costs_one_question(
    assignment: str, cells: Cells, lost: set[str], said: Mapping[str, str], grade_code: GradeCode
) -> None:
    results = grade_code(assignment, cells)
    assert set(questions_lost(results)) == lost, questions_lost(results)
    for question, pattern in said.items():
        assert re.search(pattern, results[question].reason), results[question].reason


SIMULATED = "scipy.signal.lfilter([0, b1, b2], [1, a1, a2], {}[:, 0]).reshape(-1, 1)"
LAB_IN_COLUMNS = answers(
    lab_1a_extract='t = LogData["time"].reshape(-1, 1)\ny_act = LogData["signals"][0]["values"][:, 1:]\n'
    'y_actm = LogData["signals"][0]["values"][:, :1]\nu_act = LogData["signals"][1]["values"].reshape(-1, 1)',
    lab_1a_sampling_time="Ts = t[1, 0] - t[0, 0]",
    lab_1c_loop=define("first_period(u)", "return int(np.flatnonzero(np.diff(u.ravel()))[0]) + 1")
    + "n_first = first_period(u_act)",
    lab_1c_offsets="y_offset, u_offset = y_act[:n_first, 0].mean(), u_act[0, 0]\n"
    "y, u = y_act - y_offset, u_act - u_offset",
    lab_2a_phi="half = len(y) // 2\nPhi = np.hstack([y[1 : half - 1], y[: half - 2], u[1 : half - 1], u[: half - 2]])\n"
    "Y = y[2:half]",
    lab_2b_theta="theta_hat = np.linalg.inv(Phi.T @ Phi) @ Phi.T @ Y",
    lab_2b_parameters="a1, a2, b1, b2 = -theta_hat[0, 0], -theta_hat[1, 0], theta_hat[2, 0], theta_hat[3, 0]",
    lab_3a_second_half=f"import scipy.signal\ny_sim_half = {SIMULATED.format('u[half:]')}",
    lab_3a_all=f"import scipy.signal\ny_sim = {SIMULATED.format('u')}",
)
LAB_SLIPS = {
    "lab-1a-extract": 't = np.arange(len(LogData["time"])).reshape(-1, 1)'
    + LAB_IN_COLUMNS["lab-1a-extract-answer"][len('t = LogData["time"].reshape(-1, 1)') :],
    "lab-1c-offsets": "y_offset, u_offset = y_act[:n_first, 0].mean(), u_act[0, 0]\ny, u = y_act - y_offset, u_act",
    "lab-3a-all": "y_sim = y",
}
STYLES = {
    "prelab-sinusoids": {},
    "lab-identification": LAB_IN_COLUMNS,
    "postlab-model-order": {},
    "recursive-identification": RECURSIVE,
    "step-response": APPENDIX,
}


@pytest.mark.parametrize("name", mostly_exhaustive(STYLES, ["prelab-sinusoids", "recursive-identification"]))
def test_a_blank_answer_costs_its_question(name: str, course: Course, grade_code: GradeCode) -> None:
    """In a style of its own, each question left as it was released."""
    released = {cell.id: cell.source for cell in read_template(course, name).cells if cell.kind == "answer"}
    lost = {
        question.id: questions_lost(grade_code(name, STYLES[name] | {key: released[key]}))
        for question in load_assignment(name).questions
        for key in [f"{question.id}-answer"]
    }
    spoiled = {question: others for question, others in lost.items() if set(others) != {question}}
    assert spoiled == {}


@pytest.mark.parametrize("question", LAB_SLIPS)
def test_a_slip_in_columns_costs_its_question(question: str, grade_code: GradeCode) -> None:
    results = grade_code("lab-identification", LAB_IN_COLUMNS | {f"{question}-answer": LAB_SLIPS[question]})
    assert set(questions_lost(results)) == {question}, questions_lost(results)


@pytest.mark.parametrize(
    ("name", "question"),
    [
        pytest.param(name, question, marks=[] if number == 1 else [pytest.mark.exhaustive])
        for name, style in OWN_STYLES.items()
        for number, question in enumerate((None, *sorted(style.slips, reverse=True)))
    ],
)
def test_a_slip_in_a_style_of_ones_own_costs_its_question(
    name: str, question: str | None, grade_code: GradeCode
) -> None:
    """With own names, all code in an earlier cell, a function or a class, or signals in a dict; the rest is right."""
    style = OWN_STYLES[name]
    results = grade_code("lab-identification", style.cells if question is None else style.with_slip(question))
    assert set(questions_lost(results)) == {question} - {None}, questions_lost(results)


def test_what_follows_from_a_wrong_value_of_ones_own_is_noted(grade_code: GradeCode) -> None:
    wrong = answers(
        lab_2b_theta="theta_hat = np.array([1.0, -0.2, 0.01, 0.02])",
        lab_2b_parameters="a1, a2, b1, b2 = -1.0, 0.2, 0.01, 0.02",
    )
    results = grade_code("lab-identification", wrong)
    assert {question for question, result in results.items() if result.consistent} == {"lab-2b-parameters"}
