"""The command `labsid`. Slow imports are deferred until a command needs them."""

import os
import sys
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from labsid import __version__
from labsid.cli import gap_blind  # noqa: F401  adds its commands to `gap`
from labsid.cli.gap_commands import gap
from labsid.cli.home_folder import provide_home
from labsid.cli.options import JsonFile, RecordPath, RecordPaths, reads_signals
from labsid.cli.student_commands import feedback_command, lab_command, submit_command

if TYPE_CHECKING:  # a slow import
    from labsid.records.reading import Reading

_BUILT_IN = ("check", "identify", "record", "data", "gap", "lab", "submit", "feedback")
_STATUS_OF_INTERRUPT = 130
_MAX_LINE = 1000  # characters
_INSTALL = 'pip install "labsid[autograder]"'


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command.

    Parameters
    ----------
    arguments : sequence of str, optional
        Arguments after ``labsid``; by default those of this process.

    Returns
    -------
    int
        Exit status: 0 on success, 2 after a one-line error message on stderr.
    """
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # numpy's: a result says itself what is wrong with it
            provide_home()
            status = _run(arguments or ["--help"])
        sys.stdout.flush()
    except BrokenPipeError:
        # The reader closed the pipe; keep the flush at exit from failing again.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except KeyboardInterrupt:
        return _report_error("interrupted")
    except ModuleNotFoundError as error:
        return _report_error(f"this command needs more packages ({error}). Install them: {_INSTALL}")
    except OSError as error:
        file = error.filename if error.filename2 is None else error.filename2  # of a copy, the new one
        where = f"{file}: " if file is not None else ""
        return _report_error(f"{where}{error.strerror or error}")
    except ValueError as error:
        return _report_error(str(error))
    except MemoryError:
        return _report_error("there is not enough memory for this")
    except RuntimeError as error:
        if "can't start new thread" not in str(error):
            raise
        return _report_error("this machine starts no more threads; end other programs, or raise the limit (ulimit -u)")
    return status


@reads_signals
def check_command(
    record: RecordPath,
    *,
    how: "Reading",
    json_file: JsonFile = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also draw the record with its findings: FILE.png or FILE.svg.")
    ] = None,
) -> None:
    """Describe a record and report its faults; of a log whose header does not say it, the columns."""
    from labsid._files import check_writable, write_json
    from labsid.cli.console import print_check, print_contents
    from labsid.lab.record_check import check_record, to_json_dict
    from labsid.records.choice import UnknownColumns
    from labsid.records.formats import describe_columns, read_raw
    from labsid.records.record import refusal

    if plot is not None:
        from labsid.plots.style import check_figure_file, save_figure

        check_figure_file(plot)
        check_writable(plot)
    try:
        raw = read_raw(record, how)
    except UnknownColumns:
        print_contents(str(record), describe_columns(record))
        raise
    checked = check_record(raw)
    if json_file is not None:
        write_json(json_file, to_json_dict(checked))
    if plot is not None:
        from labsid.plots.record_check import figure_check

        save_figure(figure_check(raw, checked), plot)
    print_check(checked)
    if checked.faults:
        raise ValueError(refusal(record, checked.faults))


@reads_signals
def identify_command(
    record: RecordPath,
    *,
    how: "Reading",
    order: Annotated[int, typer.Option(help="Order of the model.")] = 2,
    start: Annotated[int, typer.Option(help="First sample that gets a row of Phi, from 0.")] = 2,
    coupled: Annotated[
        bool, typer.Option("--coupled", help="With several outputs: each depends on the past of the others, too.")
    ] = False,
    json_file: JsonFile = None,
    model: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also write the model here, for `labsid gap --sim`.")
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Also draw free run, Bode, step response, poles and zeros: FILE.png or FILE.svg."
        ),
    ] = None,
) -> None:
    """Identify a model from the first half of a record and verify it on the second half, as in the lab."""
    from labsid._files import check_writable, write_json
    from labsid.cli.console import identification_text
    from labsid.lab.arx import to_gap_model
    from labsid.lab.identification import identify, to_json_dict
    from labsid.records.record import read_record
    from labsid.records.several_signals import one_signal_each

    if plot is not None:
        from labsid.plots.style import check_figure_file, save_figure

        check_figure_file(plot)
        check_writable(plot)
    loaded = read_record(record, how)
    for option, path in (("--model", model), ("--plot", plot)):
        if path is not None:
            one_signal_each(loaded, option)
    if loaded.several:
        from labsid.cli.system_console import system_text
        from labsid.lab import system_identification

        system = system_identification.identify_system(loaded, order, start, coupled)
        if json_file is not None:
            write_json(json_file, system_identification.to_json_dict(system))
        print(system_text(system))
        return
    result = identify(loaded, order=order, start=start)
    if json_file is not None:
        write_json(json_file, to_json_dict(result))
    if model is not None:
        write_json(model, to_gap_model(result.model))
    if plot is not None:
        from labsid.plots.identification import figure_identification

        save_figure(figure_identification(result), plot)
    print(identification_text(result))


@reads_signals
def record_command(
    records: RecordPaths,
    *,
    how: "Reading",
    out: Annotated[Path, typer.Option(metavar="FILE", help="The record as text; of several logs, a folder.")],
) -> None:
    """Write what is read of a log as a plain record with t,u,y, which says from what and how it was read."""
    from labsid._files import check_writable, write_file
    from labsid.records.record import read_record, reading_notes
    from labsid.records.record_file import names_note, record_text

    several = len(records) > 1
    if several and len({path.stem for path in records}) < len(records):
        raise ValueError(f"two of the logs have the same name, so that their records would, in {out}. Rename one.")
    for path in records:
        target = out / f"{path.stem}.csv" if several else out
        if target.exists() and path.resolve() == target.resolve():
            raise ValueError(f"{target} is the log itself. Give the record another name with --out.")
        loaded = read_record(path, how)
        target.parent.mkdir(parents=True, exist_ok=True)
        check_writable(target)
        write_file(target, record_text(loaded, path.name).encode())
        print(f"wrote {target}: {len(loaded)} samples, one every {loaded.Ts:.9g} s")
        for note in (*reading_notes(loaded), *names_note(loaded)):
            print(f"note: {note}")


def make_data_command(
    student: Annotated[str | None, typer.Option(metavar="ID", help="Make this student's individual record.")] = None,
    secret: Annotated[
        Path | None, typer.Option(metavar="FILE", help="File with the course's secret, with --student.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Output file; by default the lab's file name.")
    ] = None,
) -> None:
    """Make the lab's record with a simulated rig: the stand-in, or an individual one."""
    from labsid._files import write_file
    from labsid.rig import lab_record_bytes, make_lab_record, read_secret

    log = make_lab_record(student, None if secret is None else read_secret(secret))
    path = Path(f"{log.name}.mat") if out is None else out
    if path.suffix.lower() != ".mat":
        raise ValueError(f"--out must end in .mat; got {path.name!r}. Rename it to {path.stem}.mat.")
    if out is None and path.exists():
        raise ValueError(f"{path} already exists and is not overwritten. Name another file with --out.")
    write_file(path, lab_record_bytes(log))
    print(f"wrote {path}: {log.t.size} samples, one every {log.Ts:g} s")


