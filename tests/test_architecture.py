"""The rules that keep the house in order: who may import whom, what a module may be, what lies where."""

import ast
import builtins
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from graphlib import CycleError, TopologicalSorter
from importlib import import_module
from importlib.metadata import packages_distributions
from inspect import cleandoc
from itertools import pairwise
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parent.parent

TOP_LEVEL = {
    "notebooks",
    "labsid",
    "autograder",
    "data",
    "tests",
    "README.md",
    "CITATION.cff",  # GitHub and Zenodo read it here only; the other texts for contributors are in .github
    "LICENSE",
    "pyproject.toml",
    "requirements.lock",
    "environment.yml",
    "Makefile",
}


@dataclass(frozen=True)
class Module:
    """One source file: its dotted name, and whether it is the __init__ of a package."""

    name: str
    path: Path

    @property
    def package(self) -> str:
        return self.name if self.path.name == "__init__.py" else self.name.rpartition(".")[0]

    @property
    def public(self) -> bool:
        return not any(part.startswith("_") for part in self.name.split("."))

    def tree(self) -> ast.Module:
        return parsed(self.path.read_text(encoding="utf-8"))


@cache
def parsed(source: str) -> ast.Module:
    return ast.parse(source)


def modules_of(folder: Path) -> list[Module]:
    """The modules of the package in `folder`, its sub-packages included."""
    paths = sorted(path for path in folder.rglob("*.py") if "__pycache__" not in path.parts)
    names = [path.relative_to(folder.parent).with_suffix("").parts for path in paths]
    return [
        Module(".".join(parts[:-1] if parts[-1] == "__init__" else parts), path)
        for parts, path in zip(names, paths, strict=True)
    ]


def imports_of(module: Module) -> list[str]:
    """The absolute dotted name of everything that `module` imports, wherever in it and however."""
    return imports_in(module.tree(), module.package)


@cache
def imports_in(tree: ast.Module, package: str) -> list[str]:
    return list(_imported(tree, package))


