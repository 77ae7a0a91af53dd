"""Right answers to the lab in styles of one's own, from own names to a single function or class, and slips in them.

``python -P tests/own_styles.py`` prints which other questions each slip costs: none should be lost.
"""

import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

SIMULATE = "scipy.signal.lfilter([0, b1, b2], [1, a1, a2], {})"
FIGURE = (
    "{name}, (a, b) = plt.subplots(2, 1)\n{upper}\na.set(xlabel='Time (s)', ylabel='Output (V)')\na.legend()\n"
    "{lower}\nb.set(xlabel='Time (s)', ylabel='{unit} (V)')\n{more}"
)
FIG_7 = FIGURE.format(
    name="fig_7",
    upper="a.plot(t[h:], {y}[h:], label='Measured')\na.plot(t[h:], y_sim_half, label='Simulated')",
    lower="b.plot(t, {y}, label='Measured')\nb.plot(t, y_sim, label='Simulated')",
    unit="Output",
    more="b.legend()",
)
EXTRACT = (
    'sig = LogData["signals"]\nt = LogData["time"]\ny_act = sig[0]["values"][:, 1]\ny_actm = sig[0]["values"][:, 0]\n'
    'u_act = sig[1]["values"]'
)
LOOP = "def first_period(u):\n    return int(np.flatnonzero(np.diff(u))[0]) + 1\nn_first = first_period(u_act)"


@dataclass(frozen=True)
class Style:
    """Answers to the lab by their cells; those to other cells are the model solution's.

    Slips are replacements of a text in these answers, by the question that they cost.
    """

    cells: Mapping[str, str]
    slips: Mapping[str, tuple[str, str]]

    def with_slip(self, question: str) -> dict[str, str]:
        """The answers with the slip in that question."""
        old, new = self.slips[question]
        changed = {cell: source.replace(old, new) for cell, source in self.cells.items()}
        assert changed != self.cells, question
        return changed


SLIPS = {
    "lab-1a-extract": ('["values"][:, 1]', '["values"][:, 0]'),
    "lab-1a-sampling-time": ("Ts = t[1] - t[0]", "Ts = t[2] - t[0]"),
    "lab-1c-loop": ("np.diff(u))[0]) + 1", "np.diff(u))[0])"),
    "lab-1c-offsets": ("y_act[:n_first].mean()", "y_act.mean()"),
    "lab-2b-theta": ("np.linalg.lstsq(Phi, Y)[0]", "np.linalg.lstsq(Phi[1:], Y[:-1])[0]"),
    "lab-3a-all": ("y_sim = " + SIMULATE.format("{u}"), "y_sim = 1.1 * " + SIMULATE.format("{u}")),
}


def _slips(u: str, **more: tuple[str, str]) -> dict[str, tuple[str, str]]:
    named = {key.replace("_", "-"): pair for key, pair in more.items()}
    return {key: (old.replace("{u}", u), new.replace("{u}", u)) for key, (old, new) in (SLIPS | named).items()}


