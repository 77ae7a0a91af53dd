"""Text output of the command `labsid`."""

import os
import shlex
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from labsid._texts import wrapped

if TYPE_CHECKING:  # slow imports, and a command needs only one of them
    from labsid._arrays import FloatArray
    from labsid.lab.findings import Finding
    from labsid.lab.identification import Identification
    from labsid.lab.record_check import RecordCheck
    from labsid.records.contents import ColumnSummary

_BOLD, _NORMAL = "\033[1m", "\033[0m"
_COLOURS = {"ok": "green", "note": "cyan", "warning": "yellow", "refused": "red"}


def print_report(text: str) -> None:
    """Print a report; on a terminal its headline, the lines before the first empty one, is bold."""
    headline, empty, rest = text.partition("\n\n")
    plain = not sys.stdout.isatty() or "NO_COLOR" in os.environ or os.environ.get("TERM") == "dumb"
    print(text if plain else f"{_BOLD}{headline}{_NORMAL}{empty}{rest}")


def print_check(check: "RecordCheck") -> None:
    """Print the check of a record: the verdict, then one line per finding."""
    print_findings(check.verdict, check.findings)


def print_findings(verdict: str, findings: "Sequence[Finding]") -> None:
    """Print a verdict, then one line per finding."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console(highlight=False)
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    for finding in findings:
        table.add_row(Text(finding.level, style=_COLOURS[finding.level]), finding.topic, Text(finding.text))
    with console.capture() as capture:
        console.print(Text(verdict, style="bold"))
        console.print()
        console.print(table)
    # rich pads the last column with blanks.
    print("\n".join(line.rstrip() for line in capture.get().splitlines()))


def print_contents(name: str, summaries: "Sequence[ColumnSummary]", command: str = "check") -> None:
    """Print a row for each column of a log, and the line to type with a command that reads one input and one output."""
    from rich.table import Table

    from labsid._tables import print_table
    from labsid.records.contents import options_of_several, suggested_options

    titles = ("column", "unit", "samples", "every", "from", "to", "missing", "looks like", "why")
    rows = [
        (
            summary.name,
            summary.unit,
            str(summary.samples),
            "" if summary.interval is None else f"{summary.interval:.6g} s",
            "" if summary.low is None else f"{summary.low:.6g}",
            "" if summary.high is None else f"{summary.high:.6g}",
            f"{summary.missing:.1%}" if summary.missing else "",
            summary.role,
            summary.why,
        )
        for summary in summaries
    ]
    table = Table(*titles, box=None)
    for row in rows:
        table.add_row(*row)
    print_table(table)
    print(f"\nType: labsid {command} {shlex.join([name, *suggested_options(summaries)])}")
    several = options_of_several(summaries) if command == "check" else []
    print(f"or, with all signals: labsid check {shlex.join([name, *several])}\n" if several else "")


def identification_text(identification: "Identification") -> str:
    """Render an identification as plain text.

    Parameters
    ----------
    identification : Identification

    Returns
    -------
    str
        Offsets, parameters, the model as printed by python-control, errors of the free runs, a verdict and warnings.
    """
    from labsid.lab.arx import to_ss, to_tf
    from labsid.records.record import reading_notes
    from labsid.records.signal_quality import digits_of

    record, model, fit = identification.record, identification.model, identification.fit
    offsets, rows, runs = identification.offsets, identification.regression, identification.verification
    symbols = [f"-a{i + 1}" for i in range(model.order)] + [f"b{i + 1}" for i in range(model.order)]
    theta = theta_texts(fit.theta, fit.stderr)
    lines = [
        f"{record.name}: {len(record)} samples, Ts = {record.Ts:.9g} s",
        *(wrapped(f"Read: {note}.") for note in reading_notes(record)),
        "",
        f"u_offset = {digits_of(offsets.u_offset, np.ptp(record.u), 6)}, the first input",
        f"y_offset = {offsets.y_offset:.8f}, the mean of samples {offsets.settled[0]} to {offsets.settled[1] - 1}",
        wrapped(
            f"Phi: rows k = {rows.start} to {rows.stop - 1} of the first half, "
            f"condition number {fit.condition_number:.2f}"
        ),
        *_left_out(identification),
        "",
        "theta, ± one standard error",
        *(f"  {symbol:<4}{text}" for symbol, text in zip(symbols, theta, strict=True)),
        "",
        str(to_tf(model)).strip(),
        "",
        str(to_ss(model)).strip(),
        "",
        "mean squared error of the free run",
        f"  whole record, from rest               {runs.mse_all:.5e}",
        f"  second half, from rest                {runs.mse_second_half:.5e}",
        f"  second half, state carried over       {runs.mse_second_half_carried:.5e}",
        f"  second half, initial state estimated  {runs.mse_second_half_estimated:.5e}",
        "",
        *(wrapped(line) for line in _verdict(identification)),
        *(wrapped(f"Warning: {warning}.") for warning in identification.warnings),
    ]
    return "\n".join(lines)


def theta_texts(values: "FloatArray", errors: "FloatArray") -> list[str]:
    """Estimates with their standard errors, the signs ± in one column; those within two errors of zero are marked.

    Parameters
    ----------
    values, errors : ndarray, shape (p,)
    """
    from labsid.gap.reports.quantities import with_error

    texts = [
        with_error(float(value), float(error)).partition(" ± ") for value, error in zip(values, errors, strict=True)
    ]
    widest = [max(len(text[part].lstrip("-")) for text in texts) for part in (0, 2)]
    lines = []
    for value, error, (number, sign, spread) in zip(values, errors, texts, strict=True):
        text = f"{'-' if number.startswith('-') else ' '}{number.lstrip('-'):<{widest[0]}}{sign}{spread:<{widest[1]}}"
        lines.append(f"{text}  not told from zero" if abs(value) < 2.0 * error else text.rstrip())
    return lines


def _left_out(identification: "Identification") -> list[str]:
    count = identification.incomplete_rows
    return [f"     {count} of these rows left out: an output in them is missing from the record"] if count else []


def _verdict(identification: "Identification") -> list[str]:
    """Describe the model's accuracy on the data not used in the fit, its gain and its time constant."""
    model, runs = identification.model, identification.verification
    unseen = identification.y[runs.half :]
    unseen = unseen[~np.isnan(unseen)]
    error, from_rest = np.sqrt([runs.mse_second_half_carried, runs.mse_second_half])
    lines = []
    if np.ptp(unseen) > 0:
        fit = 1 - error / np.std(unseen)
        words = {0.9: "closely", 0.7: "roughly", 0.0: "poorly"}
        how = next((word for least, word in words.items() if fit >= least), "worse than a constant")
        lines.append(
            f"Fitted to the first half, the order-{model.order} model follows the second half {how}: "
            f"{error:.3g} rms, {error / np.ptp(unseen):.1%} of the range of the output there (fit {fit:.1%})."
        )
    if from_rest > 2 * error:
        lines.append(
            f"From rest the error is {from_rest:.3g} rms, because the rig is not at rest at sample {runs.half}: "
            "carry the state over from the first half, or estimate it."
        )
    pole = model.poles[0]
    if model.is_stable and pole != 0:
        gain, tau = model.b.sum() / model.a.sum(), -model.Ts / np.log(np.abs(pole))
        lines.append(f"It is stable, with static gain {gain:.4g} and longest time constant {tau:.3g} s.")
    return lines
