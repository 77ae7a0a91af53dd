"""The group ``labsid gap``: why a simulation and a real rig disagree. Thin: parse, call, print."""

import shlex
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Literal

import typer

from labsid.cli.options import Columns, Output, RecordPath, SamplingTime

gap = typer.Typer(
    rich_markup_mode=None,
    no_args_is_help=True,
    help="Say why a simulation and a rig disagree, and mend the simulation.",
)

_WRITTEN = ("json_file", "html", "export")

Seed = Annotated[int, typer.Option(min=0, help="Of the resampling behind the intervals.")]


@gap.command()
def diagnose(
    context: typer.Context,
    record: RecordPath,
    holdout: Annotated[
        Path | None, typer.Option(metavar="RECORD2", help="Another record of the same rig, to score on.")
    ] = None,
    sim: Annotated[
        Path | None, typer.Option(metavar="MODEL", help="MODEL.json, an exported simulation, or a .csv with t,y.")
    ] = None,
    order: Annotated[int, typer.Option(help="Order of the fitted simulation, without --sim.")] = 2,
    json_file: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Write the answer here.")] = None,
    html: Annotated[Path | None, typer.Option(metavar="FILE", help="Write the report page here.")] = None,
    export: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the simulation with the effect in it here.")
    ] = None,
    exclude: Annotated[
        list[str] | None, typer.Option(metavar="T0:T1", help="Stretch of time, in seconds, that does not count.")
    ] = None,
    seed: Seed = 0,
    output: Output = "noise-reduced",
    columns: Columns = None,
    holdout_columns: Annotated[
        str | None, typer.Option(metavar="NAMES", help="Columns of RECORD2, where they are others.")
    ] = None,
    Ts: SamplingTime = None,
) -> None:
    """Say where the gap between a simulation and a record lies, what causes it, and how much adding it closes."""
    from labsid._files import check_writable, write_json
    from labsid.gap.diagnosis import diagnose as answer
    from labsid.gap.simulation_files import load_simulation
    from labsid.gap.text_report import format_report
    from labsid.records.record import load_record

    written = [path for path in (json_file, html, export) if path is not None]
    for number, path in enumerate(written):
        check_writable(path)
        _refuse_overwriting(path, [record, holdout, sim, *written[:number]])
    stretches = [_stretch(text) for text in exclude or ()]
    loaded = load_record(record, output=output, columns=columns, Ts=Ts, allow_jitter=True)
    other = None
    if holdout is not None:
        other = load_record(holdout, output=output, columns=holdout_columns or columns, Ts=Ts, allow_jitter=True)
    simulation = None if sim is None else load_simulation(sim, loaded)
    with _progress() as progress:
        found = answer(
            loaded,
            simulation,
            holdout=other,
            order=order,
            exclude=stretches,
            seed=seed,
            progress=progress,
        )
    found.report["command"] = _command(context)
    if json_file is not None:
        write_json(json_file, found.report)
    if export is not None:
        write_json(export, found.model.to_json_dict())
    if html is not None:
        from labsid.gap.html_report import write_html_report

        write_html_report(html, found.report)
    print(format_report(found.report))


@gap.command()
def batch(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder with records (.csv, .mat).")],
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for the answers.")],
    jobs: Annotated[int | None, typer.Option(min=1, help="Records at a time; as many as there are cores.")] = None,
    seed: Seed = 0,
) -> None:
    """Diagnose every record of a folder. Run again to go on where it stopped."""
    from labsid.gap.batch import diagnose_folder

    try:
        with _progress(lines=True) as progress:
            summary = diagnose_folder(folder, out, jobs=jobs, seed=seed, progress=progress)
    except KeyboardInterrupt:
        raise ValueError(f"interrupted; the finished answers are in {out}. Run it again to go on.") from None
    print(summary)