OWN_NAMES = Style(
    {
        "lab-1a-extract-answer": EXTRACT,
        "lab-1a-sampling-time-answer": "Ts = t[1] - t[0]",
        "lab-1c-loop-answer": LOOP,
        "lab-1c-offsets-answer": (
            "level, start = y_act[:n_first].mean(), u_act[0]\nyd, ud = y_act - level, u_act - start\nh = len(yd) // 2\n"
            "Phi = np.column_stack([yd[1 : h - 1], yd[: h - 2], ud[1 : h - 1], ud[: h - 2]])\nY = yd[2:h]\n"
            "y_offset, u_offset, y, u = level, start, yd, ud"
        ),
        "lab-2a-phi-answer": "half = h",
        "lab-2b-theta-answer": "est = np.linalg.lstsq(Phi, Y)[0]\ntheta_hat = est",
        "lab-2b-parameters-answer": "a1, a2, b1, b2 = -est[0], -est[1], est[2], est[3]",
        "lab-3a-second-half-answer": f"import scipy.signal\ny_sim_half = {SIMULATE.format('ud[h:]')}",
        "lab-3a-all-answer": f"y_sim = {SIMULATE.format('ud')}",
        "lab-3a-mse-answer": "mse_half = np.mean((yd[h:] - y_sim_half) ** 2)\nmse_all = np.mean((yd - y_sim) ** 2)",
        "lab-3a-figure-7-answer": FIG_7.format(y="yd"),
    },
    _slips("ud", lab_2a_phi=("ud[1 : h - 1], ud[: h - 2]])", "ud[2:h], ud[1 : h - 1]])")),
)
EARLY_CELL = Style(
    {
        "lab-1a-extract-answer": "\n".join(
            [
                EXTRACT,
                "Ts = t[1] - t[0]",
                LOOP,
                "y_offset = y_act[:n_first].mean()\nu_offset = u_act[0]\ny = y_act - y_offset\nu = u_act - u_offset",
                "h = len(y) // 2",
                "Phi = np.column_stack([y[1 : h - 1], y[: h - 2], u[1 : h - 1], u[: h - 2]])\nY = y[2:h]",
                "theta_hat = np.linalg.lstsq(Phi, Y)[0]",
                "a1, a2, b1, b2 = -theta_hat[0], -theta_hat[1], theta_hat[2], theta_hat[3]",
                f"import scipy.signal\ny_sim_half = {SIMULATE.format('u[h:]')}\ny_sim = {SIMULATE.format('u')}",
                "mse_half = np.mean((y[h:] - y_sim_half) ** 2)\nmse_all = np.mean((y - y_sim) ** 2)",
            ]
        ),
        **dict.fromkeys(
            (
                f"lab-{step}-answer"
                for step in (
                    "1a-sampling-time", "1c-loop", "1c-offsets", "2b-theta", "2b-parameters", "3a-second-half",
                    "3a-all", "3a-mse",
                )
            ),
            "# see above",
        ),
        "lab-2a-phi-answer": "half = h",
        "lab-3a-figure-7-answer": FIG_7.format(y="y"),
    },
    _slips("u", lab_2a_phi=("u[1 : h - 1], u[: h - 2]])", "u[2:h], u[1 : h - 1]])")),
)  # fmt: skip
IN_A_DICT = Style(
    {
        "lab-1a-extract-answer": EXTRACT,
        "lab-1a-sampling-time-answer": "Ts = t[1] - t[0]",
        "lab-1c-loop-answer": LOOP,
        "lab-1c-offsets-answer": (
            "y_offset, u_offset = y_act[:n_first].mean(), u_act[0]\nd = {}\nd['y'] = y_act - y_offset\n"
            "d['u'] = u_act - u_offset\ny, u = d['y'], d['u']"
        ),
        "lab-2a-phi-answer": (
            "half = h = len(d['y']) // 2\nPhi = np.column_stack([d['y'][1 : h - 1], d['y'][: h - 2], "
            "d['u'][1 : h - 1], d['u'][: h - 2]])\nY = d['y'][2:h]"
        ),
        "lab-2b-theta-answer": "theta_hat = np.linalg.lstsq(Phi, Y)[0]",
        "lab-2b-parameters-answer": "a1, a2, b1, b2 = theta_hat * [-1, -1, 1, 1]",
        "lab-3a-second-half-answer": f"import scipy.signal\ny_sim_half = {SIMULATE.format('''d['u'][h:]''')}",
        "lab-3a-all-answer": f"y_sim = {SIMULATE.format('''d['u']''')}",
        "lab-3a-mse-answer": (
            "mse_half = np.mean((d['y'][h:] - y_sim_half) ** 2)\nmse_all = np.mean((d['y'] - y_sim) ** 2)"
        ),
        "lab-3a-figure-7-answer": FIG_7.format(y="d['y']"),
    },
    _slips("d['u']", lab_2a_phi=("d['u'][1 : h - 1], d['u'][: h - 2]])", "d['u'][2:h], d['u'][1 : h - 1]])")),
)
_ALL = EARLY_CELL.cells["lab-1a-extract-answer"].replace(LOOP, "n_first = first_period(u_act)").split("\n")
_NAMES = "t Ts y_act y_actm u_act n_first y_offset u_offset y u h Phi Y theta_hat a1 a2 b1 b2"
_NAMES += " y_sim_half y_sim mse_half mse_all"
_RESULTS = _NAMES.replace(" ", ", ")
_AS_ATTRIBUTES = [re.sub(rf"(?<![\w.'])({_NAMES.replace(' ', '|')})(?![\w'])", r"self.\1", line) for line in _ALL]


