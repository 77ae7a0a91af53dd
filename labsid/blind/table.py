"""The table of the sealed check, on the terminal and in Markdown."""

from collections.abc import Sequence

from labsid.blind.metrics import KindCounts, Metric, Scores, wilson

_KIND_COLUMNS = ("kind", "records", "right", "wrong above .5", "wrong above .9", "no report")

Requirement = float | tuple[float, float] | None


def metric_cells(metric: Metric) -> tuple[str, ...]:
    """Format one metric: name, value, interval, records, required, target and status.

    Parameters
    ----------
    metric : Metric

    Returns
    -------
    tuple of str
    """
    between = "" if metric.low is None or metric.high is None or not metric.count else _range(metric)
    value = "-" if metric.value is None else _number(metric.value, metric.unit)
    return (
        metric.name,
        value,
        between,
        str(metric.count),
        _requirement(metric.required, metric.unit),
        _requirement(metric.target, metric.unit),
        metric_status(metric),
    )


def metric_status(metric: Metric) -> str:
    """Whether a metric meets its requirement and its target.

    Parameters
    ----------
    metric : Metric

    Returns
    -------
    str
        ``target``, ``required`` or ``missed``; empty if there is no requirement or no value.
    """
    reached = metric.reaches(metric.required)
    if reached is None:
        return ""
    if metric.reaches(metric.target):
        return "target"
    return "required" if reached else "missed"


def markdown(scores: Scores) -> str:
    """Format the metrics, the confusion table and the calibration as Markdown.

    Parameters
    ----------
    scores : Scores

    Returns
    -------
    str
    """
    lines = [
        "| metric | measured | 95 % interval | records | required | target | status |",
        "|---|---|---|---|---|---|---|",
    ]
    lines += ["| " + " | ".join(cell.strip() for cell in metric_cells(f)) + " |" for f in scores.metrics]
    lines += ["", "Answers by row:", "", "| row | true effect | answers |", "|---|---|---|"]
    for row, labels in scores.confusion.items():
        lines += [f"| {row} | {label} | {_answers(label, counts)} |" for label, counts in labels.items()]
    lines += ["", "| stated probability | correct | answers |", "|---|---|---|"]
    lines += [f"| {p:.2f} | {right:.2f} | {n} |" for p, right, n in scores.calibration]
    if scores.kinds:
        lines += ["", f"| {' | '.join(_KIND_COLUMNS)} |", f"|{'---|' * len(_KIND_COLUMNS)}"]
        lines += [f"| {' | '.join(kind_cells(kind))} |" for kind in scores.kinds]
    return "\n".join(lines) + "\n"


def kind_cells(counts: KindCounts) -> tuple[str, ...]:
    """Format the outcomes of one kind: its name, the records, and each count with Wilson's interval of its share.

    Parameters
    ----------
    counts : KindCounts
    """
    outcomes = (counts.right, counts.wrong_likely, counts.wrong_sure, counts.no_report)
    between = [(n, *wilson(n, counts.count)) for n in outcomes]
    shown = [f"{n} ({100 * low:.0f}-{100 * high:.0f} %)" for n, low, high in between]
    return counts.kind, str(counts.count), *shown


def print_kinds(kinds: Sequence[KindCounts]) -> None:
    """Print the outcomes of the row `honest` by kind.

    Parameters
    ----------
    kinds : sequence of KindCounts
    """
    from rich.table import Table

    from labsid._tables import print_table

    table = Table(*_KIND_COLUMNS, title="ordinary records, with 95 % intervals", box=None)
    for kind in kinds:
        table.add_row(*kind_cells(kind))
    print_table(table)


def print_scores(scores: Scores, title: str) -> None:
    """Print the confusion table, the calibration, and the metrics to which a record contributes.

    Parameters
    ----------
    scores : Scores
    title : str
    """
    from rich.table import Table

    from labsid._tables import print_table

    table = Table("row", "true effect", "correct", "of", "other answers", title="answers")
    for row, labels in scores.confusion.items():
        for label, counts in sorted(labels.items()):
            others = {name: n for name, n in counts.items() if name != label}
            right = counts.get(label, 0)
            table.add_row(row, label, str(right), str(sum(counts.values())), _answers("", others))
        table.add_section()
    print_table(table)
    table = Table("stated probability", "correct", "answers", title="calibration")
    for p, share, n in scores.calibration:
        table.add_row(f"{p:.2f}", f"{share:.2f}", str(n))
    print_table(table)
    if scores.kinds:
        print_kinds(scores.kinds)
    table = Table("metric", "measured", "95 %", "records", "required", "target", "status", title=title)
    colours = {"target": "green", "required": "green", "missed": "red"}
    for metric in filter(lambda metric: metric.count, scores.metrics):
        table.add_row(*metric_cells(metric), style=colours.get(metric_status(metric)))
    print_table(table)


def _answers(label: str, counts: dict[str, int]) -> str:
    often = sorted(counts.items(), key=lambda item: (item[0] != label, -item[1], item[0]))
    return ", ".join(f"{name} {n}" for name, n in often)


def _number(value: float, unit: str) -> str:
    if unit == "%":
        return f"{100 * value:.1f} %"
    return f"{value:.2f} {unit}" if unit else f"{value:.3f}"


def _range(metric: Metric) -> str:
    assert metric.low is not None
    assert metric.high is not None
    if metric.unit == "%":
        return f"{100 * metric.low:.1f}-{100 * metric.high:.1f} %"
    return f"{metric.low:.3f}-{metric.high:.3f}"


def _requirement(requirement: Requirement, unit: str) -> str:
    if requirement is None:
        return ""
    if isinstance(requirement, tuple):
        return f"{100 * requirement[0]:g}-{100 * requirement[1]:g} %"
    return f"{100 * requirement:g} %" if unit == "%" else f"{requirement:g} {unit}".strip()
