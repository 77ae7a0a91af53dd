"""Translate the statements of a Python function to JavaScript."""

import ast
from collections.abc import Iterator

from labsid.gap.reports.javascript.expressions import Expressions, stored_names
from labsid.gap.reports.javascript.names import safe_name


class Statements(Expressions):
    """Translation of one function; see `Expressions` for the subset of Python."""

    def function(self, name: str) -> str:
        """The whole function under another name."""
        node = self.node
        arguments = [safe_name(one.arg) for one in node.args.args]
        for i, default in enumerate(reversed(node.args.defaults), 1):
            arguments[-i] += f" = {self.expression(default)}"
        taken = {one.arg for one in node.args.args} | _of_comprehensions(node)
        own = [safe_name(one) for one in sorted(set(stored_names([node])) - taken)]
        lines = [f"let {', '.join(own)};"] if own else []
        lines += self.block(node.body)
        return f"function {name}({', '.join(arguments)}) {{\n" + "\n".join(lines) + "\n}"

    def block(self, nodes: list[ast.stmt]) -> list[str]:
        """Lines of a sequence of statements."""
        return [line for node in nodes for line in self._statement(node)]

    def _statement(self, node: ast.stmt) -> Iterator[str]:
        match node:
            case ast.Expr(value=ast.Constant()) | ast.Assert() | ast.Pass():
                return
            case ast.AnnAssign(target=target, value=ast.expr() as value):
                yield from self._assignment([target], value)
            case ast.Expr(value=value):
                yield f"{self.expression(value)};"
            case ast.Assign(targets=targets, value=value):
                yield from self._assignment(targets, value)
            case ast.AugAssign(target=target, op=op, value=value):
                read = ast.copy_location(_as_read(target), target)
                changed = self.arithmetic(op, read, value, node)
                yield f"{self._store(target, changed)};"
            case ast.Return(value=value):
                yield "return;" if value is None else f"return {self.expression(value)};"
            case ast.Break():
                yield "break;"
            case ast.Continue():
                yield "continue;"
            case ast.If(test=test, body=body, orelse=orelse):
                yield f"if ({self.expression(test)}) {{"
                yield from self.block(body)
                if orelse:
                    yield "} else {"
                    yield from self.block(orelse)
                yield "}"
            case ast.While(test=test, body=body, orelse=[]):
                yield f"while ({self.expression(test)}) {{"
                yield from self.block(body)
                yield "}"
            case ast.For(target=target, iter=iterated, body=body, orelse=[]):
                yield from self._loop(target, iterated, body)
            case _:
                raise self.unsupported(node, type(node).__name__)

    def _assignment(self, targets: list[ast.expr], value: ast.expr) -> Iterator[str]:
        if len(targets) == 1 and isinstance(targets[0], ast.Tuple) and isinstance(value, ast.Tuple):
            pairs = list(zip(targets[0].elts, value.elts, strict=True))
            yield "{ const " + ", ".join(f"t${i} = {self.expression(one)}" for i, (_, one) in enumerate(pairs)) + ";"
            yield from (f"{self._store(target, f't${i}')};" for i, (target, _) in enumerate(pairs))
            yield "}"
        elif len(targets) == 1:
            yield f"{self._store(targets[0], self.expression(value))};"
        else:
            yield f"{{ const t$ = {self.expression(value)};"
            yield from (f"{self._store(target, 't$')};" for target in targets)
            yield "}"

    def _store(self, target: ast.expr, value: str) -> str:
        match target:
            case ast.Name(id=name):
                return f"{safe_name(name)} = {value}"
            case ast.Tuple(elts=elements) if all(isinstance(one, ast.Name) for one in elements):
                return f"[{', '.join(self.expression(one) for one in elements)}] = {value}"
            case ast.Subscript(value=ast.Name() as stored, slice=index):
                element = self.element(stored, index)
                return (
                    f"np.put({self.expression(stored)}, {self.indices(index)}, {value})"
                    if element is None
                    else f"{element} = {value}"
                )
        raise self.unsupported(target, "this target of an assignment")

    def _loop(self, target: ast.expr, iterated: ast.expr, body: list[ast.stmt]) -> Iterator[str]:
        match iterated:
            case ast.Call(func=ast.Name(id="range"), args=[*limits]) if len(limits) < 3 and isinstance(
                target, ast.Name
            ):
                first = self.expression(limits[0]) if len(limits) == 2 else "0"
                yield f"for (let i$ = {first}, end$ = {self.expression(limits[-1])}; i$ < end$; i$++) {{"
                yield f"{safe_name(target.id)} = i$;"
            case _:
                yield f"for (const i$ of {self.expression(iterated)}) {{"
                yield f"{self._store(target, 'i$')};"
        yield from self.block(body)
        yield "}"


def _of_comprehensions(node: ast.AST) -> set[str]:
    """Names that only comprehensions assign."""
    inner = stored_names(one.target for one in ast.walk(node) if isinstance(one, ast.comprehension))
    every = stored_names([node])
    return {name for name in inner if inner.count(name) == every.count(name)}


def _as_read(target: ast.expr) -> ast.expr:
    """The target of an assignment as an expression."""
    match target:
        case ast.Name(id=name):
            return ast.Name(name, ast.Load())
        case ast.Subscript(value=value, slice=index):
            return ast.Subscript(value, index, ast.Load())
    return target
