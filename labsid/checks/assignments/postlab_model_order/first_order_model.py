"""The post-lab: a first-order model beside the second-order one, and which to take."""

import re
from collections.abc import Iterator
from decimal import Decimal
from functools import partial

import numpy as np
from scipy.signal import cont2discrete, lfilter

from labsid._arrays import FloatArray
from labsid.checks.assignments.lab_identification.lab_data import LabData, known_vector, measured_output, units_of
from labsid.checks.assignments.lab_identification.offset_step import OFFSET_TOLERANCE
from labsid.checks.assignments.lab_identification.part_2 import judge_transfer_function
from labsid.checks.assignments.lab_identification.phi_and_theta import judge_equations, judge_theta, right_equations
from labsid.checks.assignments.lab_identification.signal_panels import Panel, require_panels
from labsid.checks.assignments.lab_identification.simulated_output import SAME, judge_entire_run, judge_mse, read_output
from labsid.checks.assignments.postlab_model_order.order_fits import judge_fit_order, judge_second_order
from labsid.checks.compare import as_number, as_vector
from labsid.checks.compare_systems import SystemValue
from labsid.checks.double_mistakes import Edit
from labsid.checks.question import Ask
from labsid.checks.values import TransferFunctionValue, Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, first_failure
from labsid.lab.arx import ArxModel, arx_from_theta, fit_arx
from labsid.lab.offset import find_offsets
from labsid.lab.simulation import simulate
from labsid.lab.verification import mse
from labsid.least_squares.solve import solve_least_squares

NAMES = ("Phi_1", "Y_1")
CALLS = ("actual|measured|record", "first|1st|order[ =]*1", "second|2nd|order[ =]*2")

THREE_DIGITS = 0.0055
"""Largest share by which a number that is rounded to three significant digits differs."""
_NUMBER = re.compile(r"\d+\.?\d*(?:e[-+]?\d+)?", re.IGNORECASE)
_POWER = re.compile(r"\s*(?:×|x|\*|·|\\times|\\cdot)\s*10\s*(?:\^|\*\*)?\s*\{?([-−]?\d+)\}?")
_NAME = "first|1st|one|second|2nd|two"
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")


def _data(ask: Ask) -> LabData:
    """The record without its offsets, with the output offset of the notebook where that is a possible one.

    The notebook's given cell removes the offsets. It need not settle on the very samples that the reference does, and a
    student may bring the offset of the lab along; both are constants near the reference's.
    """
    record = ask.record
    offsets = find_offsets(record.u, record.y)
    y_offset = offsets.y_offset
    try:
        removed = record.y - as_vector("y", ask.value("y"), record.y.size)
    except NoAnswer:
        removed = np.full(record.y.size, y_offset)
    if np.ptp(removed) < 1e-9 and abs(removed[0] - y_offset) <= OFFSET_TOLERANCE * np.ptp(record.y):
        y_offset = float(removed[0])
    return LabData(record.u, record.y, measured_output(record), offsets.u_offset, y_offset, record.Ts)


def check_phi(ask: Ask) -> Verdict:
    """Step 1: Phi_1 and Y_1."""
    return judge_equations(ask, NAMES, _data(ask), 1)


def right_phi(ask: Ask) -> dict[str, Value]:
    """Step 1."""
    return right_equations(NAMES, _data(ask), 1)


def _equations(ask: Ask) -> tuple[FloatArray, FloatArray]:
    return np.asarray(ask.known("Phi_1"), float).reshape(-1, 2), known_vector(ask, "Y_1")


def check_theta(ask: Ask) -> Verdict:
    """Step 1: theta_1."""
    return judge_theta(ask, "theta_1", *_equations(ask), _data(ask), 1)


def right_theta(ask: Ask) -> dict[str, Value]:
    """Step 1."""
    return {"theta_1": solve_least_squares(*_equations(ask)).theta}


