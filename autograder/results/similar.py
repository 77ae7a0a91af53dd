"""Suspiciously equal submissions: code that is the same apart from white space, comments and names of its own.

A cell's normal form is its syntax tree with every name that it makes itself numbered in the order of appearance, and
without documentation strings. Short cells are alike by nature and tell nothing; nor does what much of the class wrote.
"""

import ast
import hashlib
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from autograder.course.sources import parse_python
from autograder.intake.submission import NotebookCell
from autograder.results.result_files import StoredResult

MIN_NODES = 25
"""Nodes of the syntax tree below which a cell tells nothing."""

MAX_SHARING = 3
"""So many students may share a cell before it counts as what the class writes; in a large class, a tenth of it."""


@dataclass(frozen=True, slots=True)
class SimilarPair:
    """Two submissions of one assignment with the same code.

    Attributes
    ----------
    assignment, first, second : str
    questions : tuple of str
        Where the code is the same.
    share : float
        Of the code in either that tells something: how much is the same, 0 to 1.
    """

    assignment: str
    first: str
    second: str
    questions: tuple[str, ...]
    share: float


def code_fingerprints(steps: Sequence[NotebookCell], released: Mapping[str, str]) -> dict[str, tuple[str, int]]:
    """The student's code for each question: fingerprint of its normal form, and its size.

    Parameters
    ----------
    steps : sequence of Step
    released : mapping
        Source of each cell of the release, by its grade_id; an answer left as released is left out.

    Returns
    -------
    dict
        By question; only code that is long enough to tell something.
    """
    found: dict[str, tuple[str, int]] = {}
    code: list[str] = []
    for step in steps:
        if step.kind in ("answer", "extra") and step.code:
            if step.source.strip() != released.get(step.id or "", "").strip():
                code.append(step.source)
        elif step.kind == "question":
            forms = [normal_form(source) for source in code]
            size = sum(size for _, size in forms)
            if size >= MIN_NODES:
                joined = "\n".join(text for text, _ in forms)
                found[step.id or ""] = hashlib.sha256(joined.encode(errors="surrogatepass")).hexdigest()[:32], size
            code = []
    return found


def normal_form(source: str) -> tuple[str, int]:
    """A cell without what one changes to hide a copy, and its size in nodes of the syntax tree."""
    try:
        tree = parse_python(source)
        _NameNormaliser(tree).visit(tree)
        return ast.dump(tree), sum(1 for _ in ast.walk(tree))
    except (SyntaxError, ValueError, RecursionError, MemoryError):  # not Python: as text then
        words = source.split()
        return " ".join(words), len(words)


class _NameNormaliser(ast.NodeTransformer):
    """Numbers the names that the code itself makes."""

    def __init__(self, tree: ast.Module) -> None:
        made = [node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)]
        made += [node.arg for node in ast.walk(tree) if isinstance(node, ast.arg)]
        made += [node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.ClassDef)]
        self._own = set(made)
        self._names: dict[str, str] = {}

    def _numbered(self, name: str) -> str:
        return self._names.setdefault(name, f"v{len(self._names)}") if name in self._own else name

    def visit_Name(self, node: ast.Name) -> ast.AST:
        node.id = self._numbered(node.id)
        return node

    def visit_arg(self, node: ast.arg) -> ast.AST:
        node.arg, node.annotation = self._numbered(node.arg), None
        return node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        node.name, node.returns = self._numbered(node.name), None
        if len(node.body) > 1 and ast.get_docstring(node, clean=False) is not None:
            node.body = node.body[1:]
        return self.generic_visit(node)

    def visit_ClassDef(self, node: ast.ClassDef) -> ast.AST:
        node.name = self._numbered(node.name)
        return self.generic_visit(node)


def find_similar(results: Iterable[StoredResult], least: float = 0.6) -> list[SimilarPair]:
    """Pairs of submissions that share most of their telling code, the most alike first.

    Parameters
    ----------
    results : iterable of StoredResult
    least : float
        The share from which on a pair is named.
    """
    by_assignment: dict[str, list[StoredResult]] = {}
    for result in results:
        if result.work:
            by_assignment.setdefault(result.assignment, []).append(result)
    found: list[SimilarPair] = []
    for assignment, submissions in by_assignment.items():
        many = max(MAX_SHARING, len(submissions) // 10)
        common = Counter((question, work[0]) for one in submissions for question, work in one.work.items())
        holders: dict[tuple[str, str], list[int]] = {}
        sizes = []
        for index, one in enumerate(submissions):
            telling = {q: work for q, work in one.work.items() if common[q, work[0]] <= many}
            sizes.append(sum(size for _, size in telling.values()))
            for question, (digest, _) in telling.items():
                holders.setdefault((question, digest), []).append(index)
        shared: dict[tuple[int, int], list[str]] = {}
        for (question, _), students in holders.items():
            for i, first in enumerate(students):
                for second in students[i + 1 :]:
                    shared.setdefault((first, second), []).append(question)
        for (i, j), questions in shared.items():
            one, other = submissions[i], submissions[j]
            share = sum(one.work[question][1] for question in questions) / min(sizes[i], sizes[j])
            if share >= least and len(questions) > 1:
                order = [question for question in one.work if question in questions]
                found.append(SimilarPair(assignment, one.student, other.student, tuple(order), share))
    return sorted(found, key=lambda pair: (-pair.share, -len(pair.questions), pair.assignment, pair.first, pair.second))
