"""Checks of the pre-lab: time vector, two noisy sinusoids, the cut, the matrix and Fig. 1."""

import re
from collections.abc import Iterator

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.answer_code import nothing_returned
from labsid.checks.assignments.prelab_sinusoids.figure_panels import panels, require_panel, shows
from labsid.checks.assignments.prelab_sinusoids.noise_statistics import (
    require_independent,
    require_real,
    require_uniform,
    require_wave,
)
from labsid.checks.assignments.prelab_sinusoids.slips import (
    CUT,
    cut_off_slips,
    matrix_slips,
    new_signal_slips,
    new_time_slips,
    time_slips,
)
from labsid.checks.compare import as_array, as_column, as_matrix, as_vector, close
from labsid.checks.question import Ask
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Verdict, first_failure, judge
from labsid.lab.sinusoid import Sinusoids, cut_off, make_sinusoids

_same = close(0, absolute=1e-9)
_ORIGINAL = r"original|\(a\)"
"""What the title of Fig. 1(a) has."""


def check_time(ask: Ask) -> Verdict:
    """Step 1: the column vector t."""
    value = ask.value("t")
    got = as_vector("t", value)
    apart = f", {np.mean(np.diff(got)):.4g} s apart" if got.size > 1 else ""
    span = f"from {got[0]:.4g} to {got[-1]:.4g}{apart}" if got.size else "and no entries"
    verdict = judge(
        got,
        make_sinusoids(ask.rng).t.ravel(),
        _same,
        "a column of 1001 instants from 0 to 100 s.",
        f"`t` should run from 0 to 100 s in steps of 0.1 s; yours has {got.size} points {span}.",
        time_slips(),
    )
    if verdict.passed:
        as_column("t", value)
    return verdict


def check_noise(ask: Ask) -> Verdict:
    """Step 2: the sinusoids y1 and y2, judged by their statistics."""
    t = _vector(ask.known("t"))
    noises: dict[str, FloatArray] = {}
    sinusoids: dict[str, FloatArray] = {}
    for name, wave, other_wave in (("y1", np.sin, np.cos), ("y2", np.cos, np.sin)):
        value = ask.value(name)
        require_real(name, t, value, wave)
        y = _signal(name, value, t.size)
        require_wave(name, t, y, wave, other_wave)
        sinusoids[name] = wave(0.02 * np.pi * t)
        noises[name] = y - sinusoids[name]
    for name, noise in noises.items():
        require_uniform(name, noise, sinusoids[name])
    require_independent(noises)
    return Verdict(True, "a sine and a cosine of period 100 s, each with its own uniform noise within ±0.2.")


def check_cut(ask: Ask) -> Verdict:
    """Step 3: t_new, y1_new, y2_new."""
    t, y1, y2 = (_vector(ask.known(name)) for name in ("t", "y1", "y2"))
    _require_unchanged_time(ask, t)
    verdict = judge(
        as_vector("t_new", ask.value("t_new")),
        _vector(right_cut(ask)["t_new"]),
        _same,
        "the first 200 samples are removed, and time starts from zero.",
        "`t_new` should be `t` without its first 200 samples, starting from zero: see step 3.",
        new_time_slips(t),
    )
    for name, y, other_signal in (("y1_new", y1, y2), ("y2_new", y2, y1)):
        if verdict.passed:
            verdict = judge(
                as_vector(name, ask.value(name)),
                y[CUT:],
                _same,
                verdict.reason,
                f"`{name}` should be `{name[:2]}` without its first 200 samples: see step 3.",
                new_signal_slips(name, y, other_signal),
            )
    now = ask.value("t")
    is_kept = isinstance(now, np.ndarray) and now.dtype.kind in "biuf" and _same(_vector(now), t)
    if verdict.passed and not is_kept:
        return Verdict(
            False,
            "`t` has changed in this step, and Fig. 1(a) needs it as it was. Take the time off `t_new` alone, and run "
            "the cell of `t` again.",
            "time itself changed",
        )
    return verdict


def _require_unchanged_time(ask: Ask, t: FloatArray) -> None:
    """Refuse a `t` that was changed with its view `t_new`: `t_new = t[200:]`, then `t_new -= 20`."""
    now = as_vector("t", ask.value("t"))
    if now.size != t.size:
        raise NoAnswer(
            f"`t` itself has changed: it has {now.size} of its {t.size} samples, and each run of a cell that cuts `t` "
            "cuts it once more. Give the result a name of its own, `t_new`, and run the cell of `t` again.",
            "cut under its own name",
        )
    changed = t.copy()
    for runs in (1, 2, 3):
        changed[CUT:] -= t[CUT]
        if _same(now, changed):
            raise NoAnswer(
                f"`t` itself has changed, by {20 * runs} s: `t[200:]` is a view of `t`, and `t_new -= ...` writes into "
                "it. Write `t_new = t_new - ...`, or cut a copy, and run the cell of `t` again.",
                "a view changed",
            )


