"""Which values a notebook's cells have typed in: written in numbers and texts, and computed by no code."""

import ast
from collections.abc import Iterable, Iterator, Mapping
from types import MappingProxyType

from labsid.checks.cell_names import parse_python
from labsid.checks.permitted import without_magic
from labsid.checks.syntax_trees import last_name

_DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
_MAKERS = frozenset(
    ("array", "asarray", "column_stack", "reshape", "float", "int", "float64", "list", "tuple", "matrix", "c_", "r_")
)
"""What makes a value of literals alone."""
_FILLERS = frozenset(
    ("append", "extend", "insert", "appendleft", "extendleft", "fill", "put", "update", "setdefault", "__setitem__")
)
"""Methods that put values into what they belong to."""
_FIRST_FILLED = frozenset(("copyto", "put", "place", "putmask", "put_along_axis", "fill_diagonal", "setitem", "insort"))
"""Functions that put values into their first argument."""
_READERS = frozenset(("print", "display", "len", "check", "type", "repr", "str", "help"))
"""Functions that change no argument."""


def typed_names(sources: Iterable[str], names: Iterable[str]) -> frozenset[str]:
    """The names to which cells give a value that is written in them, and that no code computes.

    A value to which code adds, such as a list with ``append`` in a loop, is computed.

    Parameters
    ----------
    sources : iterable of str
        Texts of code cells, in the order in which they were run.
    names : iterable of str
        The names to look for.

    Returns
    -------
    frozenset of str
    """
    typed: dict[str, bool] = {}
    others: dict[str, set[str]] = {}  # names of one and the same object
    for source in sources:
        try:
            body = parse_python(without_magic(source)).body
        except (SyntaxError, ValueError, RecursionError):
            return frozenset()
        for statement in body:
            for name, value in _assignments(statement):
                typed[name] = value is not None and _is_written(value, typed)
            _join_names(statement, others)
            for name in _filled(statement):
                typed |= dict.fromkeys(others.get(name, {name}), False)
    return frozenset(name for name in names if typed.get(name, False))


def _assignments(statement: ast.stmt) -> Iterator[tuple[str, ast.expr | None]]:
    """The names that a statement assigns, each with the expression of its value; None where that is not known."""
    if isinstance(statement, ast.Assign):
        for target in statement.targets:
            yield from _pairs(target, statement.value)
    elif isinstance(statement, ast.AnnAssign):
        yield from _pairs(statement.target, statement.value)
    elif isinstance(statement, _DEFINITIONS):
        yield statement.name, None
        declared = (name for node in ast.walk(statement) if isinstance(node, ast.Global) for name in node.names)
        yield from ((name, None) for name in declared)
    elif not isinstance(statement, ast.AugAssign):
        stored = (node for node in ast.walk(statement) if isinstance(node, ast.Name))
        yield from ((node.id, None) for node in stored if isinstance(node.ctx, ast.Store))


def _pairs(target: ast.expr, value: ast.expr | None) -> Iterator[tuple[str, ast.expr | None]]:
    if isinstance(target, ast.Name):
        yield target.id, value
    elif isinstance(target, ast.Tuple | ast.List):  # brackets: Python nests them 200 deep at most
        parts = value.elts if isinstance(value, ast.Tuple | ast.List) else []
        single = parts if len(parts) == len(target.elts) else [value] * len(target.elts)
        for one, part in zip(target.elts, single, strict=True):
            yield from _pairs(one, part)


def _join_names(statement: ast.stmt, others: dict[str, set[str]]) -> None:
    """Note the names of one object, as ``rows = Phi`` and ``Phi = rows = []`` make them."""
    if isinstance(statement, ast.Assign):
        named = {one.id for one in statement.targets if isinstance(one, ast.Name)}
        for name in named:
            others.pop(name, set()).discard(name)
        same = {statement.value.id} if isinstance(statement.value, ast.Name) else set()
        joined = named.union(same, *(others.get(name, set()) for name in same))
        others |= dict.fromkeys(joined, joined)