def check_transfer_function(ask: Ask) -> Verdict:
    """Step 1: G_1."""
    model = _model(ask, "theta_1")
    return judge_transfer_function("G_1", ask.value("G_1"), model, "G_1(z) in step 1", _other_rules("G_1", model))


def _other_rules(name: str, model: ArxModel) -> Iterator[Slip[SystemValue]]:
    """A first-order model that goes through K/(tau s + 1), and back by another rule than with a held input."""
    if not -1 < model.a[1] < 0:
        return
    tau, K = -model.Ts / np.log(-model.a[1]), model.b[0] / (1 + model.a[1])
    for rule, share in (("Tustin's rule", 0.5), ("forward differences", 0.0), ("backward differences", 1.0)):
        num, den, _ = cont2discrete(([K], [tau, 1.0]), model.Ts, "gbt", share)
        yield Slip(
            "continuous model made discrete by another rule",
            f"`{name}` is K/(tau s + 1) made discrete by {rule}. theta holds the coefficients of the discrete model "
            "already, in the difference equation: no continuous model is needed.",
            partial(TransferFunctionValue, num.ravel(), den, model.Ts),
        )


def right_transfer_function(ask: Ask) -> dict[str, Value]:
    """Step 1."""
    model = _model(ask, "theta_1")
    return {"G_1": TransferFunctionValue(model.b, model.a, model.Ts)}


def check_fit_order(ask: Ask) -> Verdict:
    """Step 2: the function, on data that it has not seen, and the second-order fit that it made."""
    data = _data(ask)
    verdict = judge_fit_order(ask, data)
    if not verdict.passed:
        return verdict
    second = judge_second_order(ask.value("theta_2"), data)
    return verdict if second.passed else second


def right_second_order(ask: Ask) -> dict[str, Value]:
    """Step 2."""
    data = _data(ask)
    return {"theta_2": fit_arx(data.u, data.y, data.Ts, 2, stop=data.half).model.theta}


def _model(ask: Ask, name: str) -> ArxModel:
    return arx_from_theta(known_vector(ask, name), ask.record.Ts)


def check_simulations(ask: Ask) -> Verdict:
    """Step 2: both free runs over the entire input."""
    data = _data(ask)
    first, second = (_model(ask, name) for name in ("theta_1", "theta_2"))
    got = [read_output(name, ask.value(name)) for name in ("y_sim_1", "y_sim_2")]
    if SAME(got[0], simulate(second, data.u)) and SAME(got[1], simulate(first, data.u)):
        return Verdict(False, "`y_sim_1` and `y_sim_2` are swapped.", "models swapped")
    second_for_first = (
        "`y_sim_1` is the run of the second-order model: the first-order one has the parameters of `theta_1`."
    )
    mixed = Slip("models swapped", second_for_first, lambda: simulate(second, data.u))
    verdict = judge_entire_run(ask, "y_sim_1", data, first, [mixed])
    if not verdict.passed:
        return verdict
    verdict = judge_entire_run(ask, "y_sim_2", data, second, _of_theta_2(known_vector(ask, "theta_2"), first, data.u))
    return Verdict(True, "Two free runs over the entire input.") if verdict.passed else verdict


def _of_theta_2(theta: FloatArray, first: ArxModel, u: FloatArray) -> Iterator[Slip[FloatArray]]:
    """Mistakes with `theta_2`: the model of order 1 again, or its entries in another order."""
    again = "`y_sim_2` is `y_sim_1` again: the second-order model has the parameters of `theta_2`."
    yield Slip("models swapped", again, lambda: simulate(first, u))
    for order, what in (((0, 2, 1, 3), "-a1, b1, -a2, b2"), ((2, 3, 0, 1), "b1, b2, -a1, -a2")):
        hint = f"`y_sim_2` takes the entries of `theta_2` for {what}: they are -a1, -a2, b1, b2."
        a1, a2, b1, b2 = theta[np.argsort(order)]
        yield Slip("order of theta", hint, partial(lfilter, [0.0, b1, b2], [1.0, -a1, -a2], u))


