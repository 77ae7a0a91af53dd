"""Steps 3 to 5 of the gap: shares of the squared error in time, in frequency and in the operating range."""

from collections.abc import Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray

from labsid._arrays import FloatArray
from labsid.checks.answer_code import code_of
from labsid.checks.assignments.lab_identification.lab_data import known_vector
from labsid.checks.assignments.sim_to_real_gap.linear_model import known_error
from labsid.checks.compare import SAME, as_number, as_vector, close
from labsid.checks.double_mistakes import Edit, pairs_of
from labsid.checks.question import Ask, returned
from labsid.checks.verdict import NoAnswer, Slip, Verdict, first_failure, judge

PARTS, CELLS = 16, 8


def check_time(ask: Ask) -> Verdict:
    """Step 3: `time_shares(e, parts)` on other errors, `share_t` and `worst` on this one."""
    for parts, length in ((4, int(ask.rng.integers(25, 35))), (5, int(ask.rng.integers(20, 28)))):
        e = ask.rng.standard_normal(parts * length) * np.repeat(ask.rng.uniform(0.3, 3, parts), length)
        value = returned(ask, "time_shares", e, parts)
        if isinstance(value, np.ndarray) and value.size == PARTS != parts:
            raise NoAnswer(
                f"`time_shares(e, {parts})` returns {PARTS} shares, as for this record: use the argument `parts`.",
                "parts not used",
            )
        if isinstance(value, np.ndarray) and value.shape == (length,):
            raise NoAnswer(
                f"`time_shares(e, {parts})` of {e.size} samples returns {length} numbers: it adds up over the {parts} "
                f"stretches, and not over the {length} samples of each. In `np.reshape(e, (parts, -1))` a stretch is a "
                "row: add up with `axis=1`.",
                "sum over the wrong axis",
            )
        got = _shares("time_shares(e, parts)", value, parts)
        verdict = _judge_shares("time_shares", got, np.sum(e.reshape(parts, -1) ** 2, axis=1), _time_slips(e, parts))
        if not verdict.passed:
            return verdict
    e, _ = known_error(ask)
    if e.size % PARTS:
        e = e[: e.size - e.size % PARTS]
    energy = np.sum(e.reshape(PARTS, -1) ** 2, axis=1)
    verdict = judge(
        _shares("share_t", ask.value("share_t"), PARTS),
        energy / energy.sum(),
        SAME,
        "",
        f"`share_t` is not what `time_shares` makes of the error of your linear model in {PARTS} parts.",
        [
            Slip(
                "shares of the output",
                "`share_t` are shares of the output. Hand `time_shares` the error `e`.",
                lambda: _normed(np.sum(known_vector(ask, "y")[: e.size].reshape(PARTS, -1) ** 2, axis=1)),
            ),
            Slip(
                "held-out half only",
                "`share_t` is made of the held-out half of the error: here the whole of `e` is cut into parts.",
                lambda: _normed(np.sum(e[e.size // 2 :].reshape(PARTS, -1) ** 2, axis=1)),
            ),
        ],
    )
    return _worst(ask, e, energy, e.size // PARTS * ask.record.Ts) if verdict.passed else verdict


def _time_slips(e: FloatArray, parts: int) -> list[Slip[FloatArray]]:
    blocks = e.reshape(parts, -1)
    return [
        Slip(
            "errors not squared",
            "`time_shares` adds up the errors themselves, with their signs. Squares are asked for: |.|^2.",
            lambda: _normed(np.sum(blocks, axis=1)),
        ),
        *_common_slips("time_shares", np.sum(blocks**2, axis=1), np.sum(np.abs(blocks), axis=1)),
        Slip(
            "every so many samples",
            "`time_shares` puts every n-th sample together. A stretch is a run of neighbours.",
            lambda: _normed(np.sum(e.reshape(-1, parts) ** 2, axis=0)),
            mend="`reshape(parts, -1)` has one in each row.",
        ),
        Slip(
            "stretches overlap",
            "`time_shares` begins each stretch one sample after the last one: stretch i begins at sample i n.",
            lambda: np.array([np.sum(e[i : i + blocks.shape[1]] ** 2) for i in range(parts)]) / np.sum(e**2),
        ),
        Slip(
            "square of the sum",
            "`time_shares` squares the sum of the errors, in which they cancel. Square first, then add up.",
            lambda: _normed(np.sum(blocks, axis=1) ** 2),
        ),
        *(
            Slip(
                "a sample lost",
                "`time_shares` leaves one sample of each stretch out: a slice ends before its second index.",
                partial(lambda part: _normed(np.sum(blocks[:, part] ** 2, axis=1)), part),
            )
            for part in (slice(None, -1), slice(1, None))
        ),
        Slip(
            "mean taken out",
            "`time_shares` takes the variance of each stretch: the mean error is an error too.",
            lambda: _normed(np.var(blocks, axis=1)),
        ),
    ]


def _worst(ask: Ask, e: FloatArray, energy: FloatArray, length: float) -> Verdict:
    got = as_vector("worst", ask.value("worst"), 2)
    most, Ts = int(np.argmax(energy)), ask.record.Ts
    stretch = np.array([most, most + 1.0])
    share, e_size = float(energy[most] / energy.sum()), ask.record.y.size
    samples = np.array([share, share + 1])
    return judge(
        got,
        length * stretch,
        close(0, 0.1 * Ts),
        "the shares add up, and this is where to look.",
        f"`worst` is not the stretch with the largest share: its beginning and its end, in seconds."
        f"{_of_stretch(got, energy / energy.sum(), length)}",
        [
            Slip(
                "last sample of the stretch",
                "`worst` ends with the last sample of the stretch; asked for is the time at which the next one begins.",
                lambda: length * stretch - [0, Ts],
            ),
            Slip(
                "the largest error",
                "`worst` surrounds the largest single error: the stretch with the largest *share* is asked for.",
                lambda: Ts * (float(np.argmax(np.abs(e))) + np.array([0.0, 1.0])),
            ),
            *(
                Slip(
                    "the largest error",
                    f"`worst` is as long as a stretch, and {where} the largest single error: asked for is the stretch "
                    "with the largest *share*, which begins at a multiple of N/16.",
                    partial(np.add, Ts * float(np.argmax(np.abs(e))), np.multiply(length, ends)),
                )
                for where, ends in (("begins with", (0.0, 1.0)), ("surrounds", (-0.5, 0.5)), ("ends with", (-1.0, 0.0)))
            ),
            Slip(
                "part for a sample",
                "`worst` takes the number of a part for that of a sample: part i begins at sample i N/16.",
                lambda: Ts * stretch,
            ),
            *(
                Slip(
                    "a share for a time",
                    "`worst` holds shares: give the times at which this stretch and the next one begin.",
                    partial(np.copy, shares),
                )
                for shares in (energy[most : most + 2] / energy.sum(), energy[[most, most]] / energy.sum())
                if shares.size == 2
            ),
            *(
                Slip(
                    "the largest share for its index",
                    f"`worst` is made of the largest share itself, {share:.3g}, in place of its index: `np.max` gives "
                    "the value, `np.argmax` the index.",
                    partial(np.multiply, Ts, begins),
                )
                for begins in (samples * length / Ts, samples * length // Ts, samples * e_size // PARTS)
            ),
            Slip(
                "an index of the error",
                "`worst` begins with the sample of the largest error, as the number of a stretch: take `np.argmax` of "
                "the shares.",
                lambda: length * (int(np.argmax(e)) + np.array([0.0, 1.0])),
            ),
            Slip("samples for seconds", "`worst` is in samples: times `Ts`.", lambda: length / Ts * stretch),
            Slip("numbers of the parts", "`worst` counts parts: give the times, in seconds.", lambda: stretch),
            Slip(
                "the quietest stretch",
                "`worst` is the stretch with the *smallest* share.",
                lambda: length * (int(np.argmin(energy)) + np.array([0.0, 1.0])),
            ),
            Slip(
                "counted from one",
                "`worst` is one stretch late: `np.argmax` counts from 0.",
                lambda: length * (stretch + 1),
            ),
        ],
    )


def _of_stretch(got: FloatArray, shares: FloatArray, length: float) -> str:
    """What share the stretch from `got` has, where it is one; else how long it is, and how long a stretch."""
    if abs(got[1] - got[0] - length) > _NEAR_LENGTH * length:
        return f" Yours is {got[1] - got[0]:.4g} s long, and a stretch {length:.4g} s."
    part = round(got[0] / length)
    if not 0 <= part < shares.size or abs(got[0] - part * length) > _NEAR_LENGTH * length:
        return f" Yours begins at {got[0]:.4g} s, and the stretches at multiples of {length:.4g} s."
    return (
        f" Yours, stretch {part} (counted from 0), has the share {shares[part]:.2g}; the largest is {max(shares):.2g}."
    )


_NEAR_LENGTH = 0.01


@first_failure
def check_frequency(ask: Ask) -> Iterator[Verdict]:
    """Step 4: `band_shares(e, Ts, edges)`."""
    draws = ((400, 0.75, True), (512, float(ask.rng.choice([0.1, 0.2])), True), (351, 0.4, False))
    for n, Ts, is_covered in draws:
        e = _smoothed(ask.rng.standard_normal(n + 40))[40:]
        e = e - e.mean() + ask.rng.choice([-0.4, 0.4]) * e.std()
        f: FloatArray = np.arange(n // 2 + 1, dtype=np.float64) / (n * Ts)
        # with or without a last band that reaches beyond the highest frequency
        inner = np.sort(ask.rng.choice(np.arange(3, n // 4), 4, replace=False)) + 0.5
        edges = np.concatenate([[-0.5], inner, [n] if is_covered else []])
        edges *= f[1]
        power: FloatArray = np.abs(np.fft.rfft(e)) ** 2
        value = returned(ask, "band_shares", e, Ts, edges)
        if isinstance(value, np.ndarray) and value.dtype.kind == "c" and np.any(value.imag):
            raise NoAnswer(
                "`band_shares` returns complex numbers: `E**2` of a complex E is complex. |E|^2 is `np.abs(E)**2`.",
                "square without absolute value",
            )
        got = _shares("band_shares(e, Ts, edges)", value, edges.size - 1)
        spectrum = np.fft.rfft(e)
        # a one-sided power density counts every frequency twice but 0 and the last one: Parseval's shares
        twice = np.where((f == 0) | ((n % 2 == 0) & (f == f[-1])), 1, 2) * power
        if close(0, 0.003)(got, _normed(_sorted(f, edges, twice))):
            continue
        slips = [*_band_slips(f, edges, power, Ts), *_complex_slips(f, edges, spectrum)]
        slips += pairs_of("`band_shares`", _edits_of_bands(e, f, Ts), partial(_bands, e, f, edges))
        yield _with_estimate(ask, _judge_shares("band_shares", got, _sorted(f, edges, power), slips, 0.003))
    yield Verdict(True, "the shares of all bands add up to one.")


def _with_estimate(ask: Ask, verdict: Verdict) -> Verdict:
    """A verdict that names no mistake, with that of a spectrum which is an average, where the code computes one."""
    code = code_of(ask, "band_shares")
    averaging = next((name for name in ("welch", "csd", "spectrogram") if code is not None and name in code.calls), "")
    if verdict.passed or verdict.slip is not None or not averaging:
        return verdict
    return Verdict(
        False,
        f"`band_shares` uses `{averaging}`, which takes means off, multiplies by windows and averages over parts of "
        "the record: its shares are an estimate. Those of this error follow from its own DFT, `np.fft.rfft(e)`.",
        "averaged spectrum",
    )


def _complex_slips(f: FloatArray, edges: FloatArray, spectrum: NDArray[np.complex128]) -> list[Slip[FloatArray]]:
    hint = "`band_shares` takes {} of a complex E, which is not |E|^2: use `np.abs(E)**2`."
    return [
        Slip("square without absolute value", hint.format(what), partial(_normed_cells, f, edges, wrong))
        for what, wrong in (
            ("the real part of the square", (spectrum**2).real),
            ("the square of the real part", spectrum.real**2),
            ("the absolute value of the real part", np.abs(spectrum.real)),
            ("the square of the imaginary part", spectrum.imag**2),
        )
    ]


def _normed_cells(f: FloatArray, edges: FloatArray, weights: FloatArray) -> FloatArray:
    return _normed(_sorted(f, edges, weights))


def _edits_of_bands(e: FloatArray, f: FloatArray, Ts: float) -> tuple[Edit, ...]:
    """Single mistakes in what is transformed, in what is added up and in the frequencies."""
    return (
        Edit("signal", e - e.mean(), "the mean of the error is removed"),
        Edit("signal", e**2, "the squares of the error are transformed, and not the error itself"),
        Edit("signal", np.abs(e), "the absolute error is transformed, and not the error itself"),
        Edit("power", 1, "|E| is added up, and not |E|^2"),
        Edit("power", 4, "|E|^4 is added up, and not |E|^2"),
        Edit("frequencies", f * Ts, "Ts is left out of the frequencies"),
        Edit("frequencies", 2 * np.pi * f, "the frequencies are in rad/s, and the edges in Hz"),
    )


def _bands(
    e: FloatArray,
    f: FloatArray,
    edges: FloatArray,
    signal: FloatArray | None = None,
    power: int = 2,
    frequencies: FloatArray | None = None,
) -> FloatArray:
    """Shares of the bands with other parts in their formula."""
    spectrum = np.abs(np.fft.rfft(e if signal is None else signal))
    return _normed(_sorted(f if frequencies is None else frequencies, edges, spectrum**power))


def _band_slips(f: FloatArray, edges: FloatArray, power: FloatArray, Ts: float) -> list[Slip[FloatArray]]:
    return [
        *_common_slips("band_shares", _sorted(f, edges, power), _sorted(f, edges, np.sqrt(power))),
        Slip(
            "frequencies counted",
            "`band_shares` counts the frequencies of each band: each counts with its |E|^2, `weights=...`.",
            lambda: _normed(_sorted(f, edges, np.ones(f.size))),
        ),
        Slip(
            "decibels",
            "`band_shares` adds up decibels. Those are logarithms; |E|^2 itself is shared out.",
            lambda: _normed(_sorted(f, edges, 20 * np.log10(np.sqrt(power)))),
        ),
        Slip(
            "frequencies without Ts",
            "`band_shares` leaves Ts out: `np.fft.rfftfreq(len(e), Ts)` is in Hz, without Ts in cycles a sample.",
            lambda: _normed(_sorted(f * Ts, edges, power)),
        ),
        Slip(
            "mean taken out",
            "`band_shares` removes the mean of the error first: the mean error, at the frequency 0, is an error too.",
            lambda: _normed(_sorted(f, edges, np.where(f == 0, 0, power))),
        ),
        Slip(
            "divided by all frequencies",
            "`band_shares` divides by the sum over all frequencies; divide by the sum over all bands together.",
            lambda: _sorted(f, edges, power) / power.sum(),
        ),
        Slip(
            "1/Ts for Ts",
            "`band_shares` hands `rfftfreq` the sampling frequency; it takes the sampling time Ts.",
            lambda: _normed(_sorted(f * Ts**2, edges, power)),
        ),
        Slip(
            "1/Ts for Ts",
            "`band_shares` spaces the frequencies by 1/Ts; the spacing is 1/(N Ts).",
            lambda: _normed(_sorted(f * (2 * (f.size - 1)), edges, power)),
        ),
        Slip(
            "rad/s for Hz",
            "`band_shares` compares rad/s with edges in Hz.",
            lambda: _normed(_sorted(2 * np.pi * f, edges, power)),
        ),
        Slip(
            "mean for sum",
            "`band_shares` averages over the band; a wide band holds more. Add up.",
            lambda: _normed(_sorted(f, edges, power) / _sorted(f, edges, np.ones(f.size))),
        ),
    ]


def check_operating(ask: Ask) -> Verdict:
    """Step 5: `cell_shares(x, e, edges)` on other data, `share_u` and `share_y` on this record."""
    samples = int(ask.rng.integers(280, 340))
    x, e = ask.rng.uniform(-1, 1, samples), ask.rng.standard_normal(samples)
    e = e * (0.3 + np.abs(x - ask.rng.uniform(-0.5, 0.5))) + 0.3
    # samples on the first and on the last edge belong to the first and to the last cell
    on_edge = ask.rng.permutation(samples)[:4]
    x[on_edge], e[on_edge] = [-1.0, -1.0, 1.0, 1.0], 2 * np.max(np.abs(e))
    edges = np.concatenate([[-1.0], np.sort(ask.rng.uniform(-0.8, 0.8, 4)), [1.0]])
    got = _shares("cell_shares(x, e, edges)", returned(ask, "cell_shares", x, e, edges), edges.size - 1)
    verdict = _judge_shares("cell_shares", got, _sorted(x, edges, e**2), _cell_slips(x, e, edges))
    if not verdict.passed:
        return verdict
    e, _ = known_error(ask)
    u, y = ask.record.u, ask.record.y
    verdict = _own_cells(ask, "share_u", u, y, e)
    if verdict.passed:
        verdict = _own_cells(ask, "share_y", y, u, e)
    return verdict if not verdict.passed else Verdict(True, f"{_largest('input', u, e)}; {_largest('output', y, e)}.")


def _largest(signal: str, x: FloatArray, e: FloatArray) -> str:
    """The cell with the largest share, in words."""
    shares, edges = _cells(x, e), _edges(x)
    most = int(np.argmax(shares))
    return (
        f"of the {signal} the cell from {edges[most]:.2f} to {edges[most + 1]:.2f} V has the "
        f"largest share of the squared "
        f"error, {100 * shares[most]:.0f} %"
    )


def _own_cells(ask: Ask, name: str, x: FloatArray, other: FloatArray, e: FloatArray) -> Verdict:
    """Judge the shares over the cells of `x`, which is the raw signal of the record."""
    edges, signal = _edges(x), name.removeprefix("share_")
    y_lin = known_vector(ask, "y_lin")
    offset = as_number("y_offset", ask.known("y_offset"))

    value = ask.value(name)
    shares = np.nan_to_num(value) if isinstance(value, np.ndarray) and value.dtype.kind in "fi" else np.ones(1)
    of_all = shares.sum() < 1 - 1e-6

    def over(wrong: FloatArray, weights: FloatArray, cells: FloatArray = edges) -> FloatArray:
        """Shares of the sum over these cells or, where those handed in add up to less than 1, over all samples."""
        inside = _sorted(wrong, cells, weights)
        return np.asarray(inside / (weights.sum() if of_all else inside.sum()))

    if not np.any(shares):
        raise NoAnswer(
            f"`{name}` has nothing in any cell: no sample lies between the edges, {edges[0]:.3g} to {edges[-1]:.3g} V, "
            f"as those of `{signal}_act` do. What is sorted is what is handed over first: `{signal}_act`, with its "
            "offset.",
            "another signal sorted",
        )
    return judge(
        _shares(name, value, CELLS),
        _cells(x, e),
        close(0, 1e-3),
        "",
        f"`{name}` is not what `cell_shares` makes of `{signal}_act` and the error `e` over `edges_{signal}`.",
        [
            Slip(
                "input and output swapped", f"`{name}` holds the shares of the other signal.", lambda: _cells(other, e)
            ),
            Slip(
                "the other signal sorted",
                f"`{name}` sorts by the other signal, over the edges of this one: hand over `{signal}_act`.",
                lambda: over(other, e**2),
            ),
            *(
                Slip(
                    "model output sorted",
                    f"`{name}` sorts by the output of the linear model: the cells are those of the measured "
                    f"`{signal}_act`.",
                    partial(over, wrong, e**2),
                )
                for wrong in (y_lin, y_lin + offset)
            ),
            Slip(
                "edges of the other signal",
                f"`{name}` sorts `{signal}_act` into the cells of the other signal: hand over `edges_{signal}`.",
                lambda: over(x, e**2, _edges(other)),
            ),
            *(
                Slip(
                    "another error",
                    f"`{name}` is made of {what} in place of the error `e`.",
                    partial(over, x, np.square(wrong)),
                )
                for what, wrong in (("the output", known_vector(ask, "y")), ("the model's output", y_lin))
            ),
        ],
    )


def _edges(x: FloatArray) -> FloatArray:
    return np.linspace(x.min(), x.max(), CELLS + 1)


def _cell_slips(x: FloatArray, e: FloatArray, edges: FloatArray) -> list[Slip[FloatArray]]:
    squares, counts = _sorted(x, edges, e**2), _sorted(x, edges, np.ones(x.size))
    return [
        *_common_slips("cell_shares", squares, _sorted(x, edges, np.abs(e))),
        Slip(
            "last edge lost",
            "`cell_shares` loses the samples that lie on the last edge: they belong to the last cell.",
            lambda: _normed(_sorted(x[x < edges[-1]], edges, e[x < edges[-1]] ** 2)),
        ),
        Slip(
            "last edge lost",
            "`cell_shares` loses the samples that lie on the last edge: they belong to the last cell.",
            lambda: _sorted(x[x < edges[-1]], edges, e[x < edges[-1]] ** 2) / np.sum(e**2),
        ),
        Slip(
            "numbers of np.digitize",
            "`cell_shares` is one cell late: `np.digitize` numbers the cells from 1.",
            lambda: np.r_[0, _sorted(x, edges, e**2)[:-1] / np.sum(e**2)],
        ),
        Slip(
            "first edge lost",
            "`cell_shares` loses the samples that lie on the first edge: they belong to the first cell.",
            lambda: _normed(_sorted(x[x > edges[0]], edges, e[x > edges[0]] ** 2)),
        ),
        Slip(
            "shares of the samples",
            "`cell_shares` counts samples: the errors do not count in it. (What comes third in `np.histogram` is the "
            "range: weights are handed over by name, `weights=`.)",
            lambda: _normed(counts),
            mend="Each counts with its squared error: `weights=e**2`.",
        ),
        Slip(
            "mean for sum",
            "`cell_shares` averages within each cell, so that a rare cell counts as much as a common one. Add up.",
            lambda: _normed(squares / np.maximum(counts, 1)),
        ),
        *(
            Slip(
                "mean for sum",
                "`cell_shares` returns the mean squared error of each cell"
                + (", divided by something," if part == "scaled" else "")
                + " and not shares: add up the squares of each cell, and divide by the sum over all.",
                partial(np.copy, wrong),
            )
            for part, wrong in (
                ("", squares / np.maximum(counts, 1)),
                ("scaled", squares / np.maximum(counts, 1) / np.sum(e**2)),
                ("scaled", squares / np.maximum(counts, 1) / np.mean(e**2)),
                ("scaled", squares / x.size),
                ("", np.sqrt(squares / np.maximum(counts, 1))),
            )
        ),
        Slip(
            "errors not squared",
            "`cell_shares` adds up the errors with their signs, and they cancel. Square them.",
            lambda: _normed(_sorted(x, edges, e)),
        ),
        Slip(
            "cells of the error",
            "`cell_shares` sorts by the error. The cells are those of x.",
            lambda: _normed(_sorted(e, edges, e**2)),
        ),
        *(
            Slip(
                "x and e exchanged",
                "`cell_shares` sorts by the error, and adds up x^2: it is the other way round. The cells are those of "
                "x, and e is squared.",
                partial(np.divide, _sorted(e, edges, x**2), total),
            )
            for total in (np.sum(x**2), np.sum(_sorted(e, edges, x**2)))
        ),
        *pairs_of("`cell_shares`", _edits_of_cells(x, e, edges), partial(_cells_of, x, e, edges)),
    ]


def _edits_of_cells(x: FloatArray, e: FloatArray, edges: FloatArray) -> tuple[Edit, ...]:
    """Single mistakes in what is sorted, in what is added up and in what that is divided by."""
    return (
        Edit("sorted_by", e, "the error is sorted, and not x"),
        Edit("weights", np.abs(e), "absolute errors are added up, and not squares"),
        Edit("weights", e, "the errors are added up with their signs, and not squared"),
        Edit("weights", np.ones(e.size), "samples are counted, whatever their errors are"),
        Edit("counted", True, "the mean of each cell is taken, and not the sum"),
        Edit("total", "largest", "the sums are divided by the largest, and not by the sum of all"),
        Edit("total", "none", "the sums are not divided by that of all cells"),
        Edit("total", "samples", "the sums are divided by the number of samples, and not by the sum of all"),
    )


def _cells_of(
    x: FloatArray,
    e: FloatArray,
    edges: FloatArray,
    sorted_by: FloatArray | None = None,
    weights: FloatArray | None = None,
    counted: bool = False,
    total: str = "",
) -> FloatArray:
    """Shares of the cells with other parts in their formula."""
    by = x if sorted_by is None else sorted_by
    made = _sorted(by, edges, e**2 if weights is None else weights)
    made = made / np.maximum(_sorted(by, edges, np.ones(e.size)), 1) if counted else made
    totals = {"": made.sum(), "largest": made.max(), "none": 1.0, "samples": float(e.size)}
    return np.asarray(made / totals[total])


def _common_slips(name: str, energy: FloatArray, absolute: FloatArray) -> list[Slip[FloatArray]]:
    return [
        Slip("per cent", f"`{name}` returns per cent: shares add up to 1.", lambda: 100 * _normed(energy)),
        Slip(
            "errors not squared",
            f"`{name}` adds up absolute values. Squares are asked for: |.|^2.",
            lambda: _normed(absolute),
        ),
        Slip(
            "share of the largest",
            f"`{name}` divides by the largest value. Divide by the sum: shares add up to 1.",
            lambda: energy / energy.max(),
        ),
        Slip(
            "roots of the shares",
            f"`{name}` takes roots: the squares themselves are shared out.",
            lambda: _normed(np.sqrt(energy)),
        ),
    ]


def _judge_shares(
    name: str, got: FloatArray, energy: FloatArray, slips: list[Slip[FloatArray]], tolerance: float = 1e-6
) -> Verdict:
    return judge(
        got,
        _normed(energy),
        close(0, tolerance),
        "",
        f"`{name}` does not return the shares of the squared error, in order.",
        [
            *slips,
            Slip(
                "not shares",
                f"what `{name}` returns adds up to {got.sum():.4g}. Shares add up to 1: divide by the sum over all.",
                lambda: got.sum() * _normed(energy),
            ),
        ],
    )


def _shares(call: str, value: object, parts: int) -> FloatArray:
    if isinstance(value, tuple) and len(value) == 2 and isinstance(value[1], np.ndarray):
        raise NoAnswer(f"`{call}` is all that `np.histogram` returns: take the first of it, `[0]`.", "all of histogram")
    return as_vector(call, value, parts)  # type: ignore[arg-type]


def _normed(energy: FloatArray) -> FloatArray:
    return np.asarray(energy / energy.sum())


def _sorted(x: FloatArray, edges: FloatArray, weights: FloatArray) -> FloatArray:
    return np.asarray(np.histogram(x, edges, weights=weights)[0], float)


def _cells(x: FloatArray, e: FloatArray) -> FloatArray:
    return _normed(_sorted(x, _edges(x), e**2))


def _smoothed(white: FloatArray) -> FloatArray:
    """Coloured, so that the bands hold shares of different size."""
    smooth = white.copy()
    for k in range(1, smooth.size):
        smooth[k] += 0.8 * smooth[k - 1]
    return smooth
