"""Extract submissions from the zip file that Moodle, Canvas or Gradescope makes of all of them.

Who is who is decided first, by `autograder.intake.identity`, and stored beside the submissions. Then the files of one
participant after another are read, within a budget of work; what cannot be read is a remark on that participant.

File names in the zip are never used as output paths: these consist of a validated ID and the name of an assignment.
"""

import zipfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from datetime import tzinfo
from pathlib import Path

from autograder.course.archive import Budget, Pool, open_archive
from autograder.course.layout import Course, read_template
from autograder.course.plain_text import one_line, shortened
from autograder.course.students import STUDENTS_FILE, Student, merge_students, read_students, write_students
from autograder.intake.canvas_gradebook import CanvasGradebook, as_worksheet
from autograder.intake.download import HandIn, Participant, list_participants, read_hand_in
from autograder.intake.identity import identify
from autograder.intake.other_downloads import Download, list_canvas, list_gradescope, which_system
from autograder.intake.submission import LATE_FILE, NOT_READ_FILE, UNTOUCHED, UNTOUCHED_FILE, VERSIONS_FILE
from autograder.intake.versions import MAX_DOUBTS, Version, newest_version
from autograder.intake.worksheet import Worksheet, participant_number, submission_time, utc_timestamp
from labsid._files import write_file
from labsid.checks.kept_tries import tries_file_name
from labsid.checks.notebook import find_assignment

SHARE, MOST, POOL = 100_000_000, 400_000_000, 1_000_000_000
"""Work of reading: what every participant may use, the most for one, and what all may use beyond their shares.

In bytes unpacked, of which a core does 200 million a second; honest hand-ins take less than 30 million.
"""

TIMESTAMP_FILE = "timestamp.txt"

_EXPECTED = {
    "moodle": "folders such as 'Full Name_123456_assignsubmission_file_', as Moodle's 'Download all submissions' makes "
    "them, files such as 'lovelaceada_12345_67890_lab.ipynb' of Canvas, or an export of Gradescope",
    "canvas": "files such as 'lovelaceada_12345_67890_lab.ipynb', as 'Download Submissions' of Canvas makes them",
    "gradescope": "folders such as 'submission_12345' with files, as Gradescope's 'Export Submissions' makes them",
}


def collect_submissions(
    course: Course,
    path: Path,
    out: Path,
    sheet: Worksheet | CanvasGradebook | None = None,
    zone: tzinfo | None = None,
    assignments: Sequence[str] = (),
    known: Sequence[Student] = (),
    system: str | None = None,
) -> Iterator[str]:
    """Extract submissions from the zip file of a learning platform.

    Parameters
    ----------
    course : Course
        Built; the assignment of a notebook is recognised by its cells.
    path : Path
        The zip file.
    out : Path
        Receives ``<student>/<assignment>/<assignment>.ipynb``, the submitted data file, and ``timestamp.txt`` if the
        worksheet has the time, and the tries that the student chose to send, which no line mentions; also
        `STUDENTS_FILE`. Existing files are replaced if the zip contains a new version.
        Notebooks as they were released are not written.
    sheet : Worksheet or CanvasGradebook, optional
        Moodle's grading worksheet of the same assignment, or the gradebook of Canvas.
    zone : tzinfo, optional
        Time zone of the worksheet; default this machine's.
    assignments : sequence of str, optional
        The assignments to collect; default all.
    known : sequence of Student
        Students whose IDs are known; those in `out` are added.
    system : {"moodle", "canvas", "gradescope"}, optional
        Where it is from; default the one whose names most of its files have.

    Yields
    ------
    str
        A line for each student, and one for files of no participant.

    Raises
    ------
    ValueError
        If it is not a zip file, or not from there, there is no such assignment, or it is not clear who is who; nothing
        is written then.
    """
    wanted = course.select(assignments)
    if out.exists() and not out.is_dir():
        raise ValueError(f"{out} is a file; give --out another name.")
    templates = {name: read_template(course, name) for name in course.assignments()}
    with path.open("rb") as content, open_archive(content, path.name) as archive:
        found_system = system or which_system(archive)
        download, of_whom = _read_download(archive, path, found_system, sheet, zone, known)
        participants, strays = download.participants, download.strays
        if not participants:
            raise ValueError(f"{path} contains no submission: expected {_EXPECTED[found_system]}.")
        table = out / STUDENTS_FILE
        written_before = read_students(table) if table.is_file() else []
        decided = merge_students(written_before, known)
        names = {number: participant.name for number, participant in participants.items()}
        if found_system == "canvas":  # whose names are one word
            spelled = ((student.participant, student.name) for student in decided if student.participant in names)
            names |= {number: name for number, name in spelled if _letters(name) == _letters(names[number])}
        if found_system == "gradescope":  # it has no number of a person that a later export has, too
            decided = merge_students([replace(student, participant="") for student in decided])
        who = identify(of_whom, decided, names)
        in_sheet = {participant_number(row) for row in (of_whom.rows if of_whom is not None else ())}
        new = [
            replace(student, participant=_lasting(student.participant, found_system))
            for student in who.students.values()
        ]
        write_students(table, merge_students(written_before, new))
        pool = Pool(POOL)
        for owner in sorted(participants.values(), key=lambda participant: (participant.name, int(participant.number))):
            hand_in = read_hand_in(archive, owner, templates, Budget(SHARE, MOST, pool))
            student = who.students[owner.number].id
            time = download.times.get(owner.number)
            times = {} if time is None else dict.fromkeys(wanted, time)
            remarks = write_hand_in(out / student, hand_in, wanted, times, owner.number in download.late)
            remarks += download.remarks.get(owner.number, [])
            if of_whom is not None and owner.number not in in_sheet:
                in_what = "gradebook" if found_system == "canvas" else "worksheet"
                remarks.append(f"not in the {in_what}: {_described(student, owner)} is the ID")
            yield one_line(f"{student} ({owner.name}): {'; '.join(remarks)}")
    if strays:
        yield one_line(f"files of no participant: {', '.join(strays[:10])}{' ...' if len(strays) > 10 else ''}")