def right_simulations(ask: Ask) -> dict[str, Value]:
    """Step 2."""
    u = _data(ask).u
    return {f"y_sim_{n}": simulate(_model(ask, f"theta_{n}"), u) for n in (1, 2)}


@first_failure
def check_errors(ask: Ask) -> Iterator[Verdict]:
    """Step 3: both mean squared errors."""
    got = [as_number(name, ask.value(name)) for name in ("mse_1", "mse_2")]
    right = [float(np.asarray(value)) for value in right_errors(ask).values()]
    if np.allclose(got, right[::-1], rtol=1e-6, atol=0) and not np.allclose(got, right, rtol=1e-6, atol=0):
        yield Verdict(False, "`mse_1` and `mse_2` are swapped.", "errors swapped")
    data = _data(ask)
    runs = {n: known_vector(ask, f"y_sim_{n}") for n in (1, 2)}
    for n, other_order in ((1, 2), (2, 1)):
        name = f"mse_{n}"
        offset = f"`{name}` compares with `y_act`, which contains the offset: compare with `y`."
        mixed = f"`{name}` is the error of `y_sim_{other_order}`: use `y_sim_{n}`."
        slips = (
            Slip("offset left in", offset, partial(mse, data.y_act, runs[n])),
            Slip("models swapped", mixed, partial(mse, data.y, runs[other_order])),
            Slip(
                "measured output left out",
                f"`{name}` is the mean squared difference of the two simulations: compare `y_sim_{n}` with `y`, the "
                "measured output.",
                partial(mse, runs[1], runs[2]),
            ),
        )
        others = (
            Edit("e", data.y - runs[other_order], f"`y_sim_{other_order}` is taken for `y_sim_{n}`"),
            Edit("e", data.y_act - runs[n], "`y_act`, with the offset, is taken for `y`"),
            Edit("e", runs[1] - runs[2], "the two simulations are compared with each other"),
        )
        yield judge_mse(name, got[n - 1], data.y, runs[n], slips, others)


def right_errors(ask: Ask) -> dict[str, Value]:
    """Step 3."""
    y = _data(ask).y
    return {f"mse_{n}": mse(y, known_vector(ask, f"y_sim_{n}")) for n in (1, 2)}


def check_figure_8(ask: Ask) -> Verdict:
    """Step 3: Fig. 8, with both errors written into it."""
    signals = {"y": _data(ask).y} | {name: known_vector(ask, name) for name in ("y_sim_1", "y_sim_2")}
    panel = Panel("Fig. 8", signals, (ask.record.t,), CALLS, units_of(ask.record)[1])
    (axes,) = require_panels("fig_8", ask.value("fig_8"), (panel,))
    first, second = (as_number(name, ask.known(name)) for name in ("mse_1", "mse_2"))
    texts = [*axes.texts, *axes.legend, axes.title]
    found_numbers = [number for text in texts for line in text.splitlines() for number in _numbers(line)]
    for name, wanted, other_error in (("first", first, second), ("second", second, first)):
        if not any(_is_near(float(number), wanted) for number in found_numbers):
            unexplained = [number for number in found_numbers if not _is_near(float(number), other_error)]
            return Verdict(False, *_missing(name, wanted, unexplained, axes.texts))
    for text in texts:
        names, errors = _names_and_errors(text, first, second)
        if len(names) == len(errors) > 0 and names != errors:
            return Verdict(False, "The mean squared errors in Fig. 8 are swapped.", "errors swapped")
    if {1, 2} - {name for text in texts for name in _explained(text, first, second)}:
        return Verdict(
            False,
            "Fig. 8 does not say which mean squared error is that of which model: name the order beside each number.",
            "errors without names",
        )
    return Verdict(True, "Fig. 8 shows both models and their errors.")


