"""The sources of the site are complete: every public name, every effect, every guide; and what stands there is true."""

import re
import runpy
import subprocess
import sys
import tomllib
from collections import Counter
from importlib import import_module
from pathlib import Path

import pytest
import typer
import yaml

import labsid
from autograder.course.layout import Course
from labsid.cli.commands import _make_app
from labsid.gap.effects.families import DESCRIPTIONS

ROOT = Path(__file__).resolve().parent.parent
SITE = ROOT / "notebooks" / "site"
DOCUMENTED = ("labsid", "labsid.gap", "labsid.plots", "labsid.rig", "labsid.checks", "labsid.hand_in")
NOTEBOOKS = Course(ROOT).assignments()


@pytest.fixture(scope="module")
def pages():
    return runpy.run_path(str(SITE / "pages.py"))


def toctree_of(text, folder):
    """The files that the toctrees of a page name."""
    lines = [line for block in re.findall(r"```\{toctree\}\n(.*?)```", text, re.S) for line in block.splitlines()]
    names = [re.sub(r"^.*<(.*)>$", r"\1", line) for line in lines if line and not line.startswith(":")]
    return {(folder / f"{name}.md").resolve().relative_to(ROOT).as_posix() for name in names}


def test_every_public_name_is_on_the_page_of_names():
    """And nothing else; every package of labsid that has public names is among them."""
    listed = re.findall(r"^   (labsid\.\S+)$", (SITE / "api.md").read_text(encoding="utf-8"), re.M)
    public = {f"{package}.{name}" for package in DOCUMENTED for name in import_module(package).__all__}
    assert sorted(listed) == sorted(public - {"labsid.__version__"})
    rooms = [path.parent.name for path in (ROOT / "labsid").glob("*/__init__.py")]
    assert {f"labsid.{room}" for room in rooms if hasattr(import_module(f"labsid.{room}"), "__all__")} | {
        "labsid"
    } == set(DOCUMENTED)


def test_every_guide_is_a_page_and_is_reached_from_the_readme(pages):
    listed = subprocess.run(["git", "ls-files", "*.md"], cwd=ROOT, capture_output=True, text=True, check=False).stdout
    written = {name for name in listed.split() if Path(name).stem not in NOTEBOOKS}
    if not written:
        pytest.skip("not in a git checkout")
    assert written == {path.as_posix() for path in pages["copied_files"]() if path.suffix == ".md"}
    made = {f"notebooks/site/{name}.md" for name in ("gallery", "constants", "notebooks", "index")}
    assert (
        toctree_of((SITE / "index.md").read_text(encoding="utf-8"), SITE) | {"notebooks/site/index.md"}
        == written | made
    )
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    guides = {name for name in written if name.endswith("/README.md")}
    assert guides - set(re.findall(r"\]\(([^)#]+)", readme)) == set()


def test_links_of_the_pages_lead_to_files():
    """Also in the repository, where they are read without the site."""
    made = {"gallery.md", "constants.md", "notebooks.md"}
    for path in (*SITE.glob("*.md"), *(ROOT / ".github").glob("*.md"), ROOT / "README.md"):
        for link in re.findall(r"\]\((?!https?:)([^)#]+)[)#]", path.read_text(encoding="utf-8")):
            assert (path.parent / link).exists() or link in made, f"{path.name}: {link}"


def test_every_effect_has_a_page(pages):
    assert toctree_of(pages["gallery_index"](), SITE) == {f"notebooks/site/gallery/{name}.md" for name in DESCRIPTIONS}
    for name, guide in DESCRIPTIONS.items():
        page = pages["gallery_page"](name)
        assert guide.excited_by in page
        assert all(f"({rival}.md)" in page for rival in guide.confused_with)


def test_every_constant_of_the_diagnosis_says_what_it_means(pages):
    rows = re.findall(r"^\| `(\w+)` \| (.*?) \| (.*) \| (.*) \|$", pages["constants_page"](), re.M)
    assert len(rows) > 250
    assert [name for name, _, meaning, _ in rows if not meaning.strip()] == []
    assert ("BIC_MARGIN", "12") in {row[:2] for row in rows}
    used = re.findall(r"`([A-Z][A-Z_]+)`", (SITE / "decision.md").read_text(encoding="utf-8"))
    assert set(used) <= {name for name, *_ in rows}, "the page of the formulas names constants that do not exist"


def test_the_words_of_the_glossary_name_what_exists():
    """Every word that a reader may look up is there, and the place in the code that it names is there, too."""
    rows = re.findall(r"^\| ([\w ,]+) \| (.+) \| (.+) \|$", (SITE / "glossary.md").read_text(encoding="utf-8"), re.M)
    words = [word for row in rows for word in row[0].split(", ") if word != "word"]
    assert len(words) == len(set(words))
    asked = """family variant candidate trial hypothesis answer verdict start baseline confidence probability closed
        held path rows rest sealed bar seed gate"""
    assert set(asked.split()) < set(words)
    for place in re.findall(r"`(\w+/\w+)(?:\.(\w+))?`", " ".join(places for _, _, places in rows)):
        if place[0].startswith("tests/"):
            continue
        module = import_module(f"labsid.gap.{place[0].replace('/', '.')}")
        assert not place[1] or hasattr(module, place[1]), place


