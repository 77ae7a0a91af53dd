"""The release as a student sees it: its files, unpacked into a folder."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from autograder.course.layout import SETTINGS_FILE, Course
from autograder.course.release import release_files
from autograder.course.rig_texts import PASSAGES_FILE
from autograder.course.settings import read_settings
from labsid._files import write_file


def write_preview(
    course: Course, folder: Path, assignments: Sequence[str] = (), due: Mapping[str, str] | None = None
) -> list[str]:
    """Write the files of the release, with the data that all students share, into a folder.

    Parameters
    ----------
    course : Course
        Built.
    folder : Path
        New, or empty.
    assignments : sequence of str, optional
        The assignments of the release; default all.
    due : mapping, optional
        When an assignment is due, as text, by its name.

    Returns
    -------
    list of str
        The names of its files.

    Raises
    ------
    ValueError
        If the folder is not empty, the course has not been built, or it has no such assignment.
    """
    if folder.exists() and not (folder.is_dir() and next(folder.iterdir(), None) is None):
        raise ValueError(f"{folder} is not an empty folder. Give --folder another name, or delete it first.")
    files = release_files(course, assignments, due)
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        write_file(path, content)
    return sorted(files)


def changed_since_build(course: Course, assignments: Sequence[str] = ()) -> list[str]:
    """The assignments whose text, or the rig of which it speaks, was changed after the last build."""
    rig = read_settings(course).rig

    def is_changed(name: str) -> bool:
        sources = [course.notebooks / name / f"{name}.md"]
        passages = sources[0].with_name(PASSAGES_FILE)
        if rig is not None and passages.is_file():
            sources += [passages, course.root / SETTINGS_FILE, rig.record]
        built = (course.release / name / f"{name}.ipynb").stat().st_mtime_ns
        return any(path.stat().st_mtime_ns > built for path in sources)

    return [name for name in course.select(assignments) if is_changed(name)]
