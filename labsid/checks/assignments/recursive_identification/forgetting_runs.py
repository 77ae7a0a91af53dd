"""Checks of the lecture's middle: Example 6-1, its regressors, RLS with a forgetting factor, Fig. 9 and 10."""

from collections.abc import Iterator, Mapping
from functools import cache, partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.assignments.recursive_identification.reference_runs import (
    faulty_run,
    is_one_array,
    reference_run,
    reference_step,
    run_with,
    slips_of_update,
)
from labsid.checks.compare import SAME, as_figure, as_history, as_matrix, as_vector, close
from labsid.checks.figures import find_curve, legend_text, no_curve, plain_text, require_label, require_legend
from labsid.checks.question import Ask, returned, returned_parts
from labsid.checks.regressions import beside_right_rows
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, first_failure, judge
from labsid.model_structures.lecture_systems import ChangingRecord, example_6_1
from labsid.model_structures.structures import Structure, build_equations
from labsid.plots.figure_values import AxesValue, CurveValue, FigureValue

SEED_OF_THE_RECORD = 69
LN = 1e6
SETTLED = 20
"""From this row on no trace is left of the start, whatever large number it was made with."""
_LATEST_START = 5
_STRUCTURE = Structure(2, 1)
_NAMES = ("a1", "a2", "b1")
_QUOTED = ("Phi of `regressors`", "Y")


@cache
def lecture_record() -> ChangingRecord:
    """The record of Example 6-1 that the notebook makes."""
    return example_6_1(np.random.default_rng(SEED_OF_THE_RECORD))


@first_failure
def check_regressors(ask: Ask) -> Iterator[Verdict]:
    """`regressors(u, y)`, then what it gives for the record of Example 6-1."""
    for n in (12, int(ask.rng.integers(14, 20))):
        yield _rows(ask.rng.uniform(1, 3, n) * ask.rng.choice([-1, 1], n), ask.rng.uniform(1, 4, n), ask)
    record = lecture_record()
    Phi, Y = as_matrix("Phi_61", ask.value("Phi_61"), (None, 3)), as_vector("Y_61", ask.value("Y_61"))
    start = record.y.size - Y.size
    same = close(1e-9)
    if not 0 <= start <= _LATEST_START or not (
        same(Phi, build_equations(_STRUCTURE, record.u, record.y, start=start).Phi) and same(Y, record.y[start:])
    ):
        yield Verdict(False, "the function is right, `Phi_61` or `Y_61` is not: leave the last line as it was given.")
    yield Verdict(True, "a row for each sample, with the past in the order of theta = [a1, a2, b1].")


def _rows_held(Phi: FloatArray, u: FloatArray, y: FloatArray) -> range | None:
    """The samples t of the rows of Phi, where all of them are right."""
    rows = build_equations(_STRUCTURE, u, y, start=0).Phi
    for start in range(y.size - len(Phi) + 1):
        if SAME(Phi, rows[start : start + len(Phi)]):
            return range(start, start + len(Phi))
    return None


def _rows_left_out(held: range, n: int) -> str:
    """Which rows are missing at the start or at the end, of n samples; empty if none is."""
    said = []
    if held.start > _LATEST_START:
        said.append(
            f"begins with the row of y[{held.start}]: the row of y[2], the third sample, is the first whose past is "
            "in the record"
        )
    if held.stop < n:
        last = "the last is" if held.stop == n - 1 else f"the last {n - held.stop} are"
        said.append(f"ends with the row of y[{held.stop - 1}] where y has {n} samples: {last} missing, in Phi and in Y")
    return f"`regressors` {', and '.join(said)}." if said else ""


def right_regressors(_: Ask) -> dict[str, Value]:
    """The rows of Example 6-1."""
    equations = build_equations(_STRUCTURE, lecture_record().u, lecture_record().y)
    return {"Phi_61": equations.Phi, "Y_61": equations.Y}


