"""Walks over the syntax trees of student code without recursion: code that Python runs can be nested 3,000 deep.

A chain of a thousand calls, sums or ``elif`` is one tree of that depth. `ast.unparse`, `ast.dump` and `ast.NodeVisitor`
stop at a few hundred, and all but ``ast.walk`` need a stack frame for each level.
"""

import ast
from collections.abc import Iterator
from typing import Any

_END = object()


def in_order(root: ast.AST, closed: tuple[type[ast.AST], ...] = ()) -> Iterator[ast.AST]:
    """All nodes in the order of the source, each before those in it, which may be changed before the next one.

    Parameters
    ----------
    root : ast.AST
    closed : tuple of type
        Kinds of nodes that are not looked into.
    """
    waiting = [root]
    while waiting:
        node = waiting.pop()
        yield node
        if not isinstance(node, closed):
            waiting.extend(reversed(list(ast.iter_child_nodes(node))))


def last_name(node: ast.expr) -> str:
    """The name of a variable or of an attribute, such as a function that is called, without what stands before its dot.

    Empty for any other expression.
    """
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def flat_text(node: ast.AST) -> str:
    """A text that is equal for equal trees alone, wherever they stand in the source."""
    parts: list[str] = []
    waiting: list[Any] = [node]
    while waiting:
        part = waiting.pop()
        if isinstance(part, ast.AST):
            parts.append(type(part).__name__)
            waiting += reversed([getattr(part, name, None) for name in part._fields if name not in ("ctx", "kind")])
        elif isinstance(part, list):
            parts.append("[")
            waiting += [_END, *reversed(part)]
        else:
            parts.append("]" if part is _END else constant_text(part))
    return " ".join(parts)


def constant_text(value: object) -> str:
    """The `repr` of a constant; a large integer, of which Python writes no decimal digits, in hexadecimal ones."""
    return hex(value) if type(value) is int else repr(value)


def is_deep(root: ast.AST, levels: int) -> bool:
    """Whether a tree has more levels than these."""
    row: list[ast.AST] = [root]
    for _ in range(levels):
        row = [inner for node in row for inner in ast.iter_child_nodes(node)]
        if not row:
            return False
    return True


def stored_name(node: ast.AST, with_changed: bool = True) -> str | None:
    """The name that a target of an assignment stores or, `with_changed`, of whose value it stores a part; else None."""
    if not (isinstance(node, ast.Name | ast.Attribute | ast.Subscript) and isinstance(node.ctx, ast.Store)):
        return None
    owner: ast.expr = node
    while with_changed and isinstance(owner, ast.Attribute | ast.Subscript):
        owner = owner.value
    return owner.id if isinstance(owner, ast.Name) else None
