"""The command ``labsid course rig``: whether a record of another rig carries the lab."""

from typing import TYPE_CHECKING, Annotated

import typer

from labsid.cli.options import RecordPath, reads_signals

if TYPE_CHECKING:  # a slow import
    from labsid.records.reading import Reading


@reads_signals
def course_rig(
    record: RecordPath,
    *,
    how: "Reading",
    simulated: Annotated[
        bool, typer.Option("--simulated", help="Students get a record made with a model that is identified from it.")
    ] = False,
) -> None:
    """Say whether a record of your own rig carries the lab, and what to record instead; exit status 1 if not."""
    from autograder.course.rig_check import check_rig
    from labsid.cli.console import print_findings
    from labsid.records.choice import UnknownColumns
    from labsid.records.formats import describe_columns

    try:
        checked = check_rig(record, how, simulated)
    except UnknownColumns:
        from labsid.cli.console import print_contents

        print_contents(str(record), describe_columns(record), "course rig")
        raise
    print_findings(checked.verdict, checked.findings)
    for line in checked.advice:
        print(f"\n{line}")
    if not checked.carries:
        raise typer.Exit(1)