@first_failure
def _rows(u: FloatArray, y: FloatArray, ask: Ask) -> Iterator[Verdict]:
    n = y.size
    got_Phi, got_Y = returned_parts(ask, "regressors", "Phi and Y", 2, u, y)
    if isinstance(got_Phi, np.ndarray) and got_Phi.ndim == 1 and isinstance(got_Y, np.ndarray) and got_Y.ndim == 2:
        yield Verdict(False, "`regressors` returns Y before Phi.", "Phi and Y swapped")
    first = n - len(got_Phi) if isinstance(got_Phi, np.ndarray) and got_Phi.ndim == 2 else 2
    rows = build_equations(_STRUCTURE, u, y, start=first).Phi if 0 <= first <= _LATEST_START else None
    Phi, Y = as_matrix("Phi of regressors(u, y)", got_Phi, (None, 3), rows), as_vector("Y of regressors(u, y)", got_Y)
    start = n - Phi.shape[0]
    if Y.size != Phi.shape[0]:
        yield Verdict(
            False,
            f"`regressors` returns {Phi.shape[0]} rows of Phi and {Y.size} of Y: each row of Phi goes with one y(t). "
            f"{beside_right_rows(_QUOTED, Y, y, u, range(start, n)) if rows is not None and SAME(Phi, rows) else ''}"
            "".rstrip(),
            "Phi and Y of unequal length",
        )
    held = _rows_held(Phi, u, y)
    if held is not None and SAME(Y, y[held.start : held.stop]) and _rows_left_out(held, n):
        yield Verdict(False, _rows_left_out(held, n), "rows left out")
    if not 0 <= start <= _LATEST_START:
        beside = "" if held is None else f" {beside_right_rows(_QUOTED, Y, y, u, held)}"
        yield Verdict(
            False,
            f"`regressors` makes {Phi.shape[0]} rows of {n} samples: {n - 2} are asked for, from the third sample to "
            f"the last.{beside}",
        )
    right = build_equations(_STRUCTURE, u, y, start=start).Phi
    early = [build_equations(_STRUCTURE, u, y, start=s).Phi[: n - start] for s in range(start)]
    lag = "a lag of `regressors` is off by one: in the row of y(t), "
    past_u = f"{lag}the third column holds {{}}, and should hold u(t-1)."
    past_y = f"{lag}the first two columns hold -y(t) and -y(t-1), and should hold -y(t-1) and -y(t-2)."
    future = np.append(u, 0.0)
    yield judge(
        Phi,
        right,
        SAME,
        "",
        "Phi of `regressors` is not [-y(t-1), -y(t-2), u(t-1)]: write the row of the third sample down by hand.",
        [
            Slip(
                "sign of a",
                "`regressors` has +y where theta = [a1, a2, b1] asks for -y. (The lab's theta begins with -a1, and "
                "there the regressor is +y.)",
                lambda: right * [-1, -1, 1],
            ),
            Slip(
                "order of the columns",
                "the columns of `regressors` are in another order than theta = [a1, a2, b1].",
                lambda: right[:, [2, 0, 1]],
            ),
            Slip(
                "order of the columns",
                "`regressors` has y(t-2) before y(t-1): a1 belongs to y(t-1).",
                lambda: right[:, [1, 0, 2]],
            ),
            Slip("lag off by one", past_u.format("u(t)"), lambda: np.column_stack([right[:, :2], u[start:]])),
            Slip("lag off by one", past_y, lambda: np.column_stack([-y[start:], right[:, 0], right[:, 2]])),
            Slip(
                "lag off by one",
                f"{lag}every column holds a sample that is one newer than -y(t-1), -y(t-2) and u(t-1).",
                lambda: np.column_stack([-y[start:], right[:, 0], u[start:]]),
            ),
            Slip(
                "lag off by one",
                past_u.format("u(t-2)"),
                lambda: np.column_stack([right[:, :2], u[start - 2 : n - 2]]),
            ),
            Slip(
                "lag off by one",
                past_u.format("u(t+1)"),
                lambda: np.column_stack([right[:, :2], future[start + 1 :]]),
            ),
            Slip(
                "index wraps around",
                "`np.roll`, or an index below zero, brings the end of the record round to its start: a sample from the "
                "future. Begin at the third sample, or fill with zeros.",
                lambda: np.column_stack([-np.roll(y, 1), -np.roll(y, 2), np.roll(u, 1)])[start:],
            ),
            *(
                Slip(
                    "rows do not start together",
                    "Phi of `regressors` stops before Y does: its rows belong to earlier samples than they should.",
                    partial(np.copy, wrong),
                )
                for wrong in early
            ),
        ],
    )
    yield judge(
        Y,
        y[start:],
        SAME,
        "",
        beside_right_rows(_QUOTED, Y, y, u, range(start, n)),
        [
            Slip(
                "rows do not start together",
                "Phi of `regressors` is right, and Y one sample early: the row with y(t-1) in it belongs to y(t).",
                lambda: y[start - 1 : n - 1] if start else y + 1,
            ),
            Slip(
                "sign of Y",
                "Phi of `regressors` is right, and the sign of Y is turned: the minus belongs into Phi.",
                lambda: -y[start:],
            ),
            Slip(
                "u for y",
                "Phi of `regressors` is right, and Y holds the input; it is the output that is predicted.",
                lambda: u[start:],
            ),
        ],
    )


