"""The command group ``labsid gap``."""

import shlex
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Annotated

import typer

from labsid.cli.options import RecordPath, RecordPaths, reads_log, reads_signals
from labsid.cli.progress import shown_progress

if TYPE_CHECKING:  # a slow import
    from labsid.gap.reports.result import Diagnosis
    from labsid.gap.signals.result import SignalsDiagnosis
    from labsid.gap.simulations.simulation_files import Ports
    from labsid.records.reading import Reading
    from labsid.records.record import Record

gap = typer.Typer(
    rich_markup_mode=None,
    no_args_is_help=True,
    help="Diagnose the gap between a simulation and a rig, and correct the simulation.",
)

_OUTPUT_OPTIONS = ("json_file", "html", "export", "why")

Inputs = Annotated[str | None, typer.Option(metavar="NAME", help="Actuators of FILE.xml, or columns.")]
Outputs = Annotated[str | None, typer.Option(metavar="NAME", help="Joints or sensors of FILE.xml, or columns.")]
MatchText = Annotated[
    str | None,
    typer.Option(
        "--match",
        metavar="y=F,...",
        help="Bring the log to FILE.xml: y=57.3 per unit, zero=, u= per unit, shift= samples.",
    ),
]
Trust = Annotated[bool, typer.Option("--trust", help="Let FILE.xml read files outside its folder, and load plugins.")]
Seed = Annotated[int, typer.Option(min=0, help="Random seed of the confidence intervals.")]


@gap.command()
@reads_signals
def diagnose(
    context: typer.Context,
    records: RecordPaths,
    *,
    how: "Reading",
    holdout: Annotated[
        Path | None, typer.Option(metavar="RECORD2", help="Another record of the same rig, for scoring.")
    ] = None,
    sim: Annotated[
        Path | None,
        typer.Option(
            metavar="MODEL",
            help="MODEL.json, an exported simulation, FILE.py:FUNCTION or :CLASS, FILE.fmu, FILE.xml, or a .csv t,y.",
        ),
    ] = None,
    free: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,...",
            help="Numbers of FILE.py:FUNCTION or FILE.fmu that may be fitted; with a range as NAME=0:5.",
        ),
    ] = None,
    match: MatchText = None,
    trust: Trust = False,
    evaluations: Annotated[
        int | None,
        typer.Option(min=1, metavar="N", help="End the search after N runs of FILE.py:FUNCTION or FILE.fmu."),
    ] = None,
    order: Annotated[int, typer.Option(help="Order of the fitted model if --sim is not given.")] = 2,
    json_file: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Write the report as JSON.")] = None,
    html: Annotated[Path | None, typer.Option(metavar="FILE", help="Write the report as HTML.")] = None,
    export: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Write the corrected simulation: JSON, a Python module (.py), or an FMU (.fmu)."
        ),
    ] = None,
    exclude: Annotated[
        list[str] | None, typer.Option(metavar="T0:T1", help="Times in seconds to exclude; may be repeated.")
    ] = None,
    units: Annotated[
        str | None,
        typer.Option(metavar="U,Y", help="Units of input and output, or of all signals in order, such as V,mm."),
    ] = None,
    why: Annotated[
        bool, typer.Option("--why", help="Also print each gate of the verdict, and what was not taken.")
    ] = False,
    seed: Seed = 0,
    jobs: Annotated[int | None, typer.Option(min=1, help="Number of processes; default: one for each core.")] = None,
    holdout_columns: Annotated[
        str | None, typer.Option(metavar="NAMES", help="Columns of RECORD2, if different.")
    ] = None,
) -> None:
    """Locate the gap and find its cause. Reports the share of the gap that a correction closes.

    With --sim FILE.xml, --inputs and --outputs name its actuators, and its joints or sensors. Several of them are also
    the columns of the record.
    """
    from labsid._cores import available_cores
    from labsid._files import check_writable, write_json
    from labsid.cli.console import print_report
    from labsid.gap import diagnosis
    from labsid.gap.reports.quantities import with_units
    from labsid.gap.simulations.simulation_files import load_simulation
    from labsid.records.record import read_record
    from labsid.simulators.mjcf.sources import is_mjcf
    from labsid.simulators.sources import source_file

    written = [path for path in (json_file, html, export) if path is not None]
    for number, path in enumerate(written):
        check_writable(path)
        _refuse_overwriting(path, [*records, holdout, None if sim is None else source_file(sim), *written[:number]])
    if export is not None and export.suffix.lower() == ".fmu":
        from labsid.gap.simulations.fmu_export import check_fmu_export

        check_fmu_export()
    is_model = sim is not None and is_mjcf(str(sim))
    how, ports = _read_as(how, sim, trust)
    excluded = [_time_range(text) for text in exclude or ()]
    how_matched = _matcher(match)
    loaded = [how_matched(read_record(path, how)) for path in records]
    other_record = None
    if holdout is not None:
        other_record = how_matched(read_record(holdout, replace(how, columns=holdout_columns or how.columns)))
    several = any(record.several for record in loaded)
    if several and export is not None:
        _check_export_of_several(export, sim)
    stated = None if units is None or several else _units(units)
    if units is not None and several:
        loaded = [_with_signal_units(record, units) for record in loaded]
    simulation = None if sim is None else load_simulation(sim, loaded[0], len(loaded) > 1, ports)
    with shown_progress(stages=True) as progress:
        diagnosed = diagnosis.diagnose(
            loaded,
            simulation,
            free=[name.strip() for name in free.split(",")] if free else (),
            holdout=other_record,
            order=order,
            exclude=excluded,
            seed=seed,
            evaluations=evaluations,
            why=why,
            jobs=jobs or available_cores(),
            progress=progress,
        )
    summary = diagnosed.summary | {"command": _command_line(context)}
    diagnosed = diagnosed.with_summary(summary if stated is None else with_units(summary, *stated))
    if json_file is not None:
        write_json(json_file, diagnosed.report)
    if html is not None:
        from labsid.gap.reports.html_report import write_html_report

        write_html_report(html, diagnosed.report)
    print_report(str(diagnosed))
    if isinstance(diagnosed, diagnosis.Diagnosis) and diagnosed.why is not None:
        from labsid.cli.gap_why import format_why

        print(format_why(diagnosed.why))
    if export is not None:  # last: of a simulated output that no model reproduces there is no simulation to write
        if isinstance(diagnosed, diagnosis.Diagnosis) or is_model:
            _write_simulation(export, diagnosed)
        else:
            _write_system(export, diagnosed)