def _read_download(
    archive: zipfile.ZipFile,
    path: Path,
    system: str,
    sheet: Worksheet | CanvasGradebook | None,
    zone: tzinfo | None,
    known: Sequence[Student],
) -> tuple[Download, Worksheet | None]:
    """What a download says before any file is read, and the table of who is who.

    Raises
    ------
    ValueError
        If the table is not that of the system, or the download cannot be read.
    """
    if sheet is not None and isinstance(sheet, CanvasGradebook) != (system == "canvas"):
        table = "a gradebook of Canvas" if isinstance(sheet, CanvasGradebook) else "a worksheet of Moodle"
        raise ValueError(
            f"{sheet.path} is {table}, but {path} is a download of {system.capitalize()}; --from tells it."
        )
    if isinstance(sheet, CanvasGradebook):
        of_whom = as_worksheet(sheet, known)
        return list_canvas(archive, {str(participant_number(row)) for row in of_whom.rows}), of_whom
    if system == "canvas":
        return list_canvas(archive), None
    if system == "gradescope":
        try:
            download = list_gradescope(archive)
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None
        return download, Worksheet(tuple(download.rows[0]) if download.rows else (), tuple(download.rows), "", path)
    participants, strays = list_participants(archive)
    return Download(participants, strays, {} if sheet is None else _times(sheet, zone)), sheet


def _letters(name: str) -> list[str]:
    return sorted(filter(str.isalnum, name.casefold()))


def _lasting(number: str, system: str) -> str:
    """The number of a participant as it is stored; Gradescope has none."""
    return "" if system == "gradescope" else number


def _described(student: str, participant: Participant) -> str:
    return "the participant number" if student == participant.number else student


def _times(sheet: Worksheet, zone: tzinfo | None) -> dict[str, str]:
    """Submission times as in ``timestamp.txt``, by participant number, where the worksheet has them."""
    found = ((participant_number(row), submission_time(row)) for row in sheet.rows)
    return {number: utc_timestamp(time.replace(tzinfo=zone)) for number, time in found if number and time is not None}


def write_hand_in(
    folder: Path, hand_in: HandIn, wanted: Sequence[str], times: Mapping[str, str], is_late: bool = False
) -> list[str]:
    """Write what a participant handed in; a participant without a notebook gets an empty folder, and is graded, too.

    Parameters
    ----------
    folder : Path
        Of the student.
    hand_in : HandIn
    wanted : sequence of str
        The assignments to write.
    times : mapping
        When each was handed in, as in ``timestamp.txt``, where it is known.
    is_late : bool
        Whether the platform calls it late without a time.

    Returns
    -------
    list of str
        Remarks for the instructor.
    """
    written: list[str] = []
    folder.mkdir(parents=True, exist_ok=True)
    for name, versions in sorted(hand_in.versions.items()):
        if name in wanted:
            notes = _write_assignment(folder, name, versions, hand_in, times.get(name))
            if is_late:
                _write_below(folder.parent, Path(folder.name, name, LATE_FILE), b"late\n")
            else:
                (folder / name / LATE_FILE).unlink(missing_ok=True)
            written.append(f"{name} ({', '.join(notes)})" if notes else name)
    _note_unread(folder, hand_in, wanted)
    others = [name for name in sorted(hand_in.versions) if name not in wanted]
    untouched = sorted(hand_in.untouched - hand_in.versions.keys())
    for name in untouched:
        if name in wanted and not any((folder / name).glob("*.ipynb")):
            _write_below(folder.parent, Path(folder.name, name, UNTOUCHED_FILE), f"{UNTOUCHED}\n".encode())
    remarks = [", ".join(written)] if written else []
    if untouched:
        remarks.append(f"as released, not collected: {', '.join(untouched)}")
    if others:
        remarks.append(f"other assignments, not collected: {', '.join(others)}")
    if not hand_in.versions and not hand_in.untouched:
        remarks.append("no notebook of this course")
        hand_in.skipped.extend(f"{path}: a copy that a program made by itself" for path in hand_in.left_out)
    if hand_in.problem:
        remarks.append(hand_in.problem)
    if hand_in.skipped:
        remarks.append(f"skipped: {', '.join(hand_in.skipped[:5])}{' ...' if len(hand_in.skipped) > 5 else ''}")
    return remarks


