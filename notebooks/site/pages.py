"""Write the sources of the site to a folder: ``python notebooks/site/pages.py build/site``.

Guides and pages keep their places below the folder, so a link is right in the repository and in the site. Notebooks
lose their solutions. The pages of the effects and of the constants are made from the code.
"""

import ast
import re
import shutil
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from copy import deepcopy
from importlib import import_module
from pathlib import Path

import nbformat
import numpy as np

from autograder.course.build import build_source
from autograder.course.layout import Course
from autograder.course.lint import METADATA, lint_release
from autograder.course.nbgrader_access import import_nbgrader_api
from labsid._files import write_text
from labsid.checks.cells import CODE_STUB, TEXT_STUB
from labsid.gap.effects.families import DESCRIPTIONS
from labsid.gap.reports.effect_guide import effect_page

ROOT = Path(__file__).resolve().parents[2]
SITE = Path("notebooks/site")
GALLERY = ROOT / "build" / "gallery"
DECIDING = ("record", "dynamics", "effects", "fits", "search", "simulations", "verdict", "limits", "signals")
"""Folders of `labsid.gap` whose constants have a part in a verdict; the others report or start processes."""
ORIGINS = {
    "fitted": "by the command or on the records that are named",
    "measured": "chosen for the figure that is named",
    "statistics": "follows from the distribution or the criterion that is named",
    "definition": "a unit, a bound of physics, or what the report promises",
    "numerics": "rounding, steps of derivatives, iterations, start values: for time and precision, not for an answer",
    "set by hand": "chosen by judgement, and kept because the answers are right with it",
}
"""Where a constant comes from; the comment of each ends with one of these words, and a figure or a command if any."""


def copied_files() -> list[Path]:
    """The guides, the pages of the site and the figures of both, relative to the root."""
    patterns = (
        "README.md",
        "[!.]*/README.md",
        "labsid/*/README.md",
        "notebooks/ERRATA.md",
        "CITATION.cff",
        "data/*.png",
    )
    found = [path for pattern in (*patterns, ".github/*.md", f"{SITE}/*.md") for path in sorted(ROOT.glob(pattern))]
    return [path.relative_to(ROOT) for path in found]


def notebook_page(source: Path) -> str:
    """A text notebook as students get it, with the marks of its checks; `ValueError` if a solution is left in it."""
    import_nbgrader_api()
    from nbgrader.preprocessors import ClearHiddenTests, ClearSolutions

    notebook = build_source(source)
    released = deepcopy(notebook)
    for step in (ClearSolutions(code_stub={"python": CODE_STUB}, text_stub=TEXT_STUB), ClearHiddenTests()):
        released, _ = step.preprocess(released, {})
    for cell in released.cells:
        cell.metadata.pop(METADATA, None)  # rubrics, which no page shows
    problems = list(lint_release(released, notebook))
    if problems:
        raise ValueError(f"{source} cannot be a page: {'; '.join(problems)}")
    return "\n\n".join(_blocks(released.cells)) + "\n"


def _blocks(cells: Iterable[nbformat.NotebookNode]) -> Iterator[str]:
    """Cells as Markdown; where there are several titles, all headings but the first go down by one level."""
    cells = list(cells)
    more = sum(cell.cell_type == "markdown" and cell.source.startswith("# ") for cell in cells) > 1
    for place, cell in enumerate(cells):
        if cell.cell_type == "markdown":
            yield re.sub(r"(?m)^(?=#+ )", "#", cell.source) if more and place else cell.source
        else:
            yield f"```python\n{cell.source}\n```"


def notebooks_page(names: Iterable[str]) -> str:
    """The list of the notebooks, in the order of the course."""
    lines = "\n".join(f"../{name}/{name}" for name in names)
    return (
        "# Notebooks\n\nThe notebooks as students get them, without solutions and without outputs. "
        "[Writing notebooks](../README.md) has their order, marks and hours.\n\n"
        f"```{{toctree}}\n:maxdepth: 1\n\n{lines}\n```\n"
    )