def _imported(tree: ast.Module, package: str) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            outer = package.split(".")
            base = ".".join(outer[: len(outer) - node.level + 1]) if node.level else ""
            source = ".".join(filter(None, (base, node.module)))
            yield source
            yield from (f"{source}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
            called = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            if called in {"import_module", "__import__"} and isinstance(node.args[0].value, str):
                yield node.args[0].value


def broken(modules: list[Module], forbidden: str) -> list[str]:
    """Imports by `modules` of what the pattern `forbidden` matches from its start, as `importer -> imported`."""
    return sorted(
        {
            f"{module.name} -> {name}"
            for module in modules
            for name in imports_of(module)
            if re.match(rf"(?:{forbidden})(?:\.|$)", name)
        }
    )


@pytest.fixture(scope="module")
def labsid() -> list[Module]:
    modules = modules_of(ROOT / "labsid")
    assert len(modules) > 20
    return modules


@pytest.fixture(scope="module")
def autograder() -> list[Module]:
    modules = modules_of(ROOT / "autograder")
    assert len(modules) > 5
    return modules


@pytest.mark.parametrize(
    ("statement", "imported"),
    [
        ("import autograder", "autograder"),
        ("import os, autograder.judge as j", "autograder.judge"),
        ("from autograder import judge", "autograder.judge"),
        ("from . import noise", "pack.rig.noise"),
        ("from .noise import white", "pack.rig.noise"),
        ("from .. import gap", "pack.gap"),
        ("from ..gap.screen import screen", "pack.gap.screen"),
        ("def f():\n    from pack import gap", "pack.gap"),
        ("if True:\n    import importlib\n    importlib.import_module('pack.gap')", "pack.gap"),
        ("m = __import__('pack.gap')", "pack.gap"),
    ],
)
def test_the_import_walker_sees(tmp_path: Path, statement: str, imported: str) -> None:
    folder = tmp_path / "pack" / "rig"
    folder.mkdir(parents=True)
    (folder / "__init__.py").write_text(statement, encoding="utf-8")
    (folder / "tank.py").write_text(statement, encoding="utf-8")
    modules = modules_of(tmp_path / "pack")
    assert [module.name for module in modules] == ["pack.rig", "pack.rig.tank"]
    for module in modules:
        assert imported in set(imports_of(module))
    assert len(broken(modules, re.escape(imported))) >= 2
    assert broken(modules, re.escape(imported) + "s") == []


def test_labsid_imports_neither_the_grader_nor_jupyter(labsid: list[Module]) -> None:
    """But for the room that runs a student's notebooks in a kernel, which only the command imports, and the sliders."""
    jupyter = r"jupyter\w*|notebook|nb\w+|IPython|ipykernel|ipywidgets"
    hand_in = [module for module in labsid if f"{module.name}.".startswith("labsid.hand_in.")]
    sliders = [module for module in labsid if module.name == "labsid.predictions.widgets"]
    assert broken(labsid, "autograder") == []
    assert broken([module for module in labsid if module not in (*hand_in, *sliders)], jupyter) == []
    assert broken(sliders, jupyter) == ["labsid.predictions.widgets -> ipywidgets"]
    assert broken(labsid, r"labsid\.predictions\.widgets") == [
        f"labsid.predictions.display -> labsid.predictions.widgets{part}" for part in ("", ".prediction_widget")
    ]
    assert {line.partition(" -> ")[2].partition(".")[0] for line in broken(hand_in, jupyter)} == {"jupyter_client"}
    others = [module for module in labsid if module not in hand_in and not module.name.startswith("labsid.cli.")]
    assert broken(others, r"labsid\.hand_in") == []


def test_gap_and_rig_do_not_know_each_other(labsid: list[Module]) -> None:
    """Or the diagnosis could read off the truth that the simulator put in."""
    gap = [module for module in labsid if f"{module.name}.".startswith("labsid.gap.")]
    rig = [module for module in labsid if f"{module.name}.".startswith("labsid.rig.")]
    assert len(rig) > 3
    assert broken(rig, r"labsid\.gap") == []
    assert broken(gap, r"labsid\.rig") == []
    blind = [module for module in labsid if f"{module.name}.".startswith("labsid.blind.")]
    assert broken(blind, r"labsid\.gap") == []
    assert broken([*gap, *rig], r"labsid\.blind") == []


def test_only_plots_imports_matplotlib_and_never_its_global_state(labsid: list[Module]) -> None:
    plots = [module for module in labsid if f"{module.name}.".startswith("labsid.plots.")]
    assert broken(plots, "matplotlib") != []
    assert broken([module for module in labsid if module not in plots], "matplotlib|pylab|bokeh|PIL") == []
    assert broken(plots, r"matplotlib\.(pyplot|rcParams|rc|use)|pylab") == []


@pytest.mark.parametrize(
    ("folder", "extras"),
    [
        (
            "labsid",
            ["cluster", "fmu", "logs", "mujoco", "notebooks"],
        ),  # of notebooks jupyter_client and ipywidgets alone, as the test above says
        ("autograder", ["notebooks", "autograder", "cluster"]),
        ("tests", ["notebooks", "autograder", "fmu", "logs", "mujoco", "dev"]),
    ],
)
def test_what_is_imported_is_declared(folder: str, extras: list[str]) -> None:
    """A package that is there only because another one needs it today may be gone tomorrow."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lines = [*project["dependencies"], *(line for e in extras for line in project["optional-dependencies"][e])]
    declared = {canonicalize_name(Requirement(line).name) for line in lines}

    own = {"labsid", "autograder"} | {path.stem for path in (ROOT / "tests").iterdir()}
    imported = {name.split(".")[0]: module.name for module in modules_of(ROOT / folder) for name in imports_of(module)}
    foreign = set(imported) - own - set(sys.stdlib_module_names)
    assert len(foreign) > 4
    provided_by = packages_distributions()
    undeclared = {
        name: imported[name]
        for name in foreign
        if not declared & {canonicalize_name(distribution) for distribution in provided_by.get(name, [])}
    }
    assert undeclared == {}


def test_help_needs_no_heavy_import() -> None:
    program = (
        "import sys\n"
        "from labsid.cli.commands import main\n"
        "sys.argv = ['labsid', '--help']\n"
        "try:\n"
        "    main()\n"
        "except SystemExit as stop:\n"
        "    assert not stop.code, stop.code\n"
        "print('loaded:', *sys.modules)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    *shown, loaded = done.stdout.splitlines()
    for command in ("identify", "check", "demo", "course"):
        assert any(command in line for line in shown), f"{command} is not in the help"
    heavy = {"numpy", "scipy", "control", "matplotlib", "numba", "rich", "jinja2", "nbgrader", "nbformat", "IPython"}
    assert (heavy | {"bokeh", "dask"}) & set(loaded.split()) == set()


def public_definitions(module: Module) -> Iterator[tuple[str, ast.FunctionDef | ast.ClassDef]]:
    """Public functions, classes, and functions of public classes: name and node."""
    for node in module.tree().body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
            yield f"{module.name}.{node.name}", node
            if isinstance(node, ast.ClassDef):
                for inner in node.body:
                    if isinstance(inner, ast.FunctionDef) and not inner.name.startswith("_"):
                        yield f"{module.name}.{node.name}.{inner.name}", inner


def taken(function: ast.FunctionDef) -> list[str]:
    """The parameters of `function` as written, without self and cls."""
    arguments = function.args
    named = [*arguments.posonlyargs, *arguments.args]
    if arguments.vararg:
        named.append(arguments.vararg)
    named += arguments.kwonlyargs
    if arguments.kwarg:
        named.append(arguments.kwarg)
    return [argument.arg for argument in named if argument.arg not in {"self", "cls"}]


def fields(data_class: ast.ClassDef) -> list[str]:
    """The annotated fields of a data class."""
    return [
        node.target.id
        for node in data_class.body
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)
    ]


def section(docstring: str, title: str) -> list[str] | None:
    """The names that the numpydoc section `title` explains, or None if there is no such section."""
    lines = docstring.splitlines()
    underlined = [i for i in range(len(lines) - 1) if lines[i].strip() and set(lines[i + 1]) == {"-"}]
    start = next((i for i in underlined if lines[i] == title), None)
    if start is None:
        return None
    end = next((i for i in underlined if i > start), len(lines))
    entries = [line for line in lines[start + 2 : end] if line and not line.startswith(" ")]
    return [name.strip().lstrip("*") for line in entries for name in line.split(" : ")[0].split(",")]


def test_the_docstring_reader_reads() -> None:
    docstring = """Do it.

    Parameters
    ----------
    u, y : array_like, shape (N,)
        The record, in volts.

        More: about it.
    order : int
        How many.
    *rest : int

    Returns
    -------
    float
    """
    assert section(cleandoc(docstring), "Parameters") == ["u", "y", "order", "rest"]
    assert section(cleandoc(docstring), "Notes") is None
    function = ast.parse("def f(self, a, /, u, *rest, k=1, **other): ...").body[0]
    assert isinstance(function, ast.FunctionDef)
    assert taken(function) == ["a", "u", "rest", "k", "other"]


FOREIGN_TYPES = {
    "ExecutionResult": "IPython.core.interactiveshell",
    "InterconnectedSystem": "control",
    "InteractiveShell": "IPython.core.interactiveshell",
    "NonlinearIOSystem": "control",
    "NotebookNode": "nbformat",
    "matplotlib.figure.Figure": "matplotlib.figure",
}
"""Types of other packages that docstrings name where the code does not, because importing them there is slow."""

FILES_ELSEWHERE = {
    *("course.toml", "students.csv", "extensions.csv", "motor.csv"),  # an instructor's
    *("timestamp.txt", "nbgrader_config.py", "meta/info.json"),  # nbgrader's, LeRobot's
    "submission_metadata.yml",  # Gradescope's
    *("grades.csv", "summary.csv", "summary.html", "told.json"),  # what commands write
    *("rig.py", "better.py"),  # a user's simulation, a corrected one
}
"""Files that docstrings name and that are not in the repository; ``FILE.py`` and ``OUT/grades.csv`` are not listed."""


def type_names(docstring: str) -> list[str]:
    """The names of classes, and other names that are no plain words, among the types in the sections of numpydoc."""
    lines = docstring.splitlines()
    underlined = [i for i in range(len(lines) - 1) if lines[i].strip() and set(lines[i + 1]) == {"-"}]
    found = []
    for start, end in pairwise([*underlined, len(lines)]):
        title, entries = lines[start], [line for line in lines[start + 2 : end] if line and line[0] != " "]
        if title in ("Parameters", "Attributes"):
            entries = [line.partition(" : ")[2] for line in entries]
        elif title in ("Returns", "Yields", "Raises"):
            entries = [line.partition(" : ")[2] or line for line in entries]
        else:
            continue
        text = re.sub(r"\{[^}]*\}|\([^)]*\)|\"[^\"]*\"", "", " , ".join(entries))
        found += [name for name in re.findall(r"[A-Za-z_][\w.]*", text) if not re.fullmatch("[a-z]+|array_like", name)]
    return found


def test_the_reader_of_types_reads() -> None:
    docstring = """Do it.

    Parameters
    ----------
    u, y : array_like, shape (N,)
        The Record.
    record : Record or _Raw, optional
    suite : {"Dev", "final"}

    Returns
    -------
    found : list of control.StateSpace
    Judged

    Notes
    -----
    Some : Thing
    """
    assert type_names(cleandoc(docstring)) == ["Record", "_Raw", "control.StateSpace", "Judged"]


def names_in(tree: ast.Module) -> set[str]:
    """Every name in the code of a module, in quoted annotations, too."""
    names = set(dir(builtins))
    for node in ast.walk(tree):
        names |= {value for _, value in ast.iter_fields(node) if isinstance(value, str) and value.isidentifier()}
        if isinstance(node, ast.alias):
            names |= {*(node.asname or node.name).split(".")}
        for annotation in (getattr(node, "annotation", None), getattr(node, "returns", None)):
            for text in ast.walk(annotation) if annotation is not None else ():
                names |= {*re.findall(r"\w+", str(text.value))} if isinstance(text, ast.Constant) else set()
    return names


def docstrings(module: Module) -> Iterator[tuple[str, str]]:
    """Each docstring of a module, with the name of what it belongs to."""
    for node in ast.walk(module.tree()):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            docstring = ast.get_docstring(node)
            if docstring is not None:
                yield f"{module.name}.{getattr(node, 'name', '')}".rstrip("."), docstring


@pytest.mark.parametrize("package", ["labsid", "autograder"])
def test_the_types_in_docstrings_exist(package: str) -> None:
    """In the code of the module, as a class of its room, or in another package: a class that was renamed is nowhere."""
    modules = modules_of(ROOT / package)
    rooms: dict[str, set[str]] = {}
    for module in modules:
        room = rooms.setdefault(".".join(module.name.split(".")[:2]), set())
        room |= {node.name for node in ast.walk(module.tree()) if isinstance(node, ast.ClassDef)}
    wrong, count = [], 0
    for module in modules:
        known = names_in(module.tree()) | rooms[".".join(module.name.split(".")[:2])]
        for name, docstring in docstrings(module):
            types = type_names(docstring)
            count += len(types)
            wrong += [f"{name}: {one}" for one in types if one.split(".")[-1] not in known and one not in FOREIGN_TYPES]
    assert wrong == []
    assert count > 100


@pytest.mark.parametrize("name", sorted(FOREIGN_TYPES))
def test_the_types_of_other_packages_exist(name: str) -> None:
    assert isinstance(getattr(import_module(FOREIGN_TYPES[name]), name.rpartition(".")[2]), type)


def test_the_files_that_docstrings_name_exist() -> None:
    """Under their path, or the end of it. Names with capitals stand for a user's: ``FILE.py``, ``OUT/grades.csv``."""
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True)
    if listed.returncode != 0:
        pytest.skip("not a checkout of git")
    paths = [path.split("/") for path in listed.stdout.splitlines() if (ROOT / path).exists()]
    known = {"/".join(path[start:]) for path in paths for start in range(len(path))} | FILES_ELSEWHERE
    modules = [module for folder in ("labsid", "autograder", "tests") for module in modules_of(ROOT / folder)]
    pattern = (
        r"(?<![\w<>*/.{-])[A-Za-z_][\w/.-]*\.(?:md|pyi?|toml|cff|sh|lock|yml|css|js|html|json|csv|mat|txt)\b(?!\w)"
    )
    cited = {
        (name, file) for module in modules for name, text in docstrings(module) for file in re.findall(pattern, text)
    }
    assert len(cited) > 30
    placeholder = r"(?!README|CONTRIBUTING|CHANGELOG|ERRATA|GAP)[A-Z]{2}[A-Z0-9]*\b.*"
    assert sorted(item for item in cited if item[1] not in known and not re.match(placeholder, item[1])) == []


