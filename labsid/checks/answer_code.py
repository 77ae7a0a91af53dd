"""What the code of an answer holds: its numbers, the functions that it calls, and where a function of it ends.

A cause that is told from a number alone may be another's; where the code is known, it decides.
"""

import ast
import operator
from collections.abc import Iterator
from typing import Any

from labsid.checks.cell_names import parse_python
from labsid.checks.permitted import without_magic
from labsid.checks.syntax_trees import in_order, last_name
from labsid.checks.verdict import NoAnswer

_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)
_LOOPS = (ast.For, ast.While)
_CONDITIONS = (ast.If, ast.For, ast.While, ast.Try, ast.Match)
_OPERATIONS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv}
_RETURN_NONE = ("append", "extend", "insert", "sort", "reverse", "print", "shuffle", "fill")
"""Functions and methods that change or show something, and return None."""
_NOT_IN_PLACE = ("reshape", "ravel", "flatten", "transpose", "squeeze", "round", "astype", "cumsum", "clip")
"""Functions and methods that return an array and leave the one that they are given as it is."""
_RANDOM = (
    "standard_normal",
    "normal",
    "randn",
    "uniform",
    "rand",
    "random",
    "choice",
    "integers",
    "multivariate_normal",
)
"""Functions that draw random numbers."""
_LONGEST = 60  # characters of a line in a message


class AnswerCode:
    """The code of an answer, or of a function of it.

    Parameters
    ----------
    text : str
        Python; code that cannot be parsed holds nothing.
    """

    def __init__(self, text: str) -> None:
        self._text = text
        try:
            self._tree = parse_python(without_magic(text))
        except (SyntaxError, ValueError):
            self._tree = ast.Module([], [])

    @property
    def numbers(self) -> frozenset[float]:
        """The numbers that are written, what an operation makes of two of them, such as 2/3, and 1/x of a divisor x."""
        return frozenset(number for node in in_order(self._tree) for number in _number(node))

    @property
    def calls(self) -> frozenset[str]:
        """The names of the functions and methods that are called, without what stands before the last point."""
        called = (node.func for node in in_order(self._tree) if isinstance(node, ast.Call))
        return frozenset(name for one in called if (name := last_name(one)))

    @property
    def random_call(self) -> str:
        """The first function that draws random numbers; empty without one."""
        return next((one for one in _RANDOM if one in self.calls), "")

    def calls_without(self, name: str, keyword: str) -> bool:
        """Whether a function of that name is called with one argument, and without this keyword."""
        return any(
            isinstance(node, ast.Call)
            and last_name(node.func) == name
            and len(node.args) == 1
            and all(one.arg != keyword for one in node.keywords)
            for node in in_order(self._tree)
        )

    @property
    def has_loop(self) -> bool:
        """Whether there is a `for` or a `while`."""
        return any(isinstance(node, _LOOPS) for node in in_order(self._tree))

    def reads(self, name: str) -> bool:
        """Whether a name is read."""
        return any(
            isinstance(node, ast.Name) and node.id == name and isinstance(node.ctx, ast.Load)
            for node in in_order(self._tree)
        )

    @property
    def kept_nowhere(self) -> str:
        """The first line that computes or reshapes a variable and keeps nothing of it; empty without one.

        The last line of a cell is shown, and does not count.
        """
        for node in self._tree.body[:-1]:
            value = node.value if isinstance(node, ast.Expr) else None
            is_reshaped = isinstance(value, ast.Call) and last_name(value.func) in _NOT_IN_PLACE
            if (isinstance(value, ast.BinOp) or is_reshaped) and isinstance(node, ast.Expr):
                return self._line(node)
        return ""

    @property
    def divides(self) -> bool:
        """Whether one thing is divided by another."""
        return any(isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div) for node in in_order(self._tree))

    @property
    def shrinks_its_loop(self) -> bool:
        """Whether a `for` goes over a list from which its lines remove."""
        loops = (node for node in in_order(self._tree) if isinstance(node, ast.For) and isinstance(node.iter, ast.Name))
        return any(loop.iter.id in _shrunk(loop) for loop in loops if isinstance(loop.iter, ast.Name))

    @property
    def returns_in_loop(self) -> bool:
        """Whether a `return` stands in a `for` or a `while`."""
        loops = (node for node in in_order(self._tree) if isinstance(node, _LOOPS))
        return any(isinstance(inner, ast.Return) for loop in loops for inner in in_order(loop, _FUNCTIONS))

    @property
    def index_of_the_one_before(self) -> str:
        """The first entry that is read with an index such as `n - 1`, as it is written; empty without one."""
        for node in in_order(self._tree):
            index = node.slice if isinstance(node, ast.Subscript) else None
            if not isinstance(index, ast.BinOp) or not isinstance(index.op, ast.Sub):
                continue
            owner, one = node.value, index.right  # type: ignore[attr-defined]
            is_one = isinstance(one, ast.Constant) and one.value == 1
            if is_one and isinstance(owner, ast.Name) and isinstance(index.left, ast.Name):
                return f"{owner.id}[{index.left.id} - 1]"
        return ""

    def has(self, *numbers: float, within: float = 1e-9) -> bool:
        """Whether one of these numbers is written, up to a relative distance."""
        written = self.numbers
        return any(abs(one - number) <= within * abs(number) for one in written for number in numbers)

    @property
    def ends_in_first_pass(self) -> str:
        """The head of a loop whose body ends with a `return` that no condition guards; empty if there is none.

        Such a loop makes one pass at most.
        """
        for node in in_order(self._tree):
            is_loop = isinstance(node, _LOOPS) and any(isinstance(one, ast.Return) for one in node.body)
            if is_loop and not any(isinstance(one, ast.Continue) for one in in_order(node)):
                return self._line(node).rstrip(":")  # type: ignore[arg-type]
        return ""

    def returns(self) -> tuple[list[str], list[str]]:
        """The `return` lines with a result that are always reached, and those inside a condition or a loop."""
        functions = (node for node in self._tree.body if isinstance(node, ast.FunctionDef))
        function = next(functions, None)
        outer: list[str] = []
        inner: list[str] = []
        for statement in [] if function is None else function.body:
            found = [node for node in in_order(statement, _FUNCTIONS) if isinstance(node, ast.Return) and node.value]
            lines = [self._line(node) for node in found]
            (inner if isinstance(statement, _CONDITIONS) else outer).extend(lines)
        return outer, inner

    def returned_call(self) -> str:
        """The name of a function that returns None and whose result a `return` hands back; empty if there is none."""
        for node in in_order(self._tree):
            value = node.value if isinstance(node, ast.Return) else None
            if isinstance(value, ast.Call) and last_name(value.func) in _RETURN_NONE:
                return last_name(value.func)
        return ""

    def _line(self, node: ast.stmt) -> str:
        lines = self._text.splitlines()
        line = lines[node.lineno - 1].partition("#")[0].strip() if node.lineno <= len(lines) else ""
        return line if len(line) <= _LONGEST else f"{line[:_LONGEST]}..."


