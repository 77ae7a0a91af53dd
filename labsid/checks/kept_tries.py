"""Tries at questions as a student may keep them: the question, the minute, right or wrong, the mistake's name.

A file of tries holds no code, no values and no times of day. Anybody can edit it, so it is read with limits, and
nothing but a class's statistics is made of it.
"""

import json
from collections.abc import Collection, Sequence
from dataclasses import asdict, dataclass
from html import escape

FORMAT = "labsid.tries/1"

OTHER = "other"
"""The name of a mistake that is not one of the known ones."""

MAX_TRIES = 2_000
"""Tries in one file; a notebook has at most 20 questions."""

MAX_BYTES = 400_000
"""Size of a file; the `MAX_TRIES` longest tries of the course's own questions and mistakes fill less."""

MAX_MINUTE = 100_000
_MAX_NAME = 80  # characters of a question or a mistake
_FIELDS = {"question", "minute", "right", "slip"}


@dataclass(frozen=True, slots=True, order=True)
class KeptTry:
    """One try at a question.

    Attributes
    ----------
    question : str
        The id of its check.
    minute : int
        Whole minutes of work since tries were first kept.
    right : bool
        Whether the check accepted the answer.
    slip : str
        Name of the known mistake, or `OTHER`; empty if the answer was right.
    """

    question: str
    minute: int
    right: bool
    slip: str = ""


def tries_file_name(assignment: str) -> str:
    """Name of the file beside the notebook of an assignment."""
    return f"{assignment}-tries.json"


def tries_bytes(tries: Sequence[KeptTry]) -> bytes:
    """The content of a file of tries; one line for each, so that a student can read it."""
    lines = ",\n".join(f"  {json.dumps(asdict(one))}" for one in tries)
    inside = f"[\n{lines}\n]" if tries else "[]"
    return f'{{"format": "{FORMAT}", "tries": {inside}}}\n'.encode()


def read_tries(content: bytes, questions: Collection[str] | None = None) -> tuple[KeptTry, ...]:
    """Read a file of tries, which may have been forged.

    Parameters
    ----------
    content : bytes
    questions : collection of str, optional
        The ids that are kept; tries at other questions are ignored.

    Returns
    -------
    tuple of KeptTry

    Raises
    ------
    ValueError
        If it is too large, or not a file of tries.
    """
    if len(content) > MAX_BYTES:
        raise ValueError(f"it has more than {MAX_BYTES} bytes")
    try:
        document = json.loads(content)
    except (ValueError, RecursionError):
        raise ValueError("it is not JSON") from None
    listed = document.get("tries") if isinstance(document, dict) and document.get("format") == FORMAT else None
    if not isinstance(listed, list):
        raise ValueError(f"it is not of the format {FORMAT}")
    if len(listed) > MAX_TRIES:
        raise ValueError(f"it has more than {MAX_TRIES} tries")
    tries = tuple(map(_read_try, listed))
    return tries if questions is None else tuple(attempt for attempt in tries if attempt.question in questions)


def _read_try(fields: object) -> KeptTry:
    if not isinstance(fields, dict) or set(fields) != _FIELDS:
        raise ValueError(f"a try has other fields than {', '.join(sorted(_FIELDS))}")
    one = KeptTry(**fields)
    texts_fit = all(isinstance(text, str) and len(text) <= _MAX_NAME for text in (one.question, one.slip))
    if not texts_fit or not (one.question + one.slip).isprintable():
        raise ValueError(f"a name is not a printable text of at most {_MAX_NAME} characters")
    if type(one.minute) is not int or not 0 <= one.minute <= MAX_MINUTE:
        raise ValueError(f"a minute is not a whole number from 0 to {MAX_MINUTE}")
    if type(one.right) is not bool or one.right == bool(one.slip):
        raise ValueError("a try is right without a mistake, or wrong with one")
    return one


def tries_text(tries: Sequence[KeptTry]) -> str:
    """The tries as a table of text."""
    wide = max(len("question"), max((len(one.question) for one in tries), default=0))
    rows = (f"{one.minute:6d}  {one.question:<{wide}}  {_said(one)}" for one in tries)
    return "\n".join([f"minute  {'question':<{wide}}  result", *rows])


def tries_html(tries: Sequence[KeptTry]) -> str:
    """The tries as an HTML table."""
    left = 'style="text-align:left"'
    rows = (
        f"<tr><td>{one.minute}</td><td {left}>{escape(one.question)}</td><td {left}>{escape(_said(one))}</td></tr>"
        for one in tries
    )
    head = f"<tr><th>minute</th><th {left}>question</th><th {left}>result</th></tr>"
    return f"<table><thead>{head}</thead><tbody>{''.join(rows)}</tbody></table>"


def _said(one: KeptTry) -> str:
    return "right" if one.right else f"not right: {one.slip}"