def test_everything_public_has_a_docstring(labsid: list[Module]) -> None:
    found = [item for module in labsid if module.public for item in public_definitions(module)]
    assert len(found) > 50
    assert [name for name, node in found if not ast.get_docstring(node)] == []


def test_docstrings_name_exactly_the_parameters(labsid: list[Module]) -> None:
    """And those of a class exactly its fields, where it has a section of them."""
    wrong = []
    checked = {"Parameters": 0, "Attributes": 0}
    for name, node in (item for module in labsid if module.public for item in public_definitions(module)):
        if isinstance(node, ast.FunctionDef):
            title, there = "Parameters", taken(node)
        else:
            title, there = "Attributes", fields(node)
        explained = section(ast.get_docstring(node) or "", title)
        if explained is not None:
            checked[title] += 1
            if explained != there:
                wrong.append(f"{name}: has {there}, explains {explained}")
    assert wrong == []
    assert min(checked.values()) > 10


def test_data_classes_are_frozen(labsid: list[Module]) -> None:
    """A result that could be changed after the fact could not be trusted by the next step."""
    decorators = [
        (f"{module.name}.{node.name}", ast.unparse(decorator))
        for module in labsid
        for node in ast.walk(module.tree())
        if isinstance(node, ast.ClassDef)
        for decorator in node.decorator_list
        if "dataclass" in ast.unparse(decorator)
    ]
    assert len(decorators) > 10
    loose = [name for name, text in decorators if "frozen=True" not in text or "slots=True" not in text]
    assert loose == []