def gallery_index() -> str:
    """The list of the effects, by the place where they act."""
    parts = [
        "# Gallery of effects",
        "One page for each effect that `labsid gap` can name: what it does, what confuses it, and what a record needs "
        "to show it. The figure is the diagnosis of a simulated rig with it. `make gallery` makes the figures.",
    ]
    for path in dict.fromkeys(guide.path for guide in DESCRIPTIONS.values()):
        lines = "\n".join(f"gallery/{name}" for name, guide in DESCRIPTIONS.items() if guide.path == path)
        parts += [f"## {_capital(path)}", f"```{{toctree}}\n:maxdepth: 1\n\n{lines}\n```"]
    return "\n\n".join(parts) + "\n"


def _capital(text: str) -> str:
    return text[0].upper() + text[1:]


def gallery_page(name: str) -> str:
    """What an effect is, what shows it and what it is confused with, and a diagnosis of a simulated rig that has it."""
    rows = dict(effect_page(name))
    rivals = [f"[{DESCRIPTIONS[rival].noun}]({rival}.md)" for rival in DESCRIPTIONS[name].confused_with]
    parts = [f"# {_capital(re.sub('^an? ', '', DESCRIPTIONS[name].noun))}"]
    parts += [f"`{name}`, path: {rows['path']}.", f"**{DESCRIPTIONS[name].clauses[-1]}.** {rows['rig']}"]
    if "parameters" in rows:
        parts += ["## Parameters", "\n".join(f"- {text}" for text in rows["parameters"].split("; "))]
    if rivals:
        parts += ["## What confuses it", "On a poor record it is confused with " + ", ".join(rivals) + "."]
    parts += ["## How to tell", f"What a record needs: *{rows['record']}*", _LIMITS]
    text = GALLERY / f"{name}.txt"
    if text.is_file():
        given = "" if not (GALLERY / f"{name}.sim.json").is_file() else f" --sim {name}.sim.json"
        files = [path for path in (GALLERY / f"{name}.csv", GALLERY / f"{name}.sim.json") if path.is_file()]
        parts += [
            "## A simulated rig with it",
            "Files: " + ", ".join(f"{{download}}`{path.name} <{path.name}>`" for path in files) + ".",
            f"```text\n$ labsid gap diagnose {name}.csv{given}\n{text.read_text(encoding='utf-8').strip()}\n```",
            f"![Output and errors of a rig with {DESCRIPTIONS[name].noun}, of both simulations]({name}.svg)",
        ]
    else:
        parts += ["*The figure of a simulated rig is made by `make gallery`.*"]
    return "\n\n".join(parts) + "\n"


def constants_page() -> str:
    """The constants of the folders `DECIDING`, with their values and with what the code says of them."""
    parts: list[str] = []
    origins: Counter[str] = Counter()
    for folder in DECIDING:
        parts += [f"## {folder}"]
        for path in sorted((ROOT / "labsid" / "gap" / folder).glob("*.py")):
            rows = [(name, value, *split_origin(meaning)) for name, value, meaning in constants_of(path)]
            origins.update(origin.split(":")[0] for *_, origin in rows)
            if rows:
                lines = [f"| `{name}` | {' | '.join(cells)} |" for name, *cells in rows]
                parts += [
                    f"### {folder}/{path.stem}",
                    "\n".join(["| name | value | meaning | origin |", "|---|---|---|---|", *lines]),
                ]
    kinds = [f"| {kind} | {meaning} | {origins[kind]} |" for kind, meaning in ORIGINS.items()]
    table = "\n".join(["| origin | meaning | constants |", "|---|---|--:|", *kinds])
    head = ["# Constants of the diagnosis", _CONSTANTS.format(count=origins.total()), table, _HELD]
    return "\n\n".join([*head, *parts]) + "\n"