@gap.command()
def simulate(
    model: Annotated[Path, typer.Argument(metavar="MODEL", help="MODEL.json or an exported simulation.")],
    record: RecordPath,
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="Write t,u,y,y_sim here.")] = None,
    output: Output = "noise-reduced",
    columns: Columns = None,
    Ts: SamplingTime = None,
) -> None:
    """Play a simulation on a record's input, its initial state estimated from the first 50 samples."""
    from labsid.gap.clock import clock_findings
    from labsid.gap.simulation_files import replay, write_replay
    from labsid.records.record import load_record

    loaded = load_record(record, output=output, columns=columns, Ts=Ts, allow_jitter=True)
    played = replay(model, loaded)
    if out is not None:
        write_replay(out, loaded, played.y)
    print(f"{len(loaded)} samples, free run: rmse {played.rmse:.6g} behind the first {played.start} samples")
    for finding in clock_findings(loaded):
        print(f"note: {finding.text}")


@gap.command()
def blind(
    suite: Annotated[Literal["dev", "final"], typer.Option(help="The seeds: dev for tuning, final to report.")] = "dev",
    per_row: Annotated[int | None, typer.Option(min=1, help="Records in each row of the table.")] = None,
    row: Annotated[list[str] | None, typer.Option(help="Only this row; may be given again.")] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Records at a time.")] = 2,
    replays: Annotated[
        int | None, typer.Option(min=0, help="Records whose exported simulation is played on fresh ones.")
    ] = None,
    report: Annotated[Path | None, typer.Option(metavar="FILE", help="Also write the table here.")] = None,
) -> None:
    """Check the diagnosis on simulated rigs whose effect is withheld, and print the table."""
    from labsid.blind.check import run_sealed_check

    raise typer.Exit(
        run_sealed_check(suite=suite, per_row=per_row, rows=row, jobs=jobs, replays=replays, report=report)
    )


def _command(context: typer.Context) -> str:
    """The line that asks for this diagnosis again: files by their names, what is written left out but for the page."""
    words = ["labsid", "gap", "diagnose"]
    for parameter in context.command.params:
        name, value = str(parameter.name), context.params[str(parameter.name)]
        source = context.get_parameter_source(name)
        if source is None or source.name != "COMMANDLINE" or name in _WRITTEN:
            continue
        for one in value if isinstance(value, list | tuple) else [value]:
            words += [] if parameter.param_type_name == "argument" else [parameter.opts[0]]
            words.append(one.name if isinstance(one, Path) else str(one))
    return shlex.join([*words, "--html", "report.html"])


def _refuse_overwriting(path: Path, others: list[Path | None]) -> None:
    """Or a result would take the place of what it is made from, or of another result."""
    device = path.exists() and not path.is_file()
    if not device and any(other is not None and path.resolve() == other.resolve() for other in others):
        raise ValueError(f"{path} is named twice: it is read, or written, already. Give every file a name of its own.")


def _stretch(text: str) -> tuple[float, float]:
    start, colon, stop = text.partition(":")
    try:
        span = (float(start), float(stop))
    except ValueError:
        span = (0.0, 0.0)
    if not colon or not span[0] < span[1]:
        raise ValueError(f"--exclude must be T0:T1 in seconds with T0 < T1; got {text!r}. Write 12.5:30.")
    return span


@contextmanager
def _progress(lines: bool = False) -> Iterator[Callable[[str, float], None] | None]:
    """A progress bar on a terminal; elsewhere now and then a line, or nothing."""
    if not sys.stderr.isatty():
        yield _line_by_line() if lines else None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("baseline", total=1.0)
        yield lambda what, share: bar.update(task, description=what, completed=share)


def _line_by_line() -> Callable[[str, float], None]:
    """A line on stderr for every twentieth of the way."""
    told = -1

    def tell(what: str, share: float) -> None:
        nonlocal told
        if int(20 * share) > told:
            told = int(20 * share)
            print(what, file=sys.stderr, flush=True)

    return tell