@first_failure
def check_forgetting(ask: Ask) -> Iterator[Verdict]:
    """`rls(Phi, Y, lam, LN)`, then its two runs over Example 6-1."""
    for n, p, lam, large in ((12, 2, 1.0, 50.0), (15, 3, 0.9, 200.0), (14, 2, 0.75, 5.0), (9, 1, 0.8, 20.0)):
        drawn = lam if lam == 1 else float(np.round(lam + ask.rng.uniform(-0.05, 0.05), 3))
        yield _one_run(ask, n + int(ask.rng.integers(4)), p, drawn, float(np.round(large * ask.rng.uniform(0.8, 1.2))))
    Phi, Y = as_matrix("Phi_61", ask.known("Phi_61"), (None, 3)), as_vector("Y_61", ask.known("Y_61"))
    for name, lam in (("theta_1", 1.0), ("theta_099", 0.99)):
        got = as_history(name, ask.value(name), *Phi.shape)
        if not close(0.0, 1e-3)(got[SETTLED:], reference_run(Phi, Y, lam, LN).theta[SETTLED:]):
            yield Verdict(False, f"the function is right, `{name}` is not: leave the last lines as they were given.")
    yield Verdict(True, "every sample updates the estimate, and with lambda below 1 the old ones fade.")


def right_histories(ask: Ask) -> dict[str, Value]:
    """What the last lines of that step compute, from the regressors that the student went on with."""
    Phi, Y = as_matrix("Phi_61", ask.known("Phi_61"), (None, 3)), as_vector("Y_61", ask.known("Y_61"))
    return {name: reference_run(Phi, Y, lam, LN).theta for name, lam in (("theta_1", 1.0), ("theta_099", 0.99))}