def _is_rounded(number: str, value: float) -> bool:
    """Whether a written number is a value with fewer digits, rounded or cut off; zeros at its end are digits."""
    exponent = Decimal(number).as_tuple().exponent
    return isinstance(exponent, int) and abs(float(number) - value) <= 10.0**exponent


def _has_too_few(text: str, value: float) -> bool:
    """Whether a text is a value rounded to decimals that leave it one digit or none."""
    decimals = len(text.partition(".")[2]) if "e" not in text.lower() else 0
    return decimals > 0 and f"{value:.{decimals}f}" == text and value < 5 * 10.0**-decimals


def _missing(name: str, wanted: float, numbers: list[str], texts: tuple[str, ...]) -> tuple[str, str]:
    if not numbers and not texts:
        return ("Fig. 8 has no text yet: write both mean squared errors into it.", "no errors in the figure")
    if any(re.search(r"\{\w*mse", text) for text in texts):
        return (
            'In Fig. 8 stands the name in braces and not its value: an `f` before the quotes, f"...", puts values in.',
            "name in place of its value",
        )
    roots = [number for number in numbers if _is_near(float(number), float(np.sqrt(wanted)))]
    if roots:
        return (
            f"In Fig. 8 stands the root of the {name}-order model's mean squared error.",
            "root of the mean squared error",
        )
    few = next((text for text in _NUMBER.findall(" ".join(map(_plain, texts))) if _has_too_few(text, wanted)), "")
    if few:
        return (
            f"In Fig. 8 the {name}-order model's mean squared error stands as {few}, which leaves no digits of so "
            "small a number. Give three significant digits, as `:.3g` does, or `:.2e`.",
            "too few digits",
        )
    near = [number for number in numbers if abs(float(number) - wanted) <= 0.5 * wanted]
    if near and not any(_is_rounded(number, wanted) for number in near):
        return (
            f"The number {near[0]} in Fig. 8 is not the {name}-order model's mean squared error: let the code write "
            "the value of your variable, in braces after an `f`.",
            "another number in the figure",
        )
    if near:
        return (
            f"The {name}-order model's error in Fig. 8 is not exact enough: give three significant digits.",
            "too few digits",
        )
    return f"The mean squared error of the {name}-order model is not in Fig. 8.", "no errors in the figure"


def _names_and_errors(text: str, first: float, second: float) -> tuple[list[int], list[int]]:
    """The models that a text names, and those whose errors it gives, each in the order of its first appearance."""
    names: list[int] = []
    errors: list[int] = []
    for token in re.findall(rf"{_NAME}|{_NUMBER.pattern}", _plain(text), re.IGNORECASE):
        if re.fullmatch(_NAME, token, re.IGNORECASE):
            names.append(1 if token.lower() in ("first", "1st", "one") else 2)
            continue
        number = float(token)
        nearest = 1 if abs(number - first) <= abs(number - second) else 2
        if _is_near(number, (first, second)[nearest - 1]):
            errors.append(nearest)
        elif number in (1, 2):
            names.append(int(number))
    return list(dict.fromkeys(names)), list(dict.fromkeys(errors))


def _explained(text: str, first: float, second: float) -> list[int]:
    """The models whose errors a text gives together with their name."""
    names, errors = _names_and_errors(text, first, second)
    return [n for n in errors if n in names]


def _numbers(line: str) -> list[str]:
    """The numbers in a text, with powers of ten however they are written, as in 1.50e-3."""
    return _NUMBER.findall(_plain(line))


def _plain(text: str) -> str:
    """A text without its units, with powers of ten as in 1e-3."""
    plain = re.sub(r"[$]", "", text.translate(_SUPERSCRIPTS))
    plain = re.sub(r"(?:\\mathrm\{)?\bV\}?\s*(?:\^|\*\*)?\s*\{?2\}?", "", plain)
    return _POWER.sub(lambda found: "e" + found[1].replace("−", "-"), plain).replace("−", "-")


def _is_near(number: float, wanted: float) -> bool:
    return abs(number - wanted) <= THREE_DIGITS * wanted
