"""Data files generated for each student from the course's secret and the student's ID."""

from importlib import import_module

from autograder.course.layout import RECORD_FILE
from autograder.course.own_rig import OwnRig, rig_fingerprint, rig_student_file
from autograder.course.sources import sources_hash


def lab_file(student: str, secret: bytes) -> bytes:
    """One student's record of the tanks, as ``labsid data make --student ID --secret FILE`` writes it."""
    from labsid.rig import lab_record_bytes, make_lab_record

    return lab_record_bytes(make_lab_record(student, secret))


_GENERATORS = {
    RECORD_FILE: (__name__, "lab_file"),
    "WithheldRig.csv": ("labsid.rig.switchable.withheld", "withheld_record_bytes"),
}
"""The function of (student, secret) that generates each individual file, as module and name, by file name."""


def is_individual(name: str) -> bool:
    """Whether the data file of that name can be generated for each student."""
    return name in _GENERATORS


def individual_file(name: str, student: str, secret: bytes, rig: OwnRig | None = None) -> bytes:
    """One student's own data file.

    Parameters
    ----------
    name : str
        Name of the file beside the notebook.
    student : str
    secret : bytes
    rig : OwnRig, optional
        The course's own rig in the place of the tanks.

    Raises
    ------
    ValueError
        If `student` is not a usable ID, or files of that name are not individual.
    """
    if name not in _GENERATORS:
        raise ValueError(f"{name} is the same for everybody; individual files are {', '.join(_GENERATORS)}.")
    if rig is not None and name == RECORD_FILE:
        return rig_student_file(rig, student, secret)
    module, function = _GENERATORS[name]
    content: bytes = getattr(import_module(module), function)(student, secret)
    return content


def generator_hash(name: str, rig: OwnRig | None = None) -> str:
    """Fingerprint of what an individual file follows from: the code that generates it, and the course's own rig."""
    code = sources_hash(_GENERATORS[name][0], __name__)
    return code if rig is None or name != RECORD_FILE else code + rig_fingerprint(rig)