def _one_run(ask: Ask, n: int, p: int, lam: float, large: float) -> Verdict:
    Phi, Y = ask.rng.uniform(-2, 2, (n, p)), ask.rng.uniform(-3, 3, n)
    call = f"rls(Phi, Y, {lam:g}, {large:g})"
    got = as_history(call, returned(ask, "rls", Phi, Y, lam, large), n, p)
    right = reference_run(Phi, Y, lam, large).theta
    wrong = partial(faulty_run, Phi, Y, lam, large)
    if is_one_array(got, [right]):
        return Verdict(
            False,
            "every row of `rls` is the last estimate: the same array was stored each time and changed in place "
            "(`theta += ...`). Store a copy, or write `theta = theta + ...`.",
            "one array stored again and again",
        )
    return judge(
        got,
        right,
        SAME,
        "",
        f"`{call}` does not give the estimates of RLS"
        + (", though with lambda = 1 it does: look at the two places of lambda." if lam < 1 else ", with lambda = 1."),
        [
            Slip(
                "lambda not used",
                "`rls` runs with lambda = 1, whatever lam is.",
                lambda: reference_run(Phi, Y, 1.0, large).theta,
            ),
            Slip(
                "1 in the denominator",
                "the denominator of `rls` is 1 + phi'P phi: with forgetting the 1 becomes lambda, lam + phi'P phi.",
                lambda: wrong(denominator=1.0),
            ),
            Slip(
                "not divided by lambda",
                "P of `rls` is not divided by lambda. Without that it only shrinks, and nothing is forgotten.",
                lambda: wrong(factor=1.0),
            ),
            Slip(
                "multiplied by lambda",
                "`rls` multiplies P by lambda: old samples would count more and more.",
                lambda: wrong(factor=lam),
                mend="Divide.",
            ),
            Slip(
                "gain from the old P",
                "`rls` takes the gain from the P before the sample.",
                lambda: wrong(old_gain=True),
                mend="Update P first.",
            ),
            Slip(
                "P made anew",
                "`rls` makes P anew for every row: make it once, before the loop.",
                lambda: _made_anew(Phi, Y, lam, large),
            ),
            Slip(
                "first row left out",
                "row 0 of `rls` is still zero: the loop begins with the second row of Phi. Begin it at 0.",
                lambda: np.vstack([np.zeros(p), reference_run(Phi[1:], Y[1:], lam, large).theta]),
            ),
            Slip(
                "P(0) full of LN",
                "`rls` begins with LN in every entry of P: LN I has it on the diagonal only.",
                lambda: wrong(full=True),
            ),
            Slip(
                "sign of the error",
                "`rls` moves away from the samples: the sign of the error is turned round, or the correction is taken "
                "off. The error is y - phi'theta, and K times it is added.",
                lambda: wrong(sign=-1.0),
            ),
            *(
                slip
                for first in (False, True)
                for slip in slips_of_update(
                    "`rls`", partial(run_with, Phi=Phi, Y=Y, lam=lam, LN=large, gain_first=first)
                )
            ),
            Slip(
                "start not used",
                "`rls` does not begin with P = LN I for the LN that it is given.",
                lambda: reference_run(Phi, Y, lam, 1e6).theta,
            ),
            Slip(
                "start not used",
                "`rls` begins with P = I, whatever LN is.",
                lambda: reference_run(Phi, Y, lam, 1.0).theta,
            ),
            Slip(
                "P(0) inverted",
                "`rls` begins with P = I/LN: LN is large because nothing is known yet, and P(0) is LN I.",
                lambda: reference_run(Phi, Y, lam, 1 / large).theta,
            ),
            Slip(
                "history begins with theta(0)",
                "row k of `rls` is the estimate before sample k: store theta after its update.",
                lambda: np.vstack([np.zeros(p), right[:-1]]),
            ),
        ],
    )


def _made_anew(Phi: FloatArray, Y: FloatArray, lam: float, LN: float) -> FloatArray:
    """History of a run in which P is LN I before every sample."""
    theta, history = np.zeros(Phi.shape[1]), np.empty(Phi.shape)
    for k, (phi, y) in enumerate(zip(Phi, Y, strict=True)):
        theta = history[k] = reference_step(theta, LN * np.eye(phi.size), phi, y, lam)[0]
    return history


def _true_curve(axes: AxesValue, truth: FloatArray) -> CurveValue | None:
    drawn = (find_curve(axes, truth[start:]) for start in range(_LATEST_START + 1))
    return next(filter(None, drawn), None)


def _shows_truth(axes: AxesValue, truth: FloatArray) -> bool:
    """Whether a panel shows the true parameter: as a curve, or as a horizontal line at each of its levels."""
    if _true_curve(axes, truth) is not None:
        return True

    def is_drawn(level: float) -> bool:
        samples = np.flatnonzero(truth == level)
        middle = (samples[0] + samples[-1]) / 2
        return any(
            np.allclose(curve.y, level, atol=1e-9) and np.min(curve.x) <= middle <= np.max(curve.x)
            for curve in axes.curves
        )

    return all(is_drawn(level) for level in np.unique(truth))