@gap.command("batch")
@reads_log
def diagnose_batch(
    folder: Annotated[
        Path,
        typer.Argument(metavar="DIR", help="Folder of records (.csv, .mat ...), and of folders of runs of one rig."),
    ],
    *,
    how: "Reading",
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for the reports.")],
    jobs: Annotated[int | None, typer.Option(min=1, help="Number of processes; default: one for each core.")] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Run on the workers of a Dask scheduler, such as tcp://HOST:8786."),
    ] = None,
    html: Annotated[bool, typer.Option("--html", help="Also write each report as HTML.")] = False,
    seed: Seed = 0,
) -> None:
    """Diagnose every record of a folder, and each sub-folder as one rig. Run again to continue an interrupted run."""
    from labsid.gap.batches.batch import diagnose_folder

    try:
        with shown_progress(lines=True) as progress:
            summary = diagnose_folder(folder, out, jobs, seed, progress, scheduler, html, how)
    except KeyboardInterrupt:
        raise ValueError(
            f"interrupted; the finished reports are in {out}. Run the command again to continue."
        ) from None
    print(summary)


@gap.command("limits")
@reads_log
def show_limits(
    record: RecordPath,
    *,
    how: "Reading",
    sim: Annotated[
        Path | None,
        typer.Option(metavar="MODEL", help="MODEL.json, an exported simulation, FILE.py:FUNCTION or FILE.fmu."),
    ] = None,
    free: Annotated[
        str | None,
        typer.Option(metavar="NAME,...", help="Numbers of FILE.py:FUNCTION or FILE.fmu that may be fitted."),
    ] = None,
    planned: Annotated[
        Path | None,
        typer.Option(
            "--input", metavar="NEXT.csv", help="A planned input, t,u: what a record with it would show, not RECORD."
        ),
    ] = None,
    test: Annotated[
        int, typer.Option(min=0, metavar="M", help="Plant each effect M times at 1.5 times its size, and diagnose it.")
    ] = 0,
    order: Annotated[int, typer.Option(help="Order of the fitted model if --sim is not given.")] = 2,
    json_file: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Write the limits as JSON.")] = None,
    units: Annotated[
        str | None, typer.Option(metavar="U,Y", help="Units of input and output for the table, such as V,mm.")
    ] = None,
    seed: Seed = 0,
) -> None:
    """Show the smallest effects that a record could have shown, or a planned one will."""
    from labsid._files import check_writable, write_json
    from labsid.gap import diagnosis
    from labsid.gap.reports.text_report import format_limits
    from labsid.gap.simulations.simulation_files import load_simulation
    from labsid.records.planned_input import load_planned_input
    from labsid.records.record import read_record
    from labsid.simulators.sources import source_file

    if json_file is not None:
        check_writable(json_file)
        _refuse_overwriting(json_file, [record, planned, None if sim is None else source_file(sim)])
    stated = None if units is None else _units(units)
    loaded = read_record(record, how)
    following = None if planned is None else load_planned_input(planned)
    with shown_progress(stages=True) as progress:
        limits = diagnosis.find_limits(
            loaded,
            None if sim is None else load_simulation(sim, loaded, False),
            free=[name.strip() for name in free.split(",")] if free else (),
            order=order,
            planned=following,
            tests=test,
            seed=seed,
            progress=progress,
        )
    if stated is not None:
        limits |= {"units": dict(zip("uy", stated, strict=True))}
    if json_file is not None:
        write_json(json_file, limits)
    print(format_limits(limits))