_LIMITS = (
    "`labsid gap limits RECORD` prints the smallest size that your record can show, and the smallest that it can tell "
    "from every other effect; with `--input NEXT.csv` those of an experiment that is not made yet."
)
_ORIGIN = re.compile(rf"(?:^|; )((?:{'|'.join(ORIGINS)})(?:: .+?)?)\.?$")
_CONSTANTS = "All {count} constants, from the source of `labsid/gap`. The last column says where a constant comes from:"
_HELD = (
    "`labsid gap compare` says which of the kept answers another value changes "
    "([Change the diagnosis](../../labsid/gap/README.md#change-the-diagnosis)). On what the probabilities were fitted "
    "is described in [What the probabilities mean](probabilities.md)."
)


def constants_of(path: Path) -> Iterator[tuple[str, str, str]]:
    """Name, value and meaning of each numeric constant of a module; the meaning is its comment or its docstring."""
    source = path.read_text(encoding="utf-8")
    lines, body = source.splitlines(), ast.parse(source).body
    module = import_module(".".join(path.relative_to(ROOT).with_suffix("").parts))
    for node, following in zip(body, [*body[1:], None], strict=True):
        target = node.targets[0] if isinstance(node, ast.Assign) else getattr(node, "target", None)
        if not isinstance(node, ast.Assign | ast.AnnAssign) or not isinstance(target, ast.Name):
            continue
        value = _shown(getattr(module, target.id)) if re.fullmatch(r"_?[A-Z][A-Z0-9_]+", target.id) else ""
        if value:
            comments = [line.split("  # ", 1)[1] for line in lines[node.lineno - 1 : node.end_lineno] if "  # " in line]
            said = following.value if isinstance(following, ast.Expr) else None
            docstring = said.value if isinstance(said, ast.Constant) and isinstance(said.value, str) else ""
            yield target.id, value, " ".join([*comments, *docstring.split()]).replace("|", "\\|")


def split_origin(text: str) -> tuple[str, str]:
    """What a constant means, and one of `ORIGINS` with its figure; a dash where its comment does not say that."""
    found = _ORIGIN.search(text)
    return (text[: found.start()], found.group(1)) if found else (text, "–")


def _shown(value: object) -> str:
    """Numbers, and collections of them, as text; empty for anything else."""
    if isinstance(value, bool):
        return ""
    if isinstance(value, int | float):
        return f"{value:.12g}"
    if isinstance(value, np.ndarray):
        value = tuple(value.tolist())
    named = value._asdict() if hasattr(value, "_asdict") else value
    if isinstance(named, dict):
        items = {key: _shown(item) for key, item in named.items()}
        return ", ".join(f"{key}: {text}" for key, text in items.items()) if all(items.values()) else ""
    if isinstance(value, tuple):
        shown = [_shown(item) for item in value]
        return f"({', '.join(shown)})" if shown and all(shown) else ""
    return ""


def write_pages(folder: Path) -> None:
    """Write all sources; files whose content is the same keep their time, so that Sphinx reads the others only."""
    pages = {SITE / "gallery" / f"{name}.md": gallery_page(name) for name in DESCRIPTIONS}
    pages |= {SITE / "gallery.md": gallery_index(), SITE / "constants.md": constants_page()}
    names = Course(ROOT).assignments()
    pages[SITE / "notebooks.md"] = notebooks_page(names)
    for name in names:
        path = Path("notebooks", name, f"{name}.md")
        pages[path] = notebook_page(ROOT / path)
    texts = {path: (ROOT / path) for path in copied_files()}
    texts |= {
        SITE / "gallery" / path.name: path for path in GALLERY.glob("*") if path.suffix in (".svg", ".csv", ".json")
    }
    for path in set(folder.rglob("*")) - {folder / name for name in (*pages, *texts)}:
        if path.is_file() and SITE / "api" not in path.relative_to(folder).parents:
            path.unlink()
    for path, text in pages.items():
        if not (folder / path).is_file() or (folder / path).read_text(encoding="utf-8") != text:
            write_text(folder / path, text)
    for path, original in texts.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(original, folder / path)


if __name__ == "__main__":
    write_pages(Path(sys.argv[1]))