def import_graph(modules: list[Module], fold: Callable[[str], str] = str) -> dict[str, set[str]]:
    """Imports among `modules`, also those for types and inside functions, under the names that `fold` gives them."""
    own = {module.name for module in modules}
    graph: dict[str, set[str]] = {fold(module.name): set() for module in modules}
    for module in modules:
        for name in imports_of(module):
            longest = name if name in own else name.rpartition(".")[0]
            if longest in own and fold(longest) != fold(module.name):
                graph[fold(module.name)].add(fold(longest))
    return graph


def circle(graph: Mapping[str, set[str]]) -> list[str]:
    """One circle of the graph, or nothing."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def room_of(module: str) -> str:
    """The room of ``labsid.gap.effects.base`` is ``labsid.gap``."""
    return ".".join(module.split(".")[:2])


def test_a_circle_of_imports_is_found(tmp_path: Path) -> None:
    folder = tmp_path / "pack"
    folder.mkdir()
    (folder / "__init__.py").write_text("", encoding="utf-8")
    (folder / "a.py").write_text("from pack.b import x", encoding="utf-8")
    (folder / "b.py").write_text("def f():\n    import pack.c", encoding="utf-8")
    (folder / "c.py").write_text("if TYPE_CHECKING:\n    from pack import a", encoding="utf-8")
    assert set(circle(import_graph(modules_of(folder)))) == {"pack.a", "pack.b", "pack.c"}
    (folder / "c.py").write_text("", encoding="utf-8")
    assert circle(import_graph(modules_of(folder))) == []


@pytest.mark.parametrize("package", ["labsid", "autograder"])
def test_neither_files_nor_rooms_import_in_a_circle(package: str) -> None:
    modules = [module for module in modules_of(ROOT / package) if module.name != package]
    assert circle(import_graph(modules)) == []
    assert circle(import_graph(modules, room_of)) == []


def test_folders_of_the_diagnosis_import_in_the_order_of_its_readme() -> None:
    """A folder imports those above it in the table; beside them, the modules that exported files import by name."""
    table = re.findall(r"^\| (`\w+/`) \|", (ROOT / "labsid/gap/README.md").read_text(encoding="utf-8"), flags=re.M)
    order = [f"labsid.gap.{name.strip('`/')}" for name in table]
    modules = [module for module in modules_of(ROOT / "labsid") if module.name.startswith("labsid.gap.")]
    graph = import_graph(modules, lambda module: ".".join(module.split(".")[:3]))
    assert circle(graph) == []
    assert {folder for folder in graph if (ROOT / folder.replace(".", "/")).is_dir()} == set(order)
    for place, folder in enumerate(order):
        assert graph[folder] & set(order) <= set(order[: place + 1]), folder


def test_rooms_import_in_the_order_of_the_readme() -> None:
    table = re.findall(r"^\| (`.*?) \|", (ROOT / "labsid" / "README.md").read_text(encoding="utf-8"), flags=re.M)
    order = [{f"labsid.{name}" for name in re.findall(r"`(\w+)/`", cell)} for cell in table]
    modules = [module for module in modules_of(ROOT / "labsid") if module.name != "labsid"]
    graph = import_graph(modules, room_of)
    rooms = {room for room in graph if not room.startswith("labsid._")}
    assert set().union(*order) == rooms
    below: set[str] = set()
    for row in order:
        below |= row
        for room in row:
            assert graph[room] & rooms <= below, room


def test_no_two_modules_of_the_diagnosis_have_one_name(labsid: list[Module]) -> None:
    """Who reads ``inside.py`` in a traceback knows its folder. `signals` has its own `diagnosis` and `result`."""
    names = [module.path.name for module in labsid if module.name.startswith("labsid.gap.")]
    assert {name for name in names if names.count(name) > 1} == {"__init__.py", "diagnosis.py", "result.py"}


@pytest.mark.parametrize("package", ["labsid", "autograder"])
def test_no_function_or_class_has_the_name_of_a_module(package: str) -> None:
    modules = modules_of(ROOT / package)
    names = {module.name.rpartition(".")[2] for module in modules}
    defined = {
        name
        for module in modules
        for name, _ in public_definitions(module)
        if name.count(".") == module.name.count(".") + 1
    }
    assert sorted(name for name in defined if name.rpartition(".")[2] in names) == []


@pytest.mark.parametrize("package", ["labsid", "labsid.gap"])
def test_names_of_a_package_are_lazy_and_the_stub_lists_them(package: str) -> None:
    stub = ast.parse((ROOT.joinpath(*package.split(".")) / "__init__.pyi").read_text(encoding="utf-8"))
    listed = {alias.name: node.module for node in stub.body if isinstance(node, ast.ImportFrom) for alias in node.names}
    program = (
        f"import sys, {package} as package\n"
        "assert not {'numpy', 'labsid.lab', 'labsid.gap.diagnosis'} & set(sys.modules)\n"
        "for name in package.__all__:\n"
        "    print(name, getattr(getattr(package, name), '__module__', ''))\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    found = dict(line.split(" ") for line in done.stdout.splitlines())
    assert found.pop("__version__", "") == ""
    assert found == listed


@pytest.fixture(scope="module")
def tracked() -> list[str]:
    """The files that git tracks, once every file of the work is added."""
    try:
        listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError) as problem:
        pytest.skip(f"not in a git checkout, so which files are tracked is not known ({problem})")
    names = [name for name in listed.stdout.split("\0") if name]
    if not names:
        pytest.skip("git tracks no file here")
    assert len(names) > 50
    return names


def test_the_top_level_holds_what_it_should(tracked: list[str]) -> None:
    top = {name.split("/")[0] for name in tracked}
    assert {name for name in top if not name.startswith(".")} == TOP_LEVEL


def test_no_file_knows_the_machine_it_was_written_on(tracked: list[str]) -> None:
    """No absolute path of someone's own, and no registry: the files must work behind any mirror."""
    folder = rb"(?<![\w.~$})\]-])/(?:work|home|root|Users)/\w"
    hosts = [("pypi", "org"), ("pythonhosted", "org"), ("anaconda", "org"), ("npmjs", "org"), ("crates", "io")]
    registry = b"|".join(rb"\b" + name.encode() + rb"\." + domain.encode() for name, domain in hosts)
    found = [
        f"{name}: {match.group().decode(errors='replace')}"
        for name in tracked
        if (ROOT / name).is_file()
        for match in re.finditer(folder + b"|" + registry, (ROOT / name).read_bytes())
    ]
    assert found == []