@gap.command()
@reads_log
def simulate(
    model: Annotated[
        Path,
        typer.Argument(
            metavar="MODEL",
            help="MODEL.json, an exported simulation, FILE.py:FUNCTION or :CLASS, FILE.fmu or FILE.xml.",
        ),
    ],
    record: RecordPath,
    *,
    how: "Reading",
    inputs: Inputs = None,
    outputs: Outputs = None,
    match: MatchText = None,
    trust: Trust = False,
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="Write t,u,y,y_sim as CSV.")] = None,
) -> None:
    """Simulate a model on a record's input. Its initial state is estimated from the first samples.

    These are two of its slowest time constants, at least 50 samples and at most a quarter of the record.
    """
    from labsid.gap.joints.arm_diagnosis import replay_joints
    from labsid.gap.record.clock import clock_findings
    from labsid.gap.signals.signals_replay import exported_system, names_in, replay_signals, write_signals_replay
    from labsid.gap.simulations.simulation_files import replay, write_replay
    from labsid.records.record import between_outputs, read_record
    from labsid.simulators.mjcf.sources import is_mjcf
    from labsid.simulators.process import open_in_process

    content = None
    if not is_mjcf(str(model)) and (inputs is None) == (outputs is None):  # the columns of a record
        content = exported_system(model)
        named = (None, None) if content is None else names_in(content)
        how = replace(how, inputs=inputs or named[0], outputs=outputs or named[1])
        inputs = outputs = None
    ports = _ports(inputs, outputs, trust)
    if is_mjcf(str(model)) and ports.several:
        how = replace(how, inputs=inputs, outputs=outputs)
    loaded = between_outputs(_matcher(match)(read_record(record, how)))
    if loaded.several or content is not None:
        if is_mjcf(str(model)):
            replayed = replay_joints(open_in_process(ports.of(model)), loaded)
        else:
            replayed = replay_signals(model, loaded)
        if out is not None:
            write_signals_replay(out, loaded, replayed.y)
        errors = ", ".join(f"{name} {error:.6g}" for name, error in zip(loaded.outputs, replayed.rmse, strict=True))
        print(f"{len(loaded)} samples, free run: rmse {errors} after the first {replayed.start} samples")
        return
    played = replay(model, loaded, ports)
    if out is not None:
        write_replay(out, loaded, played.y)
    mode = "corrected by the measured output" if played.stabilised else "free run"
    print(f"{len(loaded)} samples, {mode}: rmse {played.rmse:.6g} after the first {played.start} samples")
    for finding in clock_findings(loaded):
        print(f"note: {finding.text}")


