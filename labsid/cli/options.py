"""Options shared by several commands of `labsid`."""

import inspect
import sys
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

_LOG = "A log: text, .mat, .xlsx, .parquet, .npz, .h5, .mf4, .tdms, .mcap, a ROS bag, a LeRobot folder"
RecordPath = Annotated[Path, typer.Argument(metavar="RECORD", help=f"{_LOG}.")]
RecordPaths = Annotated[list[Path], typer.Argument(metavar="RECORD...", help=f"{_LOG}; several are runs of one rig.")]
Output = Annotated[
    Literal["noise-reduced", "measured"],
    typer.Option("--LogData", help="Which output of LogData is y: column 2 (noise-reduced) or column 1 (measured)."),
]
FormerOutput = Annotated[str | None, typer.Option("--output", hidden=True)]
Columns = Annotated[
    str | None,
    typer.Option(metavar="NAMES", help="Columns t,u,y (or u,y with --Ts) by name or number, such as uEst,yEst or 1,2."),
]
SamplingTime = Annotated[
    float | None,
    typer.Option("--Ts", metavar="SECONDS", help="Sampling time without times, or of even samples with noisy times."),
]
TimeUnit = Annotated[
    Literal["s", "ms", "us", "ns", "min", "h", "days"] | None,
    typer.Option(help="Unit of the times, where the log does not say it."),
]
Repeated = Annotated[
    Literal["first", "last"] | None, typer.Option(help="Which of several rows with the same time is kept.")
]
Select = Annotated[
    int | None, typer.Option(min=1, metavar="RUN", help="Which run, from 1, of a log whose time starts again.")
]
Start = Annotated[float | None, typer.Option("--from", metavar="SECONDS", help="Leave out the samples before.")]
Stop = Annotated[float | None, typer.Option("--to", metavar="SECONDS", help="Leave out the samples after.")]
Resample = Annotated[
    float | None,
    typer.Option(metavar="SECONDS", help="Bring uneven samples, or signals of different rates, to this sampling time."),
]
Decimate = Annotated[
    int | None, typer.Option(min=2, metavar="N", help="Keep every N-th sample, after a low-pass filter.")
]
JsonFile = Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Also write the result to this file.")]

Inputs = Annotated[
    str | None,
    typer.Option(metavar="NAMES", help="Columns of several inputs, by name or number, such as Q1,Q2."),
]
Outputs = Annotated[str | None, typer.Option(metavar="NAMES", help="Columns of several outputs, such as T1,T2.")]
Reference = Annotated[str | None, typer.Option(metavar="NAME", help="Column of the set point of a closed loop.")]

_OF_A_LOG: dict[str, tuple[Any, Any]] = {
    "columns": (Columns, None),
    "Ts": (SamplingTime, None),
    "output": (Output, "noise-reduced"),
    "time_unit": (TimeUnit, None),
    "repeated": (Repeated, None),
    "select": (Select, None),
    "since": (Start, None),
    "until": (Stop, None),
    "resample": (Resample, None),
    "decimate": (Decimate, None),
}


_OF_SIGNALS: dict[str, tuple[Any, Any]] = {
    "inputs": (Inputs, None),
    "outputs": (Outputs, None),
    "reference": (Reference, None),
}


def reads_log(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options of a log with one input and one output, in the place of its parameter `how`.

    Parameters
    ----------
    command : callable
        Its parameter `how` is a `labsid.records.reading.Reading`.
    """
    return _with_options(command, _OF_A_LOG)


def reads_signals(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options of a log with any number of inputs and outputs; see `reads_log`.

    Parameters
    ----------
    command : callable
    """
    return _with_options(command, _OF_A_LOG | _OF_SIGNALS)


def _with_options(command: Callable[..., None], options: dict[str, tuple[Any, Any]]) -> Callable[..., None]:
    own = inspect.signature(command)

    @wraps(command)
    def with_options(*arguments: Any, **given: Any) -> None:
        from labsid.records.reading import Reading

        former = given.pop("former_output")
        if former is not None:
            given["output"] = _former_output(former)
        how = Reading(**{name: value for name, value in given.items() if name in options})
        command(*arguments, how=how, **{name: value for name, value in given.items() if name not in options})

    options_and_former = options | {"former_output": (FormerOutput, None)}
    added = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=kind)
        for name, (kind, default) in options_and_former.items()
    ]
    kept = [parameter for name, parameter in own.parameters.items() if name != "how"]
    with_options.__signature__ = own.replace(parameters=[*kept, *added])  # type: ignore[attr-defined]
    with_options.__annotations__ = {parameter.name: parameter.annotation for parameter in [*kept, *added]}
    return with_options


def _former_output(text: str) -> str:
    """The value of ``--output``, the former name of ``--LogData``, which everybody takes for a file."""
    from labsid.records.reading import OUTPUTS

    if text not in OUTPUTS:
        raise ValueError(
            f"--output names no file: it is the former name of --LogData, {' or '.join(OUTPUTS)}; got {text!r}. "
            "--help lists the options that write a file."
        )
    print("note: --output is now --LogData", file=sys.stderr)
    return text
