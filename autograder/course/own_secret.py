"""The course's own secret: the seed of the hidden inputs, and of the records that a course shares.

``labsid course build`` makes it once. A course without it, such as the demonstration, uses a public one, with which
everybody can compute what is withheld. Individual records have a secret of their own, the option ``--secret``.
"""

import hashlib
import hmac
import os
import secrets
from pathlib import Path

from autograder.course.individual_data import individual_file
from autograder.course.layout import RECORD_FILE as LAB_FILE
from autograder.course.layout import Course
from autograder.course.own_rig import rig_file
from autograder.course.settings import read_settings
from labsid._files import write_file
from labsid.rig import read_secret
from labsid.rig.switchable.withheld_effects import RECORD_FILE, STAND_IN_STUDENT

PUBLIC_SECRET = b"labsid: inputs of functions under test"
"""The secret of a course without one of its own."""


def make_own_secret(course: Course) -> bool:
    """Make the course's own secret, readable by its owner alone; returns False if there is one already."""
    course.secret_file.parent.mkdir(parents=True, exist_ok=True)
    try:
        descriptor = os.open(course.secret_file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except FileExistsError:
        return False
    with os.fdopen(descriptor, "w", encoding="ascii") as file:
        file.write(secrets.token_hex(32) + "\n")
    return True


def read_own_secret(course: Course) -> bytes:
    """The course's own secret, or the public one if it has none; `ValueError` if the file holds no valid secret."""
    return read_secret(course.secret_file) if course.secret_file.is_file() else PUBLIC_SECRET


def shared_file(course: Course, name: str) -> Path:
    """Path of a data file that all students of a course share; that of a withheld or own rig is made if necessary.

    Parameters
    ----------
    course : Course
    name : str
        Name of the file beside the notebook.
    """
    rig = read_settings(course).rig if name == LAB_FILE else None
    if rig is not None:
        return rig_file(rig, course.own_data)
    if name != RECORD_FILE or not course.secret_file.is_file():
        return course.data / name
    secret = read_own_secret(course)
    folder = course.own_data / hmac.new(secret, name.encode(), hashlib.sha256).hexdigest()[:32]
    if not (folder / name).is_file():
        folder.mkdir(parents=True, exist_ok=True)
        write_file(folder / name, individual_file(name, STAND_IN_STUDENT, secret))
    return folder / name
