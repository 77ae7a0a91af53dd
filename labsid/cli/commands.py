"""The `labsid` command: parse, call, print. Every import that costs time waits until its command runs."""

import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated

import typer

from labsid import __version__
from labsid.cli.gap_commands import gap
from labsid.cli.options import Columns, JsonFile, Output, RecordPath, SamplingTime

_OWN = ("check", "identify", "data", "gap")
_TYPERS_STATUS_OF_CTRL_C = 130
_INSTALL = 'pip install "labsid[autograder]"'


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command.

    Parameters
    ----------
    arguments : sequence of str, optional
        What follows ``labsid`` on the command line; that of this process unless given.

    Returns
    -------
    int
        Exit status: 0, or 2 after one line on stderr that says what is wrong.
    """
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    try:
        status = _run(arguments or ["--help"])
        sys.stdout.flush()
    except BrokenPipeError:
        # Whoever read the output has seen enough; the flush at exit must not fail once more.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except KeyboardInterrupt:
        return _complain("interrupted")
    except ModuleNotFoundError as error:
        return _complain(f"this command needs more packages ({error}). Install them: {_INSTALL}")
    except OSError as error:
        where = f"{error.filename}: " if error.filename is not None else ""
        return _complain(f"{where}{error.strerror or error}")
    except ValueError as error:
        return _complain(str(error))
    return status


def check(
    record: RecordPath,
    json_file: JsonFile = None,
    output: Output = "noise-reduced",
    columns: Columns = None,
    Ts: SamplingTime = None,
) -> None:
    """Describe what is in a record and what is wrong with it."""
    from labsid._files import write_json
    from labsid.cli.console import print_check
    from labsid.lab.record_check import check_record, to_json_dict
    from labsid.records.formats import read_raw
    from labsid.records.record import refusal

    checked = check_record(read_raw(record, output=output, columns=columns, Ts=Ts))
    if json_file is not None:
        write_json(json_file, to_json_dict(checked))
    print_check(checked)
    if checked.faults:
        raise ValueError(refusal(record, checked.faults))


def identify(
    record: RecordPath,
    order: Annotated[int, typer.Option(help="Order of the model.")] = 2,
    start: Annotated[int, typer.Option(help="First sample that gets a row of Phi, from 0.")] = 2,
    json_file: JsonFile = None,
    model: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also write the model here, for `labsid gap --sim`.")
    ] = None,
    output: Output = "noise-reduced",
    columns: Columns = None,
    Ts: SamplingTime = None,
) -> None:
    """Identify a model from the first half of a record and verify it on the rest: the lab's whole procedure."""
    from labsid._files import write_json
    from labsid.cli.console import identification_text
    from labsid.lab import identification as identification
    from labsid.lab.arx import to_gap_model
    from labsid.records.record import load_record

    loaded = load_record(record, output=output, columns=columns, Ts=Ts)
    result = identification.identify(loaded, order=order, start=start)
    if json_file is not None:
        write_json(json_file, identification.to_json_dict(result))
    if model is not None:
        write_json(model, to_gap_model(result.model))
    print(identification_text(result))


def make_data(
    student: Annotated[str | None, typer.Option(metavar="ID", help="Whose own record to make.")] = None,
    secret: Annotated[
        Path | None, typer.Option(metavar="FILE", help="File with the course's secret, with --student.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Where to write it; unless given, under the lab's name.")
    ] = None,
) -> None:
    """Make the lab's record from a simulated rig: the stand-in for everybody, or one student's own."""
    from labsid._files import write_file
    from labsid.rig import lab_record_bytes, make_lab_record, read_secret

    log = make_lab_record(student, None if secret is None else read_secret(secret))
    path = Path(f"{log.name}.mat") if out is None else out
    if path.suffix.lower() != ".mat":
        raise ValueError(f"--out must end in .mat; got {path.name!r}. Call it {path.stem}.mat.")
    if out is None and path.exists():
        raise ValueError(f"{path} is there already; it is not overwritten. Name a file with --out.")
    write_file(path, lab_record_bytes(log))
    print(f"wrote {path}: {log.t.size} samples, one every {log.Ts:g} s")


def _run(arguments: list[str]) -> int:
    """Parse and call; the exit status."""
    # Commands of other packages are loaded only where one may be meant: that can take longer than our own run.
    app = _make_app(with_contributed=arguments[0] not in _OWN)
    try:
        status = typer.main.get_command(app).main(args=arguments, prog_name="labsid", standalone_mode=False)
    except typer.Abort:
        raise KeyboardInterrupt from None
    except Exception as error:
        if not hasattr(error, "format_message"):  # what typer's errors of usage have in common over its versions
            raise
        return _explain_usage(error)
    if status == _TYPERS_STATUS_OF_CTRL_C:
        raise KeyboardInterrupt
    return status if isinstance(status, int) else 0


def _make_app(with_contributed: bool) -> typer.Typer:
    # With rich, help would take 0.8 s instead of 0.2 s.
    app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
    app.callback()(_labsid)
    app.command()(check)
    app.command()(identify)
    data = typer.Typer(rich_markup_mode=None, help="Make records.")
    data.command("make")(make_data)
    app.add_typer(data, name="data")
    app.add_typer(gap, name="gap")
    if with_contributed:
        _add_contributed(app)
    return app


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"labsid {__version__}")
        raise typer.Exit


def _labsid(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and stop.")
    ] = False,
) -> None:
    """System identification, from a lab record to a graded student."""


def _add_contributed(app: typer.Typer) -> None:
    """Add the commands of other packages: an entry point is a group (a Typer) or one command (a function)."""
    from importlib.metadata import entry_points

    for point in sorted(entry_points(group="labsid.commands"), key=lambda point: point.name):
        try:
            command = point.load()
        except ImportError as error:
            settings = {"allow_extra_args": True, "ignore_unknown_options": True}
            app.command(point.name, context_settings=settings)(_not_installed(error))
            continue
        if isinstance(command, typer.Typer):
            command.rich_markup_mode = None
            app.add_typer(command, name=point.name)
        else:
            app.command(point.name)(command)


def _not_installed(error: ImportError) -> Callable[[], None]:
    def command() -> None:
        """Not installed."""
        raise ModuleNotFoundError(str(error))

    command.__doc__ = f"(not installed: {_INSTALL})"
    return command


def _explain_usage(error: Exception) -> int:
    message = error.format_message()  # type: ignore[attr-defined]
    if "\n" in message:  # a group called without a command: its help
        print(message, file=sys.stderr)
        return 2
    context = getattr(error, "ctx", None)
    command = context.command_path if context is not None else "labsid"
    return _complain(f"{message.rstrip('.')}. See {command} --help.")


def _complain(message: str) -> int:
    print(f"labsid: error: {' '.join(message.split())}", file=sys.stderr)
    return 2
