"""The commands of ``labsid gap`` that check the diagnosis itself, on simulated rigs whose effects it cannot see."""

import signal
from pathlib import Path
from typing import Annotated, Literal

import typer

from labsid.cli.gap_commands import gap
from labsid.cli.progress import shown_progress


def _print_rows(asked: bool) -> None:
    if asked:
        from labsid.blind.kept_answers import row_meanings

        print(row_meanings())
        raise typer.Exit


Rows = Annotated[
    bool, typer.Option("--rows", is_eager=True, callback=_print_rows, help="List the rows and what their records are.")
]
OnlyRows = Annotated[list[str] | None, typer.Option("--row", help="Only this row (see --rows); may be repeated.")]
Jobs = Annotated[int, typer.Option(min=1, help="Number of processes.")]


@gap.command("blind")
def sealed_check(
    suite: Annotated[
        Literal["dev", "final"], typer.Option(help="Set of seeds: dev for tuning, final for reporting.")
    ] = "dev",
    per_row: Annotated[int | None, typer.Option(min=1, help="Records for each row of the table.")] = None,
    row: OnlyRows = None,
    rows: Rows = False,
    jobs: Jobs = 2,
    replays: Annotated[
        int | None, typer.Option(min=0, help="Records whose exported simulation is run on new records.")
    ] = None,
    report: Annotated[Path | None, typer.Option(metavar="FILE", help="Also write the table to a file.")] = None,
    keep: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Keep the results here; a second run continues from them.")
    ] = None,
) -> None:
    """Test the diagnosis on simulated rigs. Their effects are withheld from the diagnosis.

    `labsid gap compare` compares single answers with those of an earlier version.
    """
    from labsid.blind.check import run_sealed_check

    signal.signal(signal.SIGTERM, signal.default_int_handler)  # the batch that it has started ends with it
    raise typer.Exit(
        run_sealed_check(suite=suite, per_row=per_row, rows=row, jobs=jobs, replays=replays, report=report, keep=keep)
    )


@gap.command("compare")
def compare_kept_answers(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="The kept answers, JSON.")],
    *,
    keep: Annotated[
        bool, typer.Option("--keep", help="Write the answers of this version to FILE; other rows in it stay.")
    ] = False,
    per_row: Annotated[
        int | None, typer.Option(min=1, help="With --keep: records of each row; default: 12, of some rows others.")
    ] = None,
    row: OnlyRows = None,
    rows: Rows = False,
    records: Annotated[Path | None, typer.Option(metavar="DIR", help="Folder of measured records.")] = None,
    jobs: Jobs = 2,
) -> None:
    """Compare the answers on simulated and measured records with those that an earlier version gave.

    Exit status 1 if fewer records of a row are answered rightly, or if other effects are asserted on a measured record.
    A record that is no longer the one whose answer was kept is refused (exit status 2).
    """
    from labsid.blind.kept_answers import compare_with_kept, keep_answers

    if per_row is not None and not keep:
        raise ValueError("--per-row goes with --keep: as many records are compared as were kept.")
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with shown_progress(lines=True) as progress:
        if keep:
            keep_answers(file, row, per_row, records, jobs, progress)
            return
        text, accepted = compare_with_kept(file, row, records, jobs, progress)
    print(text)
    raise typer.Exit(int(not accepted))
