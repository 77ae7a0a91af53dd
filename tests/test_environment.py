"""pyproject.toml says what labsid needs; the lock, the conda environment and the set-up script must say the same."""

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("labsid", "autograder")


@pytest.fixture(scope="module")
def pyproject() -> dict[str, Any]:
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def lock() -> str:
    return (ROOT / "requirements.lock").read_text(encoding="utf-8")


def declared(pyproject: dict[str, Any], here: dict[str, str] | None = None) -> dict[str, SpecifierSet]:
    """Every package that pyproject.toml names, extras included, with its bounds; on one platform, or on any."""
    project = pyproject["project"]
    requirements = [Requirement(line) for line in project["dependencies"]]
    for extra in project["optional-dependencies"].values():
        requirements += [Requirement(line) for line in extra]
    return {
        canonicalize_name(requirement.name): requirement.specifier
        for requirement in requirements
        if requirement.name != project["name"]
        and (here is None or requirement.marker is None or requirement.marker.evaluate(dict(here)))
    }


def locked(lock: str) -> list[tuple[Requirement, int]]:
    """Every entry of the lock, with how many hashes it has."""
    logical_lines = re.sub(r"\\\n", " ", re.sub(r"(?m)^ *#.*\n", "", lock)).splitlines()
    return [
        (
            Requirement(line.split(" --hash=")[0].strip()),
            len(re.findall(r"--hash=sha256:[0-9a-f]{64}\b", line)),
        )
        for line in logical_lines
        if line.strip()
    ]


def test_every_dependency_has_a_lower_bound(pyproject: dict[str, Any]) -> None:
    unbounded = [
        name for name, bounds in declared(pyproject).items() if not any(bound.operator == ">=" for bound in bounds)
    ]
    assert unbounded == []


def test_the_dev_extra_holds_every_other_extra(pyproject: dict[str, Any]) -> None:
    """`pip install labsid[dev]` and the lock are then the same set."""
    extras = pyproject["project"]["optional-dependencies"]
    reached, queue = set(), ["dev"]
    while queue:
        extra = queue.pop()
        reached.add(extra)
        for line in extras[extra]:
            requirement = Requirement(line)
            if requirement.name == pyproject["project"]["name"]:
                queue += requirement.extras - reached
    assert reached == set(extras)


def test_conda_asks_for_what_pyproject_asks_for(pyproject: dict[str, Any]) -> None:
    environment = yaml.safe_load((ROOT / "environment.yml").read_text(encoding="utf-8"))
    named = [line for line in environment["dependencies"] if isinstance(line, str)]
    conda = {canonicalize_name(line.split()[0]): SpecifierSet("".join(line.split()[1:])) for line in named}
    assert len(conda) == len(named), "a package is named twice"

    assert conda.pop("python") == SpecifierSet(pyproject["project"]["requires-python"])
    assert conda.pop("pip") == SpecifierSet()
    other = [line for line in environment["dependencies"] if not isinstance(line, str)]
    assert [list(line) for line in other] == [["pip"]]
    *pip, itself = other[0]["pip"]
    assert itself == "-e ."
    from_pip = {canonicalize_name(Requirement(line).name): Requirement(line).specifier for line in pip}
    assert not from_pip.keys() & conda.keys()
    assert conda | from_pip == declared(pyproject)
    assert environment["name"] == pyproject["project"]["name"]


def test_the_lock_satisfies_pyproject(pyproject: dict[str, Any], lock: str) -> None:
    entries = [requirement for requirement, _ in locked(lock)]
    build = {Requirement(line).name: Requirement(line).specifier for line in pyproject["build-system"]["requires"]}
    for name, bounds in {**declared(pyproject), **build}.items():
        versions = [str(entry.specifier).removeprefix("==") for entry in entries if entry.name == name]
        assert versions, f"{name} is not in requirements.lock; run `make lock`"
        assert all(bounds.contains(version) for version in versions), f"{name}: {versions}, but {bounds}"