def test_every_constant_of_the_diagnosis_says_where_it_comes_from(pages):
    """By a word that the head of the page explains; what was measured or fitted says how, and what was not does not."""
    page = pages["constants_page"]()
    rows = re.findall(r"^\| `(\w+)` \| (.*?) \| (.*) \| (.*) \|$", page, re.M)
    kinds = {name: int(count) for name, count in re.findall(r"^\| ([a-z ]+) \| .* \| (\d+) \|$", page, re.M)}
    assert list(kinds) == ["fitted", "measured", "statistics", "definition", "numerics", "set by hand"]
    said = [origin.split(": ", 1) for *_, origin in rows]
    assert [row for row, (kind, *_) in zip(rows, said, strict=True) if kind not in kinds] == []
    assert dict(Counter(kind for kind, *_ in said)) == kinds
    assert f"All {len(rows)} constants" in page
    assert all(len(parts) == 2 for parts in said if parts[0] in ("fitted", "measured", "statistics"))
    origins = {name: origin for name, *_, origin in rows}
    assert origins["PRIOR"] == "fitted: with `WEIGHTS`"
    assert "nine with the fitted -2.6" in origins["PARTIAL_PRIOR"]
    for name in ("WEIGHTS", "PARTIAL_WEIGHTS", "RANGES"):
        assert "`dev` records" in origins[name]
        assert "labsid.blind.calibration" in origins[name]
    by_hand = {"FITTED_EFFECTS", "SWITCH_PROBABILITY", "MAX_FIT_REDUCTION", "OUTSIDE"}
    assert {origins[name] for name in by_hand} == {"set by hand"}


def test_the_origin_of_a_constant_is_the_end_of_its_comment(pages):
    """A comment that speaks of a measurement in its middle has no origin yet."""
    split = pages["split_origin"]
    assert split("samples; measured: 3 of 5; then 4.") == ("samples", "measured: 3 of 5; then 4")
    assert split("of a mode; a filter has 0.38; set by hand") == ("of a mode; a filter has 0.38", "set by hand")
    assert split("share of the measured output, set by hand at first") == (
        "share of the measured output, set by hand at first",
        "–",
    )
    assert split("of the numerics; checked")[1] == "–"


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_the_page_of_a_notebook_holds_no_solution(pages, name):
    source = (ROOT / "notebooks" / name / f"{name}.md").read_text(encoding="utf-8")
    page = pages["notebook_page"](ROOT / "notebooks" / name / f"{name}.md")
    shown = set(map(str.strip, page.splitlines()))
    regions = re.findall(r"### BEGIN SOLUTION\n(.*?)### END SOLUTION", source, re.S)
    given = set(map(str.strip, re.sub(r"### BEGIN SOLUTION\n.*?### END SOLUTION", "", source, flags=re.S).splitlines()))
    secret = {line.strip() for region in regions for line in region.splitlines() if len(line.strip()) > 12} - given
    assert secret
    assert secret & shown == set()
    assert re.findall(r"^# .*", re.sub(r"```.*?```", "", page, flags=re.S)[1:], re.M) == [], "a page has one title"


def test_the_readme_lists_every_command():
    """And no other: each row of its tables is a command that exists."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    listed = [*re.findall(r"^\| `(labsid [a-z ]*[a-z])", readme, re.M), "labsid data make", "labsid demo"]
    assert all(f"`{name}" in readme for name in listed)
    assert sorted(listed) == sorted(_commands(typer.main.get_command(_make_app(with_contributed=True)), "labsid"))


def _commands(command, name):
    """The full names of a command, or of those of a group."""
    groups = getattr(command, "commands", None)
    return [name] if groups is None else [one for key in groups for one in _commands(groups[key], f"{name} {key}")]


def test_the_first_python_of_the_readme_runs():
    (first, *_) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.S)
    done = subprocess.run([sys.executable, "-c", first], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "z^2" in done.stdout


def test_versions_agree():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert project["version"] == labsid.__version__ == citation["version"]
    assert (citation["license"], citation["cff-version"]) == (project["license"], "1.2.0")
    assert f"## {labsid.__version__}" in (ROOT / ".github" / "CHANGELOG.md").read_text(encoding="utf-8")


def test_the_matrix_runs_every_python_on_every_system():
    workflow = yaml.safe_load((ROOT / ".github" / "workflows" / "tests.yml").read_text(encoding="utf-8"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    matrix = workflow["jobs"]["tests"]["strategy"]["matrix"]
    assert {f"Programming Language :: Python :: {python}" for python in matrix["python"]} < set(project["classifiers"])
    assert len(matrix["python"]) == sum(bool(re.search(r":: 3\.\d+$", line)) for line in project["classifiers"])
    assert {system.split("-")[0] for system in matrix["system"]} == {"ubuntu", "macos", "windows"}
    assert {"oldest", "newest"} == {run["dependencies"] for run in matrix["include"]}
