"""Detection of copied code: cells that are equal apart from white space, comments and the names they define.

The normal form of a cell is its syntax tree without docstrings, with the names that the cell defines numbered in order
of appearance. Short cells and code that many students wrote are ignored. Whole notebooks and free texts that are equal
are reported however many students have them.
"""

import ast
import hashlib
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from autograder.intake.submission import NotebookCell
from autograder.results.result_files import StoredResult
from labsid.checks.cell_names import parse_python
from labsid.checks.syntax_trees import flat_text, in_order

MIN_NODES = 25
"""Code with fewer syntax tree nodes is ignored in pairs."""

MAX_PARSED_CHARACTERS = 100_000
"""Longer cells are compared as text: a syntax tree takes up to 1000 bytes a character."""

MAX_SHARING = 3
"""Code shared by more students, and by more than a tenth of the class, is ignored."""


MIN_NOTEBOOK_NODES = 150
"""Notebooks with fewer syntax tree nodes are not compared as a whole."""

MIN_WORDS = 8
"""Shorter free texts are ignored."""


@dataclass(frozen=True, slots=True)
class EqualWork:
    """Submissions of one assignment with equal notebooks, or with the same free text.

    Attributes
    ----------
    assignment : str
    question : str or None
        The question that the text answers; None for whole notebooks.
    students : tuple of str
    """

    assignment: str
    question: str | None
    students: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class SimilarPair:
    """Two submissions of one assignment with the same code.

    Attributes
    ----------
    assignment, first, second : str
    questions : tuple of str
        Questions whose code is equal.
    share : float
        Equal share of the code that is compared, 0 to 1.
    """

    assignment: str
    first: str
    second: str
    questions: tuple[str, ...]
    share: float


def find_equal(stored: Iterable[StoredResult]) -> list[EqualWork]:
    """Whole notebooks and free texts that several students have, by the number of students.

    The code of equal notebooks has the same normal form in every question. Of free texts only the words count.
    """
    owners: dict[tuple[str, str | None, object], list[str]] = {}
    for result in stored:
        if sum(size for _, size in result.work.values()) >= MIN_NOTEBOOK_NODES:
            code = tuple(sorted((question, digest) for question, (digest, _) in result.work.items()))
            owners.setdefault((result.assignment, None, code), []).append(result.student)
        for question in result.questions:
            words = tuple(re.findall(r"\w+", question.answer.casefold())) if question.status == "manual" else ()
            if len(words) >= MIN_WORDS:
                owners.setdefault((result.assignment, question.question, words), []).append(result.student)
    equal = [EqualWork(name, question, tuple(who)) for (name, question, _), who in owners.items() if len(who) > 1]
    return sorted(equal, key=lambda one: (one.question is not None, -len(one.students), one.assignment, one.students))


def code_fingerprints(cells: Sequence[NotebookCell], released: Mapping[str, str]) -> dict[str, tuple[str, int]]:
    """Fingerprint and size of the student's normalised code for each question.

    Parameters
    ----------
    cells : sequence of NotebookCell
    released : mapping
        Source of each released cell, by grade_id; unchanged answers are ignored.

    Returns
    -------
    dict
        By question.
    """
    fingerprints: dict[str, tuple[str, int]] = {}
    code: list[str] = []
    for cell in cells:
        if cell.kind in ("answer", "extra") and cell.code:
            if cell.source.strip() != released.get(cell.id or "", "").strip():
                code.append(cell.source)
        elif cell.kind in ("question", "tests"):
            forms = [normal_form(source) for source in code]
            size = sum(size for _, size in forms)
            if size:
                joined = "\n".join(text for text, _ in forms)
                fingerprints[cell.id or ""] = (
                    hashlib.sha256(joined.encode(errors="surrogatepass")).hexdigest()[:32],
                    size,
                )
            code = []
    return fingerprints


def normal_form(source: str) -> tuple[str, int]:
    """The normal form of a cell, and its number of syntax tree nodes."""
    try:
        if len(source) > MAX_PARSED_CHARACTERS:
            raise ValueError("too long to be parsed")
        tree = parse_python(source)
    except (SyntaxError, ValueError, RecursionError, MemoryError):  # not Python: compare as text
        words = source.split()
        return " ".join(words), len(words)
    _number_names(tree)
    return flat_text(tree), sum(1 for _ in ast.walk(tree))


def _number_names(tree: ast.Module) -> None:
    """Number the names that the code defines, in order of appearance; remove annotations and docstrings."""
    made = [node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)]
    made += [node.arg for node in ast.walk(tree) if isinstance(node, ast.arg)]
    made += [node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.ClassDef)]
    own = set(made)
    names: dict[str, str] = {}

    def numbered(name: str) -> str:
        return names.setdefault(name, f"v{len(names)}") if name in own else name

    for node in in_order(tree):
        if isinstance(node, ast.Name):
            node.id = numbered(node.id)
        elif isinstance(node, ast.arg):
            node.arg, node.annotation = numbered(node.arg), None
        elif isinstance(node, ast.ClassDef):
            node.name = numbered(node.name)
        elif isinstance(node, ast.FunctionDef):
            node.name, node.returns = numbered(node.name), None
            if len(node.body) > 1 and ast.get_docstring(node, clean=False) is not None:
                node.body = node.body[1:]


def find_similar(results: Iterable[StoredResult], min_share: float = 0.6) -> list[SimilarPair]:
    """Find pairs of submissions that share most of their code, most similar first.

    Parameters
    ----------
    results : iterable of StoredResult
    min_share : float
        Smallest share of equal code that is reported.
    """
    by_assignment: dict[str, list[StoredResult]] = {}
    for result in results:
        if result.work:
            by_assignment.setdefault(result.assignment, []).append(result)
    pairs: list[SimilarPair] = []
    for assignment, submissions in by_assignment.items():
        max_sharing = max(MAX_SHARING, len(submissions) // 10)
        students_with = Counter(
            (question, work[0]) for submission in submissions for question, work in submission.work.items()
        )
        holders: dict[tuple[str, str], list[int]] = {}
        sizes = []
        for index, submission in enumerate(submissions):
            compared = {
                question: (digest, size)
                for question, (digest, size) in submission.work.items()
                if size >= MIN_NODES and students_with[question, digest] <= max_sharing
            }
            sizes.append(sum(size for _, size in compared.values()))
            for question, (digest, _) in compared.items():
                holders.setdefault((question, digest), []).append(index)
        shared: dict[tuple[int, int], list[str]] = {}
        for (question, _), students in holders.items():
            for i, first in enumerate(students):
                for second in students[i + 1 :]:
                    shared.setdefault((first, second), []).append(question)
        for (i, j), questions in shared.items():
            submission, later = submissions[i], submissions[j]
            share = sum(submission.work[question][1] for question in questions) / min(sizes[i], sizes[j])
            if share >= min_share and len(questions) > 1:
                order = [question for question in submission.work if question in questions]
                pairs.append(SimilarPair(assignment, submission.student, later.student, tuple(order), share))
    return sorted(pairs, key=lambda pair: (-pair.share, -len(pair.questions), pair.assignment, pair.first, pair.second))