def check_matrix(ask: Ask) -> Verdict:
    """Step 4: data_new, n by 3."""
    parts = [_vector(ask.known(name)) for name in ("t_new", "y1_new", "y2_new")]
    uncut = [_vector(ask.known(name)) for name in ("t", "y1", "y2")]
    value = ask.value("data_new")
    got = as_array("data_new", value)
    verdict = judge(
        got,
        np.column_stack(parts),
        _same,
        f"three columns of {parts[0].size} rows.",
        f"`data_new` has the right shape, but not the columns t_new, y1_new, y2_new.{_held(got, parts)}",
        matrix_slips(parts, uncut, got.shape),
    )
    if not verdict.passed and verdict.slip is None:
        as_matrix("data_new", value, (parts[0].size, 3))
    return verdict


def _held(got: FloatArray, parts: list[FloatArray]) -> str:
    """Which column of `data_new` holds another one's values."""
    names = ("t_new", "y1_new", "y2_new")
    if got.shape != (parts[0].size, len(parts)):
        return ""
    said = [
        f"`[:, {i}]` holds {names[j]}, where {names[i]} belongs"
        for i, column in enumerate(got.T)
        for j, part in enumerate(parts)
        if i != j and _same(column, part)
    ]
    return f" {', and '.join(said)}." if said else ""


@first_failure
def check_function(ask: Ask) -> Iterator[Verdict]:
    """Step 4, as a function: cut_off(data, n) on unseen data."""
    for rows, columns, share in ((320, 3, 0.1), (60, 2, 0.5), (90, 5, 0.3), (40, 3, 0.0), (12, 4, 1.0)):
        Ts, start = float(ask.rng.choice([0.05, 0.25, 0.75])), float(ask.rng.integers(3, 40))
        signals = ask.rng.normal(size=(rows, columns - 1))
        data = np.column_stack([start + Ts * np.arange(rows), signals])
        n = min(int(share * rows) + int(ask.rng.integers(5)), rows - 1) if share else 0
        yield _try_cut_off(ask, data, n)
    if ask.changes("cut_off", data[:, :3].copy(), 3):
        yield Verdict(
            False,
            "`cut_off` returns the right rows, and changes the matrix `data` that it is given: whoever calls it loses "
            "the times of the data. (A slice such as `data[n:]` is a view: what is subtracted from it is subtracted "
            "from `data`.)",
            "changes its argument",
            "Begin with a copy: `rest = data[n:].copy()`.",
        )


def _try_cut_off(ask: Ask, data: FloatArray, n: int) -> Verdict:
    columns = data.shape[1]
    try:
        value = ask.call("cut_off", data, n)
    except NoAnswer as stopped:
        if columns == 3:
            raise
        raise NoAnswer(f"{stopped} (`data` had {columns} columns.)", "always three columns") from None
    if value is None:
        raise nothing_returned(ask, "cut_off", "the matrix")
    got = as_array("cut_off(data, n)", value)
    if columns != 3 and got.ndim == 2 and got.shape[1] == 3:
        raise NoAnswer(
            f"`cut_off` returns three columns of a matrix with {columns}: keep all columns of `data`.",
            "always three columns",
        )
    got = as_matrix("cut_off(data, n)", value, (None, columns))
    right = data[n:].copy()
    right[:, 0] -= right[0, 0]
    return judge(
        got,
        right,
        _same,
        "it cuts other data as well, and their time starts from zero.",
        f"`cut_off` should return `data` without its first `n` rows, with time from zero: {_seen_rows(got, data, n)}",
        cut_off_slips(data, n),
    )


def _seen_rows(got: FloatArray, data: FloatArray, n: int) -> str:
    """What is wrong with the rows that came back, in the numbers of the trial."""
    if len(got) != len(data) - n:
        return f"of {len(data)} rows and n = {n} it returned {len(got)}; {len(data) - n} should stay."
    if len(got) > 1 and np.allclose(got[1:], data[n + 1 :]):
        return "only the first row has changed. `data[0]` is the first *row*; the first column is `data[:, 0]`."
    if not np.allclose(got[:, 1:], data[n:, 1:]):
        return "the signals, from the second column on, are not those of the rows that should stay."
    return f"the signals are right, but the first column begins with {got[0, 0]:.4g} and ends with {got[-1, 0]:.4g}."


