"""The student release: one zip with the notebooks, their data files, labsid and its environment."""

import base64
import hashlib
import tomllib
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import labsid
from autograder.course.archive import zip_bytes
from autograder.course.individual_data import individual_file, is_individual
from autograder.course.layout import Course
from autograder.course.own_secret import shared_file
from labsid._files import write_file
from labsid.checks.notebook import load_assignment
from labsid.rig import student_plan

_README = """\
# {course}

1. Create the environment once (conda, mamba or micromamba):

       conda env create -f environment.yml
       conda activate {course}

   Without conda: python -m pip install "./{wheel}[notebooks]"

2. Open the notebooks:

       jupyter lab

   {data}

3. Work through each notebook from top to bottom and run its checks. Submit the notebooks without renaming the files;
   a zip of the folders is accepted, too.
"""


def write_release(course: Course, out: Path, assignments: Sequence[str] = ()) -> list[str]:
    """Write the release; the same course gives the same bytes.

    Parameters
    ----------
    course : Course
        Built.
    out : Path
        The zip file, written atomically.
    assignments : sequence of str, optional
        The assignments to release; default all.

    Returns
    -------
    list of str
        The names of its files.

    Raises
    ------
    ValueError
        If the course has not been built, or has no such assignment.
    """
    files = shared_files(course, assignments)
    for name in course.select(assignments):
        data = load_assignment(name).record_file
        if data is not None:
            files[f"{name}/{data}"] = shared_file(course, data).read_bytes()
    write_file(out, zip_bytes(files))
    return sorted(files)


def write_individual_releases(
    course: Course, out: Path, secret: bytes, students: Sequence[str], assignments: Sequence[str] = ()
) -> list[str]:
    """Write the release with individual data: one folder for each student, for the instructor to distribute.

    Parameters
    ----------
    course : Course
        Built.
    out : Path
        The zip file: ``for-everybody/`` contains the shared files, ``students/<ID>/`` the data of one student, each
        file in the folder of its assignment.
    secret : bytes
    students : sequence of str
        IDs.
    assignments : sequence of str, optional
        The assignments to release; default all.

    Returns
    -------
    list of str
        The names of its files.

    Raises
    ------
    ValueError
        If the course has not been built, it has no such assignment, or an ID is unusable.
    """
    files = {f"for-everybody/{name}": content for name, content in shared_files(course, assignments).items()}
    for student in students:
        for name, content in individual_files(course, secret, student, assignments).items():
            files[f"students/{student}/{name}"] = content
    write_file(out, zip_bytes(files))
    return sorted(files)


def individual_files(course: Course, secret: bytes, student: str, assignments: Sequence[str] = ()) -> dict[str, bytes]:
    """One student's data files: content by ``<assignment>/<file>``; `ValueError` if the ID is unusable."""
    student_plan(student, secret)  # reports an invalid ID before any file is generated
    if "/" in student or "\\" in student or student.startswith("."):
        raise ValueError(f"the student ID {student!r} cannot be the name of a folder.")
    wanted = ((name, load_assignment(name).record_file) for name in course.select(assignments))
    data = {name: file for name, file in wanted if file is not None}
    contents = {
        file: individual_file(file, student, secret) if is_individual(file) else shared_file(course, file).read_bytes()
        for file in set(data.values())
    }
    return {f"{name}/{file}": contents[file] for name, file in data.items()}


def shared_files(course: Course, assignments: Sequence[str] = ()) -> dict[str, bytes]:
    """The files that are the same for everybody: notebooks, labsid, its environment and the instructions."""
    files: dict[str, bytes] = {}
    has_data = False
    for name in course.select(assignments):
        notebook = course.release / name / f"{name}.ipynb"
        if not notebook.is_file():
            raise ValueError(f"{name} has not been built ({notebook} does not exist). Run: labsid course build")
        files[f"{name}/{name}.ipynb"] = notebook.read_bytes()
        has_data = has_data or load_assignment(name).record_file is not None
    wheel, content = labsid_wheel()
    files[wheel] = content
    files["environment.yml"] = _environment(course, wheel).encode()
    data = "The data files are beside the notebooks that use them." if has_data else "No notebook needs a data file."
    files["README.md"] = _README.format(course="labsid", wheel=wheel, data=data).encode()
    return files


def _environment(course: Course, wheel: str) -> str:
    """A conda environment with the dependencies of labsid and the notebooks, and labsid from the wheel."""
    project = tomllib.loads((course.root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    needed = [*project["dependencies"], *project["optional-dependencies"]["notebooks"]]
    lines = ["name: labsid", "channels: [conda-forge, nodefaults]", "dependencies:"]
    lines += [f"  - python {project['requires-python']}", "  - pip", *(f"  - {need}" for need in needed)]
    return "\n".join([*lines, "  - pip:", f"      - ./{wheel}", ""])


def labsid_wheel() -> tuple[str, bytes]:
    """Name and content of a reproducible wheel of the installed labsid, without the autograder.

    Raises
    ------
    ValueError
        If labsid is not installed, so that its dependencies are unknown.
    """
    package = Path(labsid.__file__).parent
    paths = (path for path in sorted(package.rglob("*")) if path.is_file() and "__pycache__" not in path.parts)
    files = {f"labsid/{path.relative_to(package).as_posix()}": path.read_bytes() for path in paths}
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
