"""Reproducible random numbers: seeds from a course's secret and a student's ID, and draws that no platform changes."""

import hashlib
import hmac
import unicodedata
from os import PathLike
from pathlib import Path

import numpy as np

from labsid._arrays import FloatArray

SHORTEST_SECRET = 16
"""Bytes below which a secret can be guessed."""


def read_secret(path: str | PathLike[str]) -> bytes:
    """Read a course's secret from a file.

    Parameters
    ----------
    path : path
        Its white space at both ends does not count, so an editor's last line break changes no record.

    Returns
    -------
    bytes

    Raises
    ------
    OSError
        If it cannot be read.
    ValueError
        If it is empty or shorter than 16 bytes.
    """
    return _checked_secret(Path(path).read_bytes().strip(), f"the secret in {Path(path).name}")


def student_entropy(student: str, secret: bytes, purpose: str = "") -> int:
    """Seed everything random about one student's rig.

    Parameters
    ----------
    student : str
        As for `student_plan`.
    secret : bytes
        As for `student_plan`.
    purpose : str
        What the rig is for: those of two purposes have nothing in common. Unless given, the lab.

    Returns
    -------
    int
        HMAC-SHA256 of the ID, as a number of 256 bits: no secret, no number.

    Raises
    ------
    ValueError
        As for `student_plan`.
    """
    # an ID holds no control character, so no ID is another purpose's
    message = f"{purpose}\0{_checked_id(student)}" if purpose else _checked_id(student)
    return int.from_bytes(hmac.digest(_checked_secret(secret, "secret"), message.encode(), hashlib.sha256), "big")


def uniform_samples(seed: np.random.SeedSequence, n: int) -> FloatArray:
    """Draw `n` numbers, uniform in (0, 1).

    Parameters
    ----------
    seed : SeedSequence
    n : int

    Returns
    -------
    ndarray, shape (n,)

    Notes
    -----
    From the raw bits of PCG64, which numpy promises never to change; it makes no such promise of the
    distributions of its `Generator`. A record must be made again from its secret years later.
    """
    bits = np.random.PCG64(seed).random_raw(n) >> np.uint64(11)
    return (bits.astype(np.float64) + 0.5) * 2.0**-53


def _checked_secret(secret: bytes, name: str) -> bytes:
    if len(secret) < SHORTEST_SECRET:
        raise ValueError(
            f"{name} must have at least {SHORTEST_SECRET} bytes; got {len(secret)}. "
            'Make one with `python -c "import secrets; print(secrets.token_hex(32))"`.'
        )
    return secret


def _checked_id(student: str) -> str:
    if not student.strip():
        raise ValueError("student must be an ID; got an empty one. Give the ID as the course writes it.")
    if student != student.strip():
        raise ValueError(f"student must have no white space at its ends; got {student!r}. Take it away.")
    for character in student:
        if unicodedata.category(character) in ("Cc", "Cf", "Cs", "Zl", "Zp"):
            raise ValueError(
                f"student must hold no control characters; got {character!r} in {student!r}. Type the ID again."
            )
    return unicodedata.normalize("NFC", student)