def _at_once(lines: list[str], *around: str) -> dict[str, str]:
    """All code in the first cell: its function, a line before the code, and the lines after it."""
    first, *after = around
    indent = "    " * (1 + first.count("class"))
    inner = [f"{indent}{line}" for line in lines]
    return {
        **EARLY_CELL.cells,
        "lab-1a-extract-answer": "\n".join([*LOOP.split("\n")[:2], *first.split("|"), *inner, *after]),
    }


def _chosen(*questions: str) -> dict[str, tuple[str, str]]:
    return {question: EARLY_CELL.slips[question] for question in questions}


ONE_FUNCTION = Style(_at_once(_ALL, "def main():", f"    return {_RESULTS}", f"{_RESULTS} = main()"), EARLY_CELL.slips)
IN_LOCALS = Style(
    _at_once(_ALL, "def main():", "    return locals()", "globals().update(main())"),
    _chosen("lab-1c-offsets", "lab-2b-theta"),
)
WITH_GLOBALS = Style(_at_once([f"global {_RESULTS}", *_ALL], "def main():", "main()"), _chosen("lab-2a-phi"))
IN_A_CLASS = Style(
    _at_once(
        _AS_ATTRIBUTES,
        "class Lab:|    def run(self):",
        "lab = Lab()\nlab.run()",
        *(f"{name} = lab.{name}" for name in _NAMES.split()),
    ),
    {"lab-1c-offsets": ("self.y_act[:self.n_first].mean()", "self.y_act.mean()")},
)
STARTING_OVER = Style(
    {
        **EARLY_CELL.cells,
        **dict.fromkeys(
            (f"lab-{step}-answer" for step in ("1c-offsets", "2b-theta", "3a-all", "3a-mse")),
            EARLY_CELL.cells["lab-1a-extract-answer"],
        ),
    },
    _chosen("lab-1a-sampling-time", "lab-1c-offsets"),
)
ONE_LOOP = Style(_at_once([*_ALL, "break"], "while True:"), _chosen("lab-2b-theta"))
STYLES = {
    "own names": OWN_NAMES,
    "code in an earlier cell": EARLY_CELL,
    "signals in a dict": IN_A_DICT,
    "one function": ONE_FUNCTION,
    "one function that returns its locals": IN_LOCALS,
    "one function with global names": WITH_GLOBALS,
    "one class": IN_A_CLASS,
    "one loop": ONE_LOOP,
    "every cell starts over from the record": STARTING_OVER,
}


def main() -> None:
    """Print the table."""
    import tempfile

    from course_work import GradeCode, copy_course
    from variants import questions_lost

    from autograder.course.build import build_course
    from autograder.sandbox.isolation import open_launcher

    with tempfile.TemporaryDirectory() as folder, open_launcher("none") as launcher:
        course = copy_course(Path(folder), "lab-identification")
        list(build_course(course))
        grade = GradeCode(course, launcher)
        print("| style | slip in | questions lost besides |\n|---|---|---|")
        for name, style in STYLES.items():
            for question in style.slips:
                lost = questions_lost(grade("lab-identification", style.with_slip(question)))
                print(f"| {name} | {question} | {', '.join(sorted(set(lost) - {question})) or '-'} |", flush=True)


if __name__ == "__main__":
    sys.path[:0] = [str(Path(__file__).resolve().parent), str(Path(__file__).resolve().parent.parent)]
    main()