@gap.command("check")
@reads_log
def check_simulation(
    record: RecordPath,
    *,
    how: "Reading",
    sim: Annotated[Path, typer.Option(metavar="MODEL", help="A model of MuJoCo, FILE.xml, or a class, FILE.py:CLASS.")],
    inputs: Inputs = None,
    outputs: Outputs = None,
    match: MatchText = None,
    trust: Trust = False,
) -> None:
    """Check whether a record and a model of MuJoCo or a class speak of the same thing. Exit status 1 if not."""
    from labsid.gap.joints.joint_check import check_record_of_joints, determined_of_joints
    from labsid.gap.simulations.model_check import check_model
    from labsid.gap.simulations.simulation_files import load_simulation
    from labsid.records.record import read_record
    from labsid.simulators.mjcf.several_joints import SeveralJoints
    from labsid.simulators.mjcf.sources import is_mjcf
    from labsid.simulators.simulator import Simulator

    if not is_mjcf(str(sim)) and ".py" not in str(sim):
        raise ValueError(f"--sim must be a model of MuJoCo, FILE.xml, or a class, FILE.py:CLASS; got {sim}.")
    ports = _ports(inputs, outputs, trust)
    if ports.several:
        how = replace(how, inputs=inputs, outputs=outputs)
    loaded = _matcher(match)(read_record(record, how))
    opened = load_simulation(sim, loaded, False, ports)
    assert isinstance(opened, Simulator)
    if opened.joint is None:
        raise ValueError(f"--sim must be a model of MuJoCo or a class with reset and step; {sim} is a function.")
    joint, is_joint = opened.joint, is_mjcf(str(sim))
    if isinstance(joint, SeveralJoints):
        findings = check_record_of_joints(loaded, opened)
        moves = "; ".join(joint.described)
    else:
        findings = check_model(loaded, opened)
        moves = f"{joint.actuator} ({joint.kind}) moves {joint.place}, y is its {joint.output}" if is_joint else ""
    print(f"{len(loaded)} samples; {moves or f'effects act at {joint.place}'}")
    for finding in findings:
        print(f"{finding.level}: {finding.text}")
    for text in determined_of_joints(loaded, opened) if isinstance(joint, SeveralJoints) else ():
        print(text)
    if not findings:
        print(f"The record and the model agree in sign, units{', time and limits' if is_joint else ' and time'}.")
    raise typer.Exit(int(any(finding.level == "warning" for finding in findings)))


@gap.command("effects")
def list_effects(
    name: Annotated[
        str | None, typer.Argument(metavar="[NAME]", help="Only this effect, with all that is known.")
    ] = None,
) -> None:
    """List the effects that the diagnosis can name, their parameters, and the records that show them."""
    from labsid.cli.gap_tables import print_effects
    from labsid.gap.reports.effect_guide import effect_page

    if name is None:
        print_effects()
        return
    for title, text in effect_page(name):
        print(fill(text, 96, initial_indent=f"{title:<15}", subsequent_indent=15 * " "))


@gap.command("rigs")
def check_rigs(
    folder: Annotated[
        Path, typer.Argument(metavar="DIR", help="Folder with NAME.csv and NAME.holdout.csv of each rig.")
    ],
    order: Annotated[int, typer.Option(help="Order of the linear model.")] = 2,
    seed: Seed = 0,
) -> None:
    """Diagnose measured rigs and simulate a second record of each.

    The exit status is 1 if an exported simulation is more than 2 % worse on the second record than the linear model,
    or if a rig cannot be diagnosed.
    """
    from labsid.cli.gap_tables import print_rigs
    from labsid.gap.rigs import check_rigs, find_rigs

    pairs, results = find_rigs(folder), []
    with shown_progress() as progress:
        for result in check_rigs(pairs, order, seed):
            results.append(result)
            if progress is not None:
                progress(result.name, len(results) / len(pairs))
    print_rigs(results)
    raise typer.Exit(int(any(result.is_worse or result.message for result in results)))


def _read_as(how: "Reading", sim: Path | None, trust: bool) -> "tuple[Reading, Ports]":
    """How the record is read, and the ports of a model of MuJoCo, which --inputs and --outputs name if one is given."""
    from labsid.simulators.mjcf.sources import is_mjcf

    if sim is None or not is_mjcf(str(sim)):
        return how, _ports(None, None, trust)
    ports = _ports(how.inputs, how.outputs, trust)
    return (how if ports.several else replace(how, inputs=None, outputs=None)), ports


def _check_export_of_several(export: Path, sim: Path | None) -> None:
    """Reject a file that a simulation of several signals is not exported to."""
    from labsid._texts import joined
    from labsid.simulators.mjcf.sources import is_mjcf

    kinds = (".xml", ".mjcf") if sim is not None and is_mjcf(str(sim)) else (".json", ".py", ".fmu")
    if export.suffix.lower() not in kinds:
        what = "a model of several joints" if ".xml" in kinds else "a simulation of several signals"
        raise ValueError(f"{what} is exported as {joined(kinds, 'or')}; got {export}.")