def _filled(statement: ast.stmt) -> Iterator[str]:
    """The names of the objects into which a statement puts what it computes.

    In a loop or below a condition, how often or whether is computed, whatever is put there.
    """
    nodes = list(ast.walk(statement))
    is_plain = isinstance(statement, ast.Assign | ast.AugAssign | ast.Expr)
    called = {id(node.func) for node in nodes if isinstance(node, ast.Call)}
    alone = {id(node.value) for node in nodes if isinstance(node, ast.Expr)}
    own = _own_names(nodes) if isinstance(statement, _DEFINITIONS) else set()
    for node in nodes:
        owners: list[ast.expr] = []
        put: list[ast.expr] | None = None  # None: of which nothing is known
        if isinstance(node, ast.Call):
            owners, put = _filled_by(node, id(node) in alone)
        elif isinstance(node, ast.AugAssign):
            owners, put = [node.target], [node.value]
        elif isinstance(node, ast.Assign):
            owners, put = [one for one in node.targets if not isinstance(one, ast.Name)], [node.value]
        elif isinstance(node, ast.Attribute) and node.attr in _FILLERS and id(node) not in called:
            owners = [node.value]  # add = Y.append
        if put is None or not is_plain or not all(map(_is_written, put)):
            yield from {name for name in map(_owner, owners) if name is not None} - own


def _own_names(nodes: Iterable[ast.AST]) -> set[str]:
    """The names of a function's own variables."""
    nodes = list(nodes)
    arguments = {node.arg for node in nodes if isinstance(node, ast.arg)}
    stored = {node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    return arguments | stored - {name for node in nodes if isinstance(node, ast.Global) for name in node.names}


def _filled_by(call: ast.Call, is_alone: bool) -> tuple[list[ast.expr], list[ast.expr] | None]:
    """The objects that a call may change, and what it puts there; None if that is not known.

    A function of the student's may change its arguments, where nothing is made of its result.
    """
    function, named = call.func, [one.value for one in call.keywords]
    out = [one.value for one in call.keywords if one.arg == "out"]
    if isinstance(function, ast.Attribute) and function.attr in _FILLERS:
        return [function.value, *out], [*call.args, *named]
    if isinstance(function, ast.Attribute):
        return [*(call.args[:1] if function.attr in _FIRST_FILLED else []), *out], None
    is_reader = not isinstance(function, ast.Name) or function.id in _READERS
    return [*out, *([] if is_reader or not is_alone else [*call.args, *named])], None


def _owner(node: ast.expr) -> str | None:
    """The name to whose object a part belongs: ``Y`` of ``Y[0].T``."""
    while isinstance(node, ast.Attribute | ast.Subscript | ast.Starred):
        node = node.value
    return node.id if isinstance(node, ast.Name) else None


def _is_written(value: ast.expr, typed: Mapping[str, bool] = MappingProxyType({})) -> bool:
    """Whether an expression is made of numbers, texts and `typed` names, and of what makes arrays of them, alone."""
    waiting = [value]
    while waiting:
        one = waiting.pop()
        if isinstance(one, ast.Name) and typed.get(one.id, False):
            continue
        parts = _parts_written(one)
        if parts is None:
            return False
        waiting += parts
    return True


def _parts_written(value: ast.expr) -> list[ast.expr] | None:
    """The parts of an expression that must be written for it to be; None if it is computed in any case."""
    if isinstance(value, ast.Constant):
        return []
    if isinstance(value, ast.Tuple | ast.List | ast.Set):
        return value.elts
    if isinstance(value, ast.UnaryOp):
        return [value.operand]
    if isinstance(value, ast.BinOp):
        return [value.left, value.right]
    if isinstance(value, ast.Starred):
        return [value.value]
    if isinstance(value, ast.Subscript):  # np.r_[1, 2]
        return [value.slice] if isinstance(value.value, ast.Attribute) and value.value.attr in _MAKERS else None
    if isinstance(value, ast.Call):
        function = value.func
        named = last_name(function)
        owner = function.value if isinstance(function, ast.Attribute) else None
        owners = [] if owner is None or isinstance(owner, ast.Name) else [owner]
        keywords = [one.value for one in value.keywords if one.arg not in ("dtype", "ndmin", "copy")]
        return [*owners, *keywords, *value.args] if named in _MAKERS else None
    return None