def _note_unread(folder: Path, found: HandIn, wanted: Sequence[str]) -> None:
    """Write why there is no notebook: beside the assignment that is named, or else for all of the participant's."""
    (folder / NOT_READ_FILE).unlink(missing_ok=True)
    for name in wanted:
        why = [said for named, said in found.unread if named == name]
        if why and name not in found.versions and not any((folder / name).glob("*.ipynb")):
            _write_below(folder.parent, Path(folder.name, name, NOT_READ_FILE), _as_note(why))
        else:
            (folder / name / NOT_READ_FILE).unlink(missing_ok=True)
    why = [said for named, said in found.unread if named is None]
    if why:
        _write_below(folder.parent, Path(folder.name, NOT_READ_FILE), _as_note(why))


def _as_note(said: Sequence[str]) -> bytes:
    return f"{one_line('; '.join(said[:MAX_DOUBTS]))}\n".encode(errors="replace")


def _write_assignment(
    folder: Path,
    name: str,
    versions: Sequence[Version],
    hand_in: HandIn,
    timestamp: str | None,
) -> list[str]:
    """Write one assignment of a participant; returns notes on it."""
    latest, doubts = newest_version(versions)
    doubts += tuple(said for named, said in hand_in.unread if named == name)[:MAX_DOUBTS]
    files = {f"{name}.ipynb": latest.data}
    record = find_assignment(name).record_file
    if record is not None and record in hand_in.data:
        beside = _beside(latest, hand_in.data[record])
        files[record] = newest_version(beside or hand_in.data[record])[0].data
    sent = _beside(latest, hand_in.tries.get(tries_file_name(name), ()))
    inner = Path(folder.name, name)
    if timestamp is not None:
        files[TIMESTAMP_FILE] = f"{timestamp}\n".encode()
    if doubts:
        several = f"as the latest of {len(versions)} versions, " if len(versions) > 1 else ""
        said = f"{shortened(latest.path)} was graded {several}but {'; '.join(doubts)}"
        files[VERSIONS_FILE] = f"{one_line(said)}\n".encode(errors="replace")
    replaced = {file for file, content in files.items() if _write_below(folder.parent, inner / file, content)}
    if sent:
        _write_below(folder.parent, inner / tries_file_name(name), newest_version(sent)[0].data)
    else:  # those of a hand-in before, which the student does not send any more
        (folder / name / tries_file_name(name)).unlink(missing_ok=True)
    notes = [f"the latest of {len(versions)} versions: {shortened(latest.path)}"] if len(versions) > 1 else []
    notes += [] if latest.is_readable else ["cannot be read as a notebook"]
    notes += [f"not clear which is the latest: {'; '.join(doubts)}"] if doubts else []
    notes += ["replaces what was collected before"] if replaced else []
    (folder / name / UNTOUCHED_FILE).unlink(missing_ok=True)
    if not doubts:
        (folder / name / VERSIONS_FILE).unlink(missing_ok=True)
    stale = folder / name / TIMESTAMP_FILE
    if timestamp is None and f"{name}.ipynb" in replaced and stale.is_file():
        stale.unlink()
        notes.append("the time of the hand-in is not known, that of the one before was removed")
    return notes


def _beside(notebook: Version, files: Sequence[Version]) -> list[Version]:
    """The files in the folder of a notebook."""
    return [one for one in files if _folder_of(one.path) == _folder_of(notebook.path)]


def _folder_of(path: str) -> str:
    return path.rpartition("/")[0]


def _write_below(out: Path, inner: Path, content: bytes) -> bool:
    """Write a file below OUT unless it exists with the same content; returns whether it replaced another content."""
    path = out / inner
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.parent.resolve() != out.resolve() / inner.parent or path.is_symlink():
        raise ValueError(f"{path} is a symbolic link, or is below one; collect into another folder.")
    exists = path.is_file()
    if exists and path.read_bytes() == content:
        return False
    write_file(path, content)
    return exists