def test_the_lock_pins_and_hashes_every_entry(lock: str) -> None:
    entries = locked(lock)
    assert len(entries) > 100
    for requirement, hashes in entries:
        assert [pin.operator for pin in requirement.specifier] == ["=="], f"{requirement} is not pinned"
        assert hashes > 0, f"{requirement} has no hash"
        assert requirement.url is None


def test_the_lock_names_no_address_no_option_and_no_path(lock: str) -> None:
    """So it serves behind any mirror, and on any machine."""
    assert "://" not in lock
    entry = r"[a-z0-9][a-z0-9.-]*==[\w.]+( ; [^\\]+)? \\"
    hash_line = r"    --hash=sha256:[0-9a-f]{64}( \\)?"
    comment = r"    #( via)?( +[a-z0-9.-]+( \(pyproject\.toml\))?)?"
    odd = [line for line in lock.splitlines() if not re.fullmatch(f"{entry}|{hash_line}|{comment}", line)]
    assert odd == []


def test_the_lock_serves_every_platform(pyproject: dict[str, Any], lock: str) -> None:
    """On each platform and each Python exactly one version of everything declared applies."""
    entries = [requirement for requirement, _ in locked(lock)]
    platforms = [
        ("linux", "posix", "x86_64"),
        ("linux", "posix", "aarch64"),
        ("darwin", "posix", "arm64"),
        ("darwin", "posix", "x86_64"),
        ("win32", "nt", "AMD64"),
    ]
    for sys_platform, os_name, machine in platforms:
        for python in ("3.11", "3.12", "3.13"):
            here = {
                "sys_platform": sys_platform,
                "os_name": os_name,
                "platform_machine": machine,
                "python_version": python,
                "python_full_version": f"{python}.0",
                "implementation_name": "cpython",
                "platform_python_implementation": "CPython",
            }
            applies = [entry.name for entry in entries if entry.marker is None or entry.marker.evaluate(dict(here))]
            assert len(applies) == len(set(applies)), here
            assert set(declared(pyproject, here)) <= set(applies), here


def test_the_declared_pythons_agree(pyproject: dict[str, Any]) -> None:
    supported = SpecifierSet(pyproject["project"]["requires-python"])
    listed = {
        classifier.rsplit(" ", 1)[1]
        for classifier in pyproject["project"]["classifiers"]
        if re.search(r":: 3\.\d+$", classifier)
    }
    assert listed == {f"3.{minor}" for minor in range(30) if supported.contains(f"3.{minor}")}

    script = (ROOT / ".ci" / "set-up").read_text(encoding="utf-8")
    bounds = re.search(r"\((\d+), (\d+)\) <= sys.version_info < \((\d+), (\d+)\)", script)
    assert bounds is not None
    assert SpecifierSet(">={}.{},<{}.{}".format(*bounds.groups())) == supported


@pytest.mark.parametrize("package", PACKAGES)
def test_an_installed_package_is_whole(pyproject: dict[str, Any], package: str) -> None:
    """What is not Python ships only if package-data names it, and a folder only if it has an __init__.py."""
    patterns = pyproject["tool"]["setuptools"]["package-data"]["*"]
    suffixes = {Path(pattern).suffix for pattern in patterns if pattern.startswith("**/*.")}
    generated = {ROOT / "autograder" / folder for folder in ("source", "release", "data")}
    ignored = {"__pycache__", "README.md", "course-secret"}
    files = [
        path
        for path in (ROOT / package).rglob("*")
        if path.is_file() and not ignored & set(path.parts) and not generated & set(path.parents)
    ]
    assert len(files) > 5
    for path in files:
        if path.suffix == ".py":
            assert (path.parent / "__init__.py").is_file(), f"{path.parent} holds modules but no __init__.py"
        else:
            shipped = path.suffix in suffixes or path.name in patterns
            assert shipped, f"{path.relative_to(ROOT)} would not be installed: name it under package-data"


def test_labsid_is_typed() -> None:
    assert (ROOT / "labsid" / "py.typed").is_file()
