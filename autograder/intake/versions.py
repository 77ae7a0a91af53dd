"""Which of several copies of a notebook is the newest one, and whether that is clear.

The copy under the assignment's own name comes first, then the newest by its time, then the last by its number; copies
that are called old come last, and those that cannot be read after them. Students do not always follow these habits, so
every sign to the contrary is a doubt, which the report names.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import cache

from autograder.course.plain_text import shortened

_OLD = re.compile(
    "old|older|oldest|outdated|obsolete|backups?|bak|back|copy|copies|copie|kopie|archived?|previous|prev|earlier|drafts?|"
    "original|orig|unused|deprecated|superseded|trash"
)
_NEW = "final|new|newer|newest|latest|last|corrected|fixed|updated"
_NUMBER = re.compile(rf"(?:\((\d{{1,6}})\)|(\d{{1,6}})|(?<![^\W_])({_NEW}))$", re.I)
_BEFORE_NUMBER = re.compile(r"(?<![^\W_])(?:v|ver|version|rev)$", re.I)
_SEPARATORS = " ._-"
_LAST = 10**6  # the number of a copy that is called final
NOTEBOOK_ENDING = re.compile(r"\.ipynb(\.(txt|json))?[. ]{0,9}$", re.I)
"""End of a notebook's name; some browsers save it as text."""

_ENDING = re.compile(rf"{NOTEBOOK_ENDING.pattern}|\.zip$", re.I)
_MAX_NAME = 200  # characters at the end of a name that are looked at
_UNKNOWN_YEAR = 1980
"""Year of the first time that a zip file can hold; programs that do not know the time write it."""

MAX_DOUBTS = 3  # named


@dataclass(frozen=True, slots=True)
class Version:
    """One copy of a notebook.

    Attributes
    ----------
    path : str
        In the download, below the participant's folder; untrusted.
    assignment : str
    outer : datetime or None
        Time of the file in the download.
    inner : datetime or None
        Time in the zip file that the student handed in; None if it was handed in as it is.
    work : object
        What the student wrote in it; equal for copies of the same work.
    data : bytes
    is_readable : bool
        Whether it could be read, if that was tried.
    """

    path: str
    assignment: str
    outer: datetime | None
    inner: datetime | None
    work: object
    data: bytes
    is_readable: bool = True

    @property
    def when(self) -> datetime | None:
        """When it was saved, or else handed in; None if that is unknown."""
        known = [time for time in (self.inner, self.outer) if time is not None and time.year > _UNKNOWN_YEAR]
        return known[0] if known else None

    @property
    def is_old(self) -> bool:
        """Whether its name or that of a folder says that it is an old copy, or a hidden one."""
        return self._stems[-1].startswith(".") or any(_OLD.fullmatch(word) for word in self._words)

    @property
    def has_own_name(self) -> bool:
        """Whether it is called as the assignment; browsers and Moodle add a number in parentheses."""
        return re.fullmatch(rf"{re.escape(self.assignment)}( ?\(\d+\))?", self._stems[-1], re.I) is not None

    @property
    def names(self) -> tuple[str, ...]:
        """The parts of its path without their numbers."""
        return tuple(name for name, _ in self._numbered)

    @property
    def numbers(self) -> tuple[int, ...]:
        """The numbers of the parts of its path, such as 2 in ``lab_v2`` and ``lab (2)``; 0 without one."""
        return tuple(number for _, number in self._numbered)

    @property
    def _stems(self) -> list[str]:
        return [_ENDING.sub("", part[-_MAX_NAME:]) for part in self.path.split("/")]

    @property
    def _words(self) -> list[str]:
        parts = (re.sub(re.escape(self.assignment), " ", part, flags=re.I) for part in self._stems)
        return re.findall(r"[^\W\d_]+", " ".join(parts).casefold())

    @property
    def _numbered(self) -> list[tuple[str, int]]:
        return [_split_number(stem) for stem in self._stems]


@cache
def _split_number(stem: str) -> tuple[str, int]:
    """A name without the number of its version, and that number."""
    found = _NUMBER.search(stem)
    if found is None:
        return stem.casefold(), 0
    name = stem[: found.start()].rstrip(_SEPARATORS)
    word = _BEFORE_NUMBER.search(name)
    name = name if word is None else name[: word.start()].rstrip(_SEPARATORS)
    return name.casefold(), _LAST if found[3] else int(found[1] or found[2])


def newest_version(versions: Sequence[Version]) -> tuple[Version, tuple[str, ...]]:
    """The newest of several copies, and the doubts about that, one phrase each.

    Parameters
    ----------
    versions : sequence of Version
        At least one.
    """
    chosen = max(versions, key=_rank)
    others = [one for one in versions if one is not chosen and one.work != chosen.work]
    doubts = [f"{shortened(one.path)} {why}" for one in others if (why := _doubt(chosen, one))]
    return chosen, tuple(doubts[:MAX_DOUBTS])


def _rank(version: Version) -> tuple[bool, bool, bool, datetime, tuple[int, ...], tuple[str, ...], str]:
    signs = version.is_readable, not version.is_old, version.has_own_name
    return *signs, version.when or datetime.min, version.numbers, version.names, version.path


def _doubt(chosen: Version, other: Version) -> str:
    """Why another copy may be newer than the chosen one; empty if nothing says so."""
    if chosen.is_readable and not other.is_readable:
        return "cannot be read"
    times = chosen.when, other.when
    if times[0] is not None and times[1] is not None and times[1] > times[0]:
        return "has a later time"
    same_names = chosen.names == other.names
    if same_names and other.numbers > chosen.numbers:
        return "has a later number"
    is_told = chosen.is_old != other.is_old or chosen.has_own_name != other.has_own_name
    is_later = times[0] is not None and times[1] is not None and times[0] > times[1]
    if not is_told and not is_later and not (same_names and chosen.numbers > other.numbers):
        return "differs, and neither name nor time tells which is newer"
    return ""