def check_original(ask: Ask) -> Verdict:
    """Step 5: Fig. 1(a)."""
    t, y1, y2 = (_vector(ask.known(name)) for name in ("t", "y1", "y2"))
    upper, *others = panels(ask.value("fig_1"))
    for lower in others:
        if any(shows(lower, y) and not shows(upper, y) for y in (y1, y2)):
            raise NoAnswer(
                "The original data are in the lower panel: `plt.plot` and `plt.step` draw into the axes made last, "
                "which are `ax_b`. Draw with `ax_a.plot` and `ax_a.step`, and run the line that makes the figure "
                "again.",
                "drawn into the lower axes",
            )
        if re.search(_ORIGINAL, lower.title, re.IGNORECASE) and not upper.title:
            raise NoAnswer(
                "The title of Fig. 1(a) stands over the lower panel: `plt.title`, `plt.xlim` and the like act on the "
                "axes made last, which are `ax_b`. Use `ax_a.set_title`, `ax_a.set_xlim`, ..., and run the line that "
                "makes the figure again.",
                "lower axes set",
            )
    beside = others[0] if len(others) == 1 else None
    require_panel(upper, "Fig. 1(a)", t, {"y1": y1, "y2": y2}, _ORIGINAL, beside)
    return Verdict(True, "Fig. 1(a) shows the original data as the lab requires.")


def check_cut_off_data(ask: Ask) -> Verdict:
    """Step 6: Fig. 1(b)."""
    t, y1, y2 = (_vector(ask.known(name)) for name in ("t", "y1", "y2"))
    t_new, y1_new, y2_new = (_vector(ask.known(name)) for name in ("t_new", "y1_new", "y2_new"))
    axes = panels(ask.value("fig_1"))
    if len(axes) != 2:
        raise NoAnswer(f"`fig_1` should have two panels, one above the other; it has {len(axes)}.", "not two panels")
    upper, lower = axes
    if not lower.curves and (shows(upper, y1_new, t_new) or shows(upper, y2_new, t_new)):
        raise NoAnswer(
            "The cut-off data are in Fig. 1(a): draw them with `ax_b.plot` and `ax_b.step`. Run the cell that makes "
            "`fig_1` again, then this one: curves stay in their axes.",
            "drawn into the upper axes",
        )
    if (shows(lower, y1) or shows(lower, y2)) and (shows(lower, y1_new) or shows(lower, y2_new)):
        raise NoAnswer(
            "Fig. 1(b) shows the cut-off data and the original data: curves of an earlier run stay in "
            "the axes. Run the cell that makes `fig_1` again, then this one. (`plt.plot` draws into the axes made "
            "last, which are `ax_b`.)",
            "old curves in (b)",
        )
    if shows(lower, y1) or shows(lower, y2):
        raise NoAnswer("Fig. 1(b) shows the original data again; plot the cut-off data.", "original data in (b)")
    if shows(lower, y1_new, t[CUT:]) or shows(lower, y2_new, t[CUT:]):
        raise NoAnswer(
            "In Fig. 1(b) the cut-off data are plotted at their old time. Plot them against `t_new`.",
            "old time in (b)",
        )
    require_panel(lower, "Fig. 1(b)", t_new, {"y1_new": y1_new, "y2_new": y2_new}, r"cut|\(b\)", upper)
    return Verdict(True, "Fig. 1(b) shows the cut-off data, starting at time zero.")


def _vector(value: Value) -> FloatArray:
    return np.asarray(value, np.float64).reshape(-1)


def _signal(name: str, value: Value, size: int) -> FloatArray:
    if isinstance(value, np.ndarray) and value.ndim == 2 and len(value) == size and value.shape[1] > size // 2:
        raise NoAnswer(
            f"`{name}` has shape {value.shape}: flat noise was added to a column. Draw noise of the shape `t.shape`.",
            "flat noise added to a column",
        )
    return as_vector(name, value, size)


def right_time(ask: Ask) -> dict[str, Value]:
    """The time vector."""
    return {"t": make_sinusoids(ask.rng).t}


def right_sinusoids(ask: Ask) -> dict[str, Value]:
    """The two sinusoids, without and with noise."""
    made = make_sinusoids(ask.rng)
    return {"y1": made.y1, "y2": made.y2}


def right_cut(ask: Ask) -> dict[str, Value]:
    """The cut signals, and the time as it was before."""
    t, y1, y2 = (_vector(ask.known(name)).reshape(-1, 1) for name in ("t", "y1", "y2"))
    right = cut_off(Sinusoids(t, y1, y2), CUT)
    return {"t": t, "t_new": right.t_new, "y1_new": right.y1_new, "y2_new": right.y2_new}