def _with_signal_units(record: "Record", text: str) -> "Record":
    """A record of several signals in the units of ``--units``: those of the inputs, then of the outputs."""
    units = tuple(unit.strip() for unit in text.split(","))
    if len(units) != len(record.signal_names):
        raise ValueError(
            f"--units must name {len(record.signal_names)} units, of {', '.join(record.signal_names)}; got {text!r}."
        )
    return replace(record, units=units)


def _ports(inputs: str | None, outputs: str | None, trust: bool) -> "Ports":
    from labsid.gap.simulations.simulation_files import Ports

    return Ports(inputs or "", outputs or "", trust)


def _matcher(match: str | None) -> "Callable[[Record], Record]":
    """Bring a record to the numbers of a model."""
    from labsid.gap.simulations.model_check import matched, read_match

    how = None if match is None else read_match(match)
    return lambda record: record if how is None else matched(record, how)


def _write_system(path: Path, found: "SignalsDiagnosis") -> None:
    """Write an exported simulation of several signals, as JSON, as a Python module or as an FMU."""
    from labsid._files import write_json
    from labsid.gap.simulations.python_export import write_system_module

    if found.system is None:
        raise ValueError(
            "the outputs were explained beside the measured other outputs, so there is no simulation that runs "
            "from the inputs alone. Export each output by itself (--inputs, --outputs)."
        )
    kind = path.suffix.lower()
    if kind == ".py":
        write_system_module(path, found.system)
    elif kind == ".fmu":
        from labsid.gap.simulations.fmu_export import write_fmu

        write_fmu(path, found.system.to_json_dict())
    else:
        write_json(path, found.system.to_json_dict())


def _write_simulation(path: Path, diagnosed: "Diagnosis | SignalsDiagnosis") -> None:
    """Write an exported simulation in the form that the name of its file asks for."""
    from labsid._files import write_json
    from labsid.gap.reports.result import Diagnosis

    kind = path.suffix.lower()
    if kind in (".xml", ".mjcf"):
        from labsid.gap.joints.arm_diagnosis import JointsDiagnosis
        from labsid.gap.joints.mjcf_export import write_mended_model

        assert isinstance(diagnosed, Diagnosis | JointsDiagnosis)
        for line in write_mended_model(path, diagnosed):
            print(line)
        return
    assert isinstance(diagnosed, Diagnosis)
    content = diagnosed.model.to_json_dict()
    if kind == ".py":
        from labsid.gap.simulations.python_export import write_python_module

        write_python_module(path, content)
    elif kind == ".fmu":
        from labsid.gap.simulations.fmu_export import write_fmu

        write_fmu(path, content)
    else:
        write_json(path, content)


def _command_line(context: typer.Context) -> str:
    """The command line that repeats this diagnosis: file names without folders, and --html as the only output."""
    from labsid._files import as_argument

    words = ["labsid", "gap", "diagnose"]
    for parameter in context.command.params:
        name, value = str(parameter.name), context.params[str(parameter.name)]
        source = context.get_parameter_source(name)
        if source is None or source.name != "COMMANDLINE" or name in _OUTPUT_OPTIONS:
            continue
        for one in value if isinstance(value, list | tuple) else [value]:
            words += [] if parameter.param_type_name == "argument" else [parameter.opts[0]]
            words.append(as_argument(Path(one.name)) if isinstance(one, Path) else str(one))
    return shlex.join([*words, "--html", "report.html"])


def _refuse_overwriting(path: Path, others: list[Path | None]) -> None:
    """Reject an output file that is also an input or another output."""
    device = path.exists() and not path.is_file()
    if not device and any(other is not None and path.resolve() == other.resolve() for other in others):
        raise ValueError(f"{path} is named twice: it is also another input or output. Give each file its own name.")


def _time_range(text: str) -> tuple[float, float]:
    start, colon, stop = text.partition(":")
    try:
        span = (float(start), float(stop))
    except ValueError:
        span = (0.0, 0.0)
    if not colon or not span[0] < span[1]:
        raise ValueError(f"--exclude must be T0:T1 in seconds with T0 < T1; got {text!r}. Write 12.5:30.")
    return span


def _units(text: str) -> tuple[str, str]:
    u, comma, y = (part.strip() for part in text.partition(","))
    if not (comma and u and y and (u + y).isprintable() and "," not in y):
        raise ValueError(f"--units must be two units with a comma between them; got {text!r}. Write V,mm.")
    return u, y