def _run(arguments: list[str]) -> int:
    """Parse the arguments, run the command and return the exit status."""
    # Commands of other packages are loaded only if needed, because importing them can be slow.
    app = _make_app(with_contributed=arguments[0] not in _BUILT_IN)
    try:
        status = typer.main.get_command(app).main(args=arguments, prog_name="labsid", standalone_mode=False)
    except typer.Abort:
        raise KeyboardInterrupt from None
    except Exception as error:
        if not hasattr(error, "format_message"):  # identifies usage errors in all versions of typer
            raise
        return _explain_usage(error)
    if status == _STATUS_OF_INTERRUPT:
        raise KeyboardInterrupt
    return status if isinstance(status, int) else 0


def _make_app(with_contributed: bool) -> typer.Typer:
    # With rich, --help takes 0.8 s instead of 0.2 s.
    app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
    app.callback()(_labsid)
    app.command("check")(check_command)
    app.command("identify")(identify_command)
    app.command("record")(record_command)
    data = typer.Typer(rich_markup_mode=None, help="Make records.")
    data.command("make")(make_data_command)
    app.add_typer(data, name="data")
    app.add_typer(gap, name="gap")
    app.command("lab")(lab_command(lambda: _run(["course", "build"])))
    app.command("submit")(submit_command)
    app.command("feedback")(feedback_command)
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
    """System identification for teaching: records, identification, gap diagnosis and grading."""


def _add_contributed(app: typer.Typer) -> None:
    """Add the commands of other packages; an entry point is a command group (a Typer) or a command (a function)."""
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
    if "\n" in message:  # a group without a command; the message is its help text
        print(message, file=sys.stderr)
        return 2
    context = getattr(error, "ctx", None)
    command = context.command_path if context is not None else "labsid"
    return _report_error(f"{message.rstrip('.')}. See {command} --help.")


def _report_error(message: str) -> int:
    line = " ".join(message.split())
    if len(line) > _MAX_LINE:  # such as the names of thousands of columns
        line = f"{line[: _MAX_LINE - 1]}…"
    print(f"labsid: error: {line}", file=sys.stderr)
    return 2
