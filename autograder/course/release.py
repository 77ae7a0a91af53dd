"""The student release: one zip with the notebooks, their data files, labsid and its environment."""

import base64
import hashlib
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import labsid
from autograder.course.individual_data import individual_file, is_individual
from autograder.course.layout import Course, read_template
from autograder.course.own_secret import shared_file
from autograder.course.settings import read_settings
from labsid._files import write_file, zip_bytes
from labsid.checks.notebook import find_assignment
from labsid.checks.notebook_file import START_PAGE
from labsid.hand_in.hub import HUB_FILE
from labsid.hand_in.start_page import DATA_BESIDE, start_notebook, start_text
from labsid.rig import student_plan

_README = """\
# Set up

1. Create the environment once, in this folder (conda, mamba or micromamba):

       conda env create -f environment.yml
       conda activate labsid

   Without conda: python -m pip install "./{wheel}[notebooks]"

2. Open JupyterLab on the start page:

       labsid lab

The start page, `start.ipynb`, says the same as the text below.

{page}"""

_NO_DATA = "No notebook needs a data file."
_SEPARATE = (
    "Your own data come separately, as a zip file. Unpack it into this folder before you begin, so that each file is "
    "beside its notebook: {files}."
)


def write_release(
    course: Course, out: Path, assignments: Sequence[str] = (), due: Mapping[str, str] | None = None
) -> list[str]:
    """Write the release; the same course gives the same bytes.

    Parameters
    ----------
    course : Course
        Built.
    out : Path
        The zip file, written atomically.
    assignments : sequence of str, optional
        The assignments to release; default all.
    due : mapping, optional
        When an assignment is due, as text, by its name.

    Returns
    -------
    list of str
        The names of its files.

    Raises
    ------
    ValueError
        If the course has not been built, or has no such assignment.
    """
    files = release_files(course, assignments, due)
    write_file(out, zip_bytes(files))
    return sorted(files)


def release_files(
    course: Course, assignments: Sequence[str] = (), due: Mapping[str, str] | None = None
) -> dict[str, bytes]:
    """The files of `write_release`: content by path."""
    data = {
        f"{name}/{file}": shared_file(course, file).read_bytes()
        for name in course.select(assignments)
        if (file := find_assignment(name).record_file) is not None
    }
    return shared_files(course, assignments, data, due)


@dataclass(frozen=True, slots=True)
class IndividualRelease:
    """The files written by a release with individual data, and remarks for the instructor.

    Attributes
    ----------
    shared : Path
        Zip file for everybody.
    packages : Path or None
        For each student apart: a folder of zip files, or a zip file for a learning platform; None without data files.
    students : int
        Number of packages.
    remarks : tuple of str
    """

    shared: Path
    packages: Path | None
    students: int
    remarks: tuple[str, ...] = ()


def write_individual_release(
    course: Course,
    out: Path,
    secret: bytes,
    students: Sequence[str],
    assignments: Sequence[str] = (),
    due: Mapping[str, str] | None = None,
) -> IndividualRelease:
    """Write a release with individual data: a zip file for everybody, and apart from it one for each student.

    Parameters
    ----------
    course : Course
        Built.
    out : Path
        The zip file for everybody, which has nothing of any student. The packages are ``<ID>.zip`` in the folder
        ``<out>-packages`` beside it; each has one student's data, each file in the folder of its assignment.
    secret : bytes
    students : sequence of str
        IDs.
    assignments : sequence of str, optional
        The assignments to release; default all.
    due : mapping, optional
        When an assignment is due, as text, by its name.

    Raises
    ------
    ValueError
        If the course has not been built, it has no such assignment, or an ID is unusable.
    """
    shared = shared_files(course, assignments, due=due, data_come_apart=True)
    own = {student: individual_files(course, secret, student, assignments) for student in students}
    packages = packages_beside(out)
    write_file(out, zip_bytes(shared))
    if not any(own.values()):
        return IndividualRelease(out, None, 0)
    packages.mkdir(exist_ok=True)
    for student, files in own.items():
        write_file(packages / f"{student}.zip", zip_bytes(files))
    return IndividualRelease(out, packages, len(own))


def packages_beside(out: Path) -> Path:
    """Where the packages of single students are written: beside the zip file for everybody."""
    return out.with_name(f"{out.stem}-packages")


