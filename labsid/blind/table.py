"""The table of the sealed check: on the terminal, and in Markdown for the README."""

from labsid.blind.metrics import Figure, Scores

Bar = float | tuple[float, float] | None


def figure_cells(figure: Figure) -> tuple[str, ...]:
    """One figure as text: name, value, interval, records, must, aim, and how it stands.

    Parameters
    ----------
    figure : Figure

    Returns
    -------
    tuple of str
    """
    between = "" if figure.low is None or figure.high is None or not figure.count else _range(figure)
    value = "-" if figure.value is None else _number(figure.value, figure.unit)
    return (
        figure.name,
        value,
        between,
        str(figure.count),
        _bar(figure.must, figure.unit),
        _bar(figure.aim, figure.unit),
        standing(figure),
    )


def standing(figure: Figure) -> str:
    """Whether a figure reaches its bars.

    Parameters
    ----------
    figure : Figure

    Returns
    -------
    str
        ``aim``, ``must``, ``missed``, or empty where there is no bar or no value.
    """
    reached = figure.reaches(figure.must)
    if reached is None:
        return ""
    if figure.reaches(figure.aim):
        return "aim"
    return "must" if reached else "missed"


def markdown(scores: Scores) -> str:
    """The bars and the confusion in Markdown.

    Parameters
    ----------
    scores : Scores

    Returns
    -------
    str
    """
    lines = ["| figure | measured | 95 % interval | records | must | aim | reached |", "|---|---|---|---|---|---|---|"]
    lines += ["| " + " | ".join(cell.strip() for cell in figure_cells(f)) + " |" for f in scores.figures]
    lines += ["", "What was named instead, by row:", "", "| row | in it | answers |", "|---|---|---|"]
    for row, labels in scores.confusion.items():
        lines += [f"| {row} | {label} | {_answers(label, counts)} |" for label, counts in labels.items()]
    lines += ["", "| stated probability | right | answers |", "|---|---|---|"]
    lines += [f"| {p:.2f} | {right:.2f} | {n} |" for p, right, n in scores.calibration]
    return "\n".join(lines) + "\n"


def print_scores(scores: Scores, title: str) -> None:
    """Print the confusion table, the calibration and the bars.

    Parameters
    ----------
    scores : Scores
    title : str
    """
    from rich.console import Console
    from rich.table import Table

    console = Console()
    table = Table("row", "in it", "right", "of", "other answers", title="what was named")
    for row, labels in scores.confusion.items():
        for label, counts in sorted(labels.items()):
            others = {name: n for name, n in counts.items() if name != label}
            right = counts.get(label, 0)
            table.add_row(row, label, str(right), str(sum(counts.values())), _answers("", others))
        table.add_section()
    console.print(table)
    table = Table("stated probability", "right", "answers", title="calibration")
    for p, share, n in scores.calibration:
        table.add_row(f"{p:.2f}", f"{share:.2f}", str(n))
    console.print(table)
    table = Table("figure", "measured", "95 %", "records", "must", "aim", "reached", title=title)
    colours = {"aim": "green", "must": "green", "missed": "red"}
    for figure in scores.figures:
        table.add_row(*figure_cells(figure), style=colours.get(standing(figure)))
    console.print(table)


def _answers(label: str, counts: dict[str, int]) -> str:
    often = sorted(counts.items(), key=lambda item: (item[0] != label, -item[1], item[0]))
    return ", ".join(f"{name} {n}" for name, n in often)


def _number(value: float, unit: str) -> str:
    if unit == "%":
        return f"{100 * value:.1f} %"
    return f"{value:.2f} {unit}" if unit else f"{value:.3f}"


def _range(figure: Figure) -> str:
    assert figure.low is not None
    assert figure.high is not None
    if figure.unit == "%":
        return f"{100 * figure.low:.1f}-{100 * figure.high:.1f} %"
    return f"{figure.low:.3f}-{figure.high:.3f}"


def _bar(bar: Bar, unit: str) -> str:
    if bar is None:
        return ""
    if isinstance(bar, tuple):
        return f"{100 * bar[0]:g}-{100 * bar[1]:g} %"
    return f"{100 * bar:g} %" if unit == "%" else f"{bar:g} {unit}".strip()
