"""Reproducible random numbers: seeds from a course's secret and a student's ID, and draws equal on every platform."""

import hashlib
import hmac
import unicodedata
from os import PathLike
from pathlib import Path

import numpy as np

from labsid._arrays import FloatArray

SHORTEST_SECRET = 16
"""Minimum length of a secret in bytes (128 bits)."""


def read_secret(path: str | PathLike[str]) -> bytes:
    """Read a course's secret from a file.

    Parameters
    ----------
    path : path
        White space at both ends is ignored, so a line break added by an editor changes no record.

    Returns
    -------
    bytes

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If the secret is empty or shorter than 16 bytes.
    """
    return _checked_secret(Path(path).read_bytes().strip(), f"the secret in {Path(path).name}")


def student_entropy(student: str, secret: bytes, purpose: str = "") -> int:
    """Derive the seed of one student's rig.

    Parameters
    ----------
    student : str
        The student's ID as the course writes it. IDs are case-sensitive; accented letters are compared in their
        composed form (Unicode NFC).
    secret : bytes
        The course's secret, at least 16 bytes. Its holder can reproduce every student's record.
    purpose : str
        What the rig is used for; different purposes give independent seeds. Empty for the lab.

    Returns
    -------
    int
        HMAC-SHA256 of the ID as a 256-bit number.

    Raises
    ------
    ValueError
        If the ID is empty, has white space at an end or holds control characters, or the secret is too short.
    """
    # An ID holds no control character, so "purpose\0ID" never equals another ID.
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
    Uses the raw bits of PCG64, which numpy guarantees never to change; the distributions of `Generator` carry no such
    guarantee, and a record must be reproducible from its secret years later.
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
        raise ValueError(f"student must have no white space at its ends; got {student!r}. Remove it.")
    for character in student:
        if unicodedata.category(character) in ("Cc", "Cf", "Cs", "Zl", "Zp"):
            raise ValueError(
                f"student must hold no control characters; got {character!r} in {student!r}. Type the ID again."
            )
    return unicodedata.normalize("NFC", student)