def _shrunk(loop: ast.For) -> frozenset[str]:
    """The lists from which a loop removes, with `remove`, `pop` or `del`."""
    methods = (
        node.func.value
        for node in in_order(loop)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in ("remove", "pop")
    )
    deleted = (
        target.value
        for node in in_order(loop)
        if isinstance(node, ast.Delete)
        for target in node.targets
        if isinstance(target, ast.Subscript)
    )
    return frozenset(owner.id for owner in (*methods, *deleted) if isinstance(owner, ast.Name))


def code_of(ask: object, name: str = "") -> AnswerCode | None:
    """The code of the student's function of that name, or of the answer; None where it is not known.

    Parameters
    ----------
    ask : object
        An `Ask`.
    name : str, optional
        Of a function; without it, the code of the answer cell, which grading does not know.
    """
    source_of: Any = getattr(ask, "source_of", None)
    text = source_of(name) if callable(source_of) else ""
    return AnswerCode(text) if text else None


def function_in(source: str, name: str) -> str:
    """The text of the last function of that name in a source; empty if there is none."""
    try:
        tree = parse_python(without_magic(source))
    except (SyntaxError, ValueError):
        return ""
    found = [node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == name]
    lines = source.splitlines()
    return "\n".join(lines[found[-1].lineno - 1 : found[-1].end_lineno]) if found else ""


def ended_early(name: str, text: str) -> str:
    """A sentence if a function ends in the first pass of a loop; or nothing.

    Parameters
    ----------
    name, text : str
        Of the function.
    """
    loop = AnswerCode(text).ends_in_first_pass
    return (
        f"In `{name}` a `return` stands inside the loop `{loop}`, and ends the function in the first pass."
        if loop
        else ""
    )


def nothing_returned(ask: object, name: str, what: str = "the result", slip: str = "no return") -> NoAnswer:
    """What to say of a function that has returned None; where its code is known, why.

    Parameters
    ----------
    ask : object
        An `Ask`.
    name : str
        Of the function.
    what : str
        What it should return.
    slip : str
    """
    code = code_of(ask, name)
    outer, inner = ([], []) if code is None else code.returns()
    says = f"`{name}` returns nothing"
    if code is None or not (outer or inner):
        after = ", after its loops" if code is None or code.has_loop else ""
        return NoAnswer(f"{says}: end it with `return` and {what}{after}.", slip)
    if code.returned_call():
        called = code.returned_call()
        text = f"it hands back what `{called}` returns, and `{called}` returns None. Return {what} itself."
    elif inner and not outer and code.ends_in_first_pass:
        text = (
            f"its `{inner[-1]}` stands inside the loop `{code.ends_in_first_pass}`. There it ends the function in the "
            "first pass, and is never reached where the loop makes none. Put it after the loop, indented as the "
            "loop's first line is."
        )
    elif inner and not outer:
        text = (
            f"its `{inner[-1]}` stands inside a condition or a loop, and was not reached for what was handed over. A "
            f"last line `return ...` with {what}, indented as the first line is, is always reached."
        )
    else:
        text = f"what its `{(outer or inner)[-1]}` hands back is None for what was handed over: print it before."
    return NoAnswer(f"{says} for some arguments: {text}" if inner and not outer else f"{says}: {text}", slip)


def _number(node: ast.AST) -> Iterator[float]:
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        yield from _as_float(node.value)
    elif isinstance(node, ast.BinOp) and type(node.op) in _OPERATIONS:
        sides = [one.value for one in (node.left, node.right) if isinstance(one, ast.Constant)]
        divides = isinstance(node.op, ast.Div) and isinstance(node.right, ast.Constant)
        if divides and type(node.right.value) in (int, float) and node.right.value:  # type: ignore[attr-defined]
            yield 1 / node.right.value  # type: ignore[attr-defined]
        if len(sides) == 2 and all(type(one) in (int, float) for one in sides):
            try:
                yield float(_OPERATIONS[type(node.op)](*sides))
            except ArithmeticError:
                return


def _as_float(value: Any) -> Iterator[float]:
    try:
        yield float(value)
    except OverflowError:
        return
