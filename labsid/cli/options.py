"""Options shared by several commands of `labsid`."""

from pathlib import Path
from typing import Annotated, Literal

import typer

RecordPath = Annotated[Path, typer.Argument(metavar="RECORD", help="A .mat with LogData, or text with t,u,y.")]
RecordPaths = Annotated[
    list[Path],
    typer.Argument(metavar="RECORD...", help="A .mat with LogData, or text with t,u,y; several are runs of one rig."),
]
Output = Annotated[
    Literal["noise-reduced", "measured"],
    typer.Option(help="Which output of LogData is y: column 2 (noise-reduced) or column 1 (measured)."),
]
Columns = Annotated[
    str | None,
    typer.Option(metavar="NAMES", help="Columns t,u,y (or u,y with --Ts) by name or number, such as uEst,yEst or 1,2."),
]
SamplingTime = Annotated[
    float | None, typer.Option("--Ts", metavar="SECONDS", help="Sampling time of a file without time.")
]
JsonFile = Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Also write the result to this file.")]