def individual_files(course: Course, secret: bytes, student: str, assignments: Sequence[str] = ()) -> dict[str, bytes]:
    """One student's data files: content by ``<assignment>/<file>``; `ValueError` if the ID is unusable."""
    student_plan(student, secret)  # reports an invalid ID before any file is generated
    if "/" in student or "\\" in student or student.startswith("."):
        raise ValueError(f"the student ID {student!r} cannot be the name of a folder.")
    wanted = ((name, find_assignment(name).record_file) for name in course.select(assignments))
    data = {name: file for name, file in wanted if file is not None}
    rig = read_settings(course).rig
    contents = {
        file: individual_file(file, student, secret, rig)
        if is_individual(file)
        else shared_file(course, file).read_bytes()
        for file in set(data.values())
    }
    return {f"{name}/{file}": contents[file] for name, file in data.items()}


def shared_files(
    course: Course,
    assignments: Sequence[str] = (),
    data: Mapping[str, bytes] | None = None,
    due: Mapping[str, str] | None = None,
    data_come_apart: bool = False,
) -> dict[str, bytes]:
    """The files of a release that are the same for all students.

    Parameters
    ----------
    course : Course
        Built.
    assignments : sequence of str, optional
        The assignments to release; default all.
    data : mapping, optional
        The data files that all students share, by path; without it, every student has their own.
    due : mapping, optional
        When an assignment is due, as text, by its name.
    data_come_apart : bool
        Whether students receive their own data apart from these files, which the start page then says.

    Returns
    -------
    dict
        Content by path: the start page, the notebooks, `data`, the wheel of labsid, which has the same files, the
        environment and README.md.
    """
    names = course.select(assignments)
    templates = [read_template(course, name) for name in names]
    due = due or {}
    wanted = [f"`{name}/{file}`" for name in names if (file := find_assignment(name).record_file) is not None]
    said = _SEPARATE.format(files=", ".join(wanted)) if data_come_apart else DATA_BESIDE
    said = said if wanted else _NO_DATA
    files = {f"{name}/{name}.ipynb": (course.release / name / f"{name}.ipynb").read_bytes() for name in names}
    settings = read_settings(course)
    hub, title = settings.hub, settings.title
    files |= {**(data or {}), START_PAGE: start_notebook(templates, due, said, hub is not None, title)}
    wheel, content = labsid_wheel(files if hub is None else {**files, HUB_FILE: hub.to_json()})
    page = start_text(templates, due, said, title)
    files[wheel] = content
    files["environment.yml"] = _environment(course, wheel).encode()
    files["README.md"] = _README.format(wheel=wheel, page=page).encode()
    return files


def _environment(course: Course, wheel: str) -> str:
    """A conda environment with the dependencies of labsid and the notebooks, and labsid from the wheel."""
    project = tomllib.loads((course.root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    needed = [*project["dependencies"], *project["optional-dependencies"]["notebooks"]]
    lines = ["name: labsid", "channels: [conda-forge, nodefaults]", "dependencies:"]
    lines += [f"  - python {project['requires-python']}", "  - pip", *(f"  - {need}" for need in needed)]
    return "\n".join([*lines, "  - pip:", f"      - ./{wheel}", ""])


def labsid_wheel(release: Mapping[str, bytes] | None = None) -> tuple[str, bytes]:
    """Name and content of a reproducible wheel of the installed labsid, without the autograder.

    Parameters
    ----------
    release : mapping, optional
        Released files by path, which ``labsid lab`` copies into the work folder and from which the checks read marks.

    Returns
    -------
    tuple
        File name and content.

    Raises
    ------
    ValueError
        If labsid is not installed, so that its dependencies are unknown.
    """
    package = Path(labsid.__file__).parent
    paths = (path for path in sorted(package.rglob("*")) if path.is_file() and "__pycache__" not in path.parts)
    files = {f"labsid/{path.relative_to(package).as_posix()}": path.read_bytes() for path in paths}
    files |= {f"labsid/release/{name}": content for name, content in (release or {}).items()}
    stem = f"labsid-{labsid.__version__}"
    try:
        installed = distribution("labsid")
        metadata = installed.read_text("METADATA") or installed.read_text("PKG-INFO")
    except PackageNotFoundError:
        metadata = None
    if metadata is None:
        raise ValueError("labsid is not installed. Run: pip install -e .")
    info = f"{stem}.dist-info"
    files[f"{info}/METADATA"] = metadata.encode()
    files[f"{info}/WHEEL"] = b"Wheel-Version: 1.0\nGenerator: labsid\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
    files[f"{info}/entry_points.txt"] = b"[console_scripts]\nlabsid = labsid.cli.commands:main\n"
    listed = [f"{name},sha256={_digest(content)},{len(content)}" for name, content in sorted(files.items())]
    files[f"{info}/RECORD"] = "\n".join([*listed, f"{info}/RECORD,,", ""]).encode()
    return f"{stem}-py3-none-any.whl", zip_bytes(files)


def _digest(content: bytes) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode("ascii").rstrip("=")