def new_histories(ask: Ask) -> dict[str, Value]:
    """Histories to practise with, of another record of Example 6-1."""
    record = example_6_1(ask.rng)
    equations = build_equations(_STRUCTURE, record.u, record.y)
    runs = {
        name: reference_run(equations.Phi, equations.Y, lam, 1e6)
        for name, lam in (("theta_1", 1.0), ("theta_099", 0.99))
    }
    return {"Y_61": equations.Y, "theta_true": record.theta, **{name: run.theta for name, run in runs.items()}}


def _require_two_figures(one: Value, other: Value, histories: Mapping[str, FloatArray]) -> None:
    """Refuse one figure under both names."""
    if not isinstance(one, FigureValue) or not isinstance(other, FigureValue) or len(one.axes) != 1:
        return
    pairs = zip(one.axes[0].curves, other.axes[0].curves, strict=False) if other.axes else ()
    same = [
        np.array_equal(a.x, b.x) and np.array_equal(a.y, b.y) and a.label == b.label and a.color == b.color
        for a, b in pairs
    ]
    shows_both = all(find_curve(one.axes[0], history[:, 0]) is not None for history in histories.values())
    if shows_both and all(same) and len(same) == len(one.axes[0].curves) == len(other.axes[0].curves):
        raise NoAnswer(
            "`fig_9` and `fig_10` are one figure with all curves in it. Two are asked for: make each by its own "
            "`plt.subplots()`, Fig. 9 with the columns of `theta_1`, Fig. 10 with those of `theta_099`.",
            "one figure for two",
        )


def check_figures(ask: Ask) -> Verdict:
    """Fig. 9 and 10: the three estimates over time, and the truth."""
    rows = as_vector("Y_61", ask.known("Y_61")).size
    histories = {name: as_history(name, ask.known(name), rows, 3) for name in ("theta_1", "theta_099")}
    truth = lecture_record().theta
    _require_two_figures(ask.value("fig_9"), ask.value("fig_10"), histories)
    for figure, name, swapped_with in (("9", "theta_1", "theta_099"), ("10", "theta_099", "theta_1")):
        where = f"Fig. {figure}"
        axes = as_figure(f"fig_{figure}", ask.value(f"fig_{figure}"), axes=1).axes[0]
        if not axes.curves:
            raise NoAnswer(f"`fig_{figure}` is empty: draw in its axes.", "empty axes")
        curves: list[CurveValue] = []
        for i, parameter in enumerate(_NAMES):
            curve = find_curve(axes, histories[name][:, i])
            if curve is None and find_curve(axes, histories[swapped_with][:, i]) is not None:
                raise NoAnswer(
                    f"{where} shows `{swapped_with}`: Fig. 9 is lambda = 1, Fig. 10 is lambda = 0.99.",
                    "figures swapped",
                )
            if curve is None:
                what = f"{parameter}, column {i} of `{name}`"
                raise no_curve(axes, where, what, histories[name][:, i], "Draw it against the sample number.")
            if not _shows_truth(axes, truth[:, i]):
                raise NoAnswer(
                    f"{where} has no curve of the true {parameter}: draw the columns of `theta_true`, too.",
                    "truth missing",
                )
            true_curve = _true_curve(axes, truth[:, i])
            if true_curve is not None and true_curve.style == curve.style:
                raise NoAnswer(
                    f"In {where} the true {parameter} has the line style of its estimate: draw the true values in "
                    "another one, such as `'--'`.",
                    "truth in the same style",
                )
            curves.append(curve)
        for axis in "xy":
            require_label(axes, where, axis, "")
        require_legend(axes, where, 3)
        for curve, parameter in zip(curves, _NAMES, strict=True):
            text = plain_text(legend_text(axes, curve)).replace("_", "")
            if parameter not in text:
                if any(another in text for another in _NAMES):
                    raise NoAnswer(f"The legend of {where} gives {parameter} another name.", "legend entries swapped")
                raise NoAnswer(f"The legend of {where} should name the curve of {parameter}.", "no legend")
    return Verdict(True, "one estimate that averages for ever, and one that follows.")
