"""Causes of Python's errors in products and systems of equations, by the shapes of the matrices."""

import ast
import re

from labsid.checks.empty_slices import begins_below_zero, empty_slice
from labsid.checks.line_values import parsed_line, shape_of
from labsid.checks.repairs import beside, mends, proposal
from labsid.checks.singular_matrices import called, never_inverted, products_in
from labsid.checks.stops import Stop


def products_of_matrices(stop: Stop) -> int:
    """How many `*` a line has, if there are several and the shapes fit when each of them is the product of matrices."""
    tree = parsed_line(stop.line)
    times = [
        node for node in ([] if tree is None else ast.walk(tree))
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult)
    ]  # fmt: skip
    for node in times:
        node.op = ast.MatMult()
    names = {name: thing.shape for name, thing in stop.things.items() if thing.kind == "array" and thing.shape}
    fits = len(times) > 1 and all(shape_of(node, names) is not None for node in times)
    return len(times) if fits else 0


def number_in_a_product(stop: Stop, _: re.Match[str]) -> str | None:
    """`@` with a number on one side."""
    if re.search(r"[\w\])]\s*\^", stop.line):
        return "`^` is no power in Python: a power is `**`, entry by entry, and an inverse `np.linalg.inv(...)`."
    for node in stop.operations(ast.MatMult):
        for side in (node.left, node.right):
            thing = stop.things.get(ast.unparse(side))
            alone = thing is not None and (thing.kind == "number" or thing.shape == ())
            inner = (stop.shape(side.left), stop.shape(side.right)) if isinstance(side, ast.BinOp) else (None, None)
            if isinstance(side, ast.BinOp) and all(shape is not None and len(shape) == 1 for shape in inner):
                left, right = ast.unparse(side.left), ast.unparse(side.right)
                return (
                    f"`{left} @ {right}` is one number: both are flat. (The matrix of all products of their entries is "
                    f"`np.outer({left}, {right})`.)"
                )
            if alone or isinstance(side, ast.Constant):
                name = ast.unparse(side)
                said = f"`@` is the product of arrays, and `{name}` is one number"
                if name in stop.made and not stop.made[name].startswith("for "):
                    return f"{said}, by `{stop.made[name]}`."
                return f"{said}: a multiple is made by `*`."
    return "`@` is the product of arrays; one of the two is a number. A multiple is made by `*`."


def unfit_product(stop: Stop, _: re.Match[str]) -> str | None:
    """`@` between shapes that do not fit."""
    tree = parsed_line(stop.part or stop.line)
    for first, second in [] if tree is None else products_in(tree):
        one, other = stop.shape(first), stop.shape(second)
        if not one or not other or one[-1] == other[0]:
            continue
        left, right = ast.unparse(first), ast.unparse(second)
        text = next((text for text, shape in ((left, one), (right, other)) if 0 in shape), "")
        empty = empty_slice(stop, [text]) or begins_below_zero(stop, text) if text else ""
        if empty:
            return empty
        said = (
            f"In `{left} @ {right}` the first has {one[-1]} columns and the second {other[0]} rows: "
            f"these must be equal."
        )
        fault = never_inverted(stop)
        if fault:
            return f"{said} {fault}"
        parts = (*ast.walk(first), *ast.walk(second))
        flat = [part for part in parts if isinstance(part, ast.Name) and len(stop.shape(part) or ()) == 1]
        product = ast.BinOp(first, ast.MatMult(), second)
        if len(other) == 2 and other[0] == 1 and other[1] == one[-1] and mends(stop, second, f"{right}.ravel()"):
            return f"{said} `{right}` has shape {other}, a table of one row; `{right}.ravel()` is flat."
        fault = _other_size(stop, first, second)
        if fault:
            return f"{said} {fault}"
        weight = next((part.id for part in flat if one[0] != other[0] and re.search(rf"@ {part.id} @", stop.line)), "")
        if weight and mends(stop, ast.Name(weight), f"np.diag({weight})"):
            matrix = f"A matrix with these numbers on its diagonal is `np.diag({weight})`."
            proposed = proposal(stop, ast.Name(weight), f"np.diag({weight})", matrix)
            return " ".join(filter(None, (said, f"`{weight}` is flat.", proposed)))
        inverse = re.search(r"inv\((\w+)\.T @ \1\)$", left)
        if inverse is not None and one[0] < other[0]:
            name = inverse[1]
            if right.endswith(".T"):
                turned = f"{left} @ {name}.T @ {right[:-2]}"
                asked = f"Is `{turned}` meant, with `{name}` transposed instead?"
                return f"{said} {proposal(stop, product, turned, asked)}".rstrip()
            before = f"`{name}.T` in place of `{name}`" if right == name else f"`{name}.T @` before `{right}`"
            repair = f"{left} @ {name}.T" + (f" @ {right}" if right != name else "")
            proposed = proposal(stop, product, repair, f"Is {before} meant?")
            return f"{said} {proposed or _other_order(stop, product)}".rstrip()
        if "inv(" in left:
            return f"{said} {_other_order(stop, product)}".rstrip()
        if one[0] == other[0] and re.fullmatch(r"(-?[\w.]+ \* )?\w+(\.T)?", left):
            turned = left[:-2] if left.endswith(".T") else f"{left}.T"
            repairs = [f"{turned} @ {right}"]
            if len(one) == len(other) == 2 and other[1] == one[0]:
                repairs.append(f"{right} @ {left}")
            proposals = (proposal(stop, product, repair) for repair in repairs if mends(stop, product, repair))
            found = next(filter(None, proposals), "") or _other_order(stop, product) or _owed(stop, product)
            return f"{said} {found}".rstrip()
        is_swapped = len(one) == 1 and len(other) == 2 and other[1] == one[0]
        swapped = proposal(stop, product, f"{right} @ {left}") if is_swapped else ""
        if swapped:
            return f"{said} {swapped}"
        is_turned = len(other) == 2 and other[0] != other[1] == one[-1] and right.isidentifier()
        turned = proposal(stop, product, f"{left} @ {right}.T") if is_turned else ""
        if turned:
            return f"{said} {turned}"
        names = (left.removesuffix(".T"), right.removesuffix(".T"))
        made = [name for name in names if name in stop.made and not stop.made[name].startswith("for ")]
        return " ".join((said, *(f"`{name}` is made by `{stop.made[name]}`." for name in made)))
    kept = next((name for name, made in stop.made.items() if re.search(r"=\s*np\.(as)?mat(rix)?\(", made)), "")
    if kept and "@" not in stop.line:
        return (
            f"`{kept}` is an `np.matrix`, by `{stop.made[kept]}`: its `*` is the product of matrices, and a flat array "
            "beside it stands for one row. With arrays the product is `@`, and takes flat arrays, too."
        )
    return "In `A @ B` the columns of A must be as many as the rows of B."


def _other_size(stop: Stop, first: ast.expr, second: ast.expr) -> str:
    """What made a square matrix that is a factor, and which size it must have; empty if no factor is one.

    What was made with another number of rows and columns is not mended by another order of the factors.
    """
    for part, other, axis in ((second, first, -1), (first, second, 0)):
        shape, beside_it = stop.shape(part), stop.shape(other)
        made = stop.made.get(part.id, "") if isinstance(part, ast.Name) else ""
        if not shape or not beside_it or len(shape) != 2 or shape[0] != shape[1] or not _is_sized(part, made):
            continue
        name = ast.unparse(part)
        square = f"{shape[0]} by {shape[0]}"
        said = f"`{name}` is made by `{made}`: it is {square}" if made else f"`{name}` is {square}"
        third = _factor_behind(stop, first, second) if axis else None
        size = beside_it[axis]
        if third is not None and (stop.shape(third) or (0,))[0] == size:
            left = ast.unparse(first.right if isinstance(first, ast.BinOp) else first)
            right = ast.unparse(third)
            said += f". Between `{left}` and `{right}` a square matrix is {size} by {size}"
            turned = [one[:-2] if one.endswith(".T") else f"{one}.T" for one in (left, right)]
            if turned == [right, left]:
                said += f", and between `{right}` and `{left}` {square}"
        product, swapped = ast.BinOp(first, ast.MatMult(), second), f"{ast.unparse(second)} @ {ast.unparse(first)}"
        proposed = proposal(stop, product, swapped) if third is None and mends(stop, product, swapped) else ""
        return f"{said}. {proposed}".rstrip()
    return ""


_SIZED = re.compile(r"\b(eye|identity|diag|zeros|ones)\(")
"""What makes a matrix of a size that its argument gives."""


def _is_sized(part: ast.expr, made: str) -> bool:
    """Whether a matrix was made with a size of its own, and is no product of what the function is handed."""
    return _SIZED.search(made.partition("=")[2] or ast.unparse(part)) is not None


def _factor_behind(stop: Stop, first: ast.expr, second: ast.expr) -> ast.expr | None:
    """The factor by which a product is multiplied from the right; None without one."""
    tree, product = parsed_line(stop.line), ast.unparse(ast.BinOp(first, ast.MatMult(), second))
    found = [] if tree is None else [right for left, right in products_in(tree) if ast.unparse(left) == product]
    return found[0] if found else None


def _other_order(stop: Stop, product: ast.BinOp) -> str:
    """The product of the same matrix, its transpose and an inverse in another order, where the answer is right then."""
    tree = parsed_line(stop.line)
    whole = next((node for node in ([] if tree is None else ast.walk(tree)) if isinstance(node, ast.BinOp)), None)
    factors = [] if whole is None else _factors(whole)
    if len(factors) != _MOST_FACTORS or whole is None:
        return ""
    first, middle, last = map(ast.unparse, factors)
    if "inv(" not in middle or {first, last} not in ({last, f"{last}.T"}, {first, f"{first}.T"}):
        return ""
    return proposal(stop, whole, f"{last} @ {middle} @ {first}")


_MOST_FACTORS = 3


def _factors(node: ast.expr) -> list[ast.expr]:
    """The factors of a product of matrices by `@`, in their order."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult):
        return [*_factors(node.left), node.right]
    return [node]


def _owed(stop: Stop, product: ast.expr) -> str:
    """The shape that a product must have beside another term; empty where it stands alone."""
    other = beside(stop, product)
    return "" if other is None else f"Beside `{other[0]}`, of shape {other[1]}, the product must have that shape, too."


def unfit_blocks(stop: Stop) -> str:
    """The widths of the rows of `np.block`, and the shape that an empty corner must have; "" if it is not known."""
    for node in stop.expressions():
        if not (isinstance(node, ast.Call) and ast.unparse(node.func).endswith("block") and len(node.args) == 1):
            continue
        rows = (
            [row.elts for row in node.args[0].elts if isinstance(row, ast.List)]
            if isinstance(node.args[0], ast.List)
            else []
        )
        shapes = [[_of_block(stop, part) for part in row] for row in rows]
        known = [[shape for shape in row if shape is not None] for row in shapes]
        if not known or known != shapes:
            continue
        parts = [
            f"row {i} of blocks is {' + '.join(str(width) for _, width in row)} = {sum(width for _, width in row)} wide"
            for i, row in enumerate(known)
        ]
        uneven = [i for i, row in enumerate(known) if len({height for height, _ in row}) > 1]
        said = "In `np.block` "
        if uneven:
            heights = " and ".join(str(height) for height, _ in known[uneven[0]])
            said += f"row {uneven[0]} of blocks (counted from 0) has blocks of {heights} rows, which must be equal."
        elif len({sum(width for _, width in row) for row in known}) > 1:
            said += f"{', '.join(parts)} (counted from 0): these must be equal."
        else:
            continue
        return f"{said}{_not_transposed(stop, node.args[0], rows, known) or _empty_corner(rows, known)}"
    return ""


def _of_block(stop: Stop, part: ast.expr) -> tuple[int, int] | None:
    """The shape of a block: a number is one of 1 by 1, a flat array one row."""
    thing = stop.things.get(ast.unparse(part))
    if isinstance(part, ast.Constant) or (thing is not None and thing.kind == "number"):
        return 1, 1
    shape = stop.shape(part)
    if shape is None or len(shape) > 2:
        return None
    return shape if len(shape) == 2 else (1, *shape) if shape else (1, 1)  # type: ignore[return-value]


def _empty_corner(rows: list[list[ast.expr]], shapes: list[list[tuple[int, int]]]) -> str:
    """What shape the one block of zeros must have, among two by two; "" if there is no such block."""
    empty = [
        (i, j)
        for i, row in enumerate(rows)
        for j, part in enumerate(row)
        if (isinstance(part, ast.Constant) and part.value == 0) or re.match(r"[\w.]*zeros\(", ast.unparse(part))
    ]
    if [len(row) for row in rows] != [2, 2] or len(empty) != 1:
        return ""
    ((i, j),) = empty
    opposite = shapes[1 - i][1 - j]
    fits = (shapes[i][1 - j][0], shapes[1 - i][j][1])
    if (shapes[1 - i][j][0], shapes[i][1 - j][1]) != opposite:  # another block does not fit
        return ""
    corner, beside, over = (ast.unparse(rows[k][m]) for k, m in ((i, j), (i, 1 - j), (1 - i, j)))
    if fits == shapes[i][j]:
        return ""
    return (
        f" The empty corner `{corner}` has shape {shapes[i][j]}. It needs as many rows as `{beside}` has and as many "
        f"columns as `{over}`: shape {fits}."
    )


def _not_transposed(
    stop: Stop, whole: ast.expr, rows: list[list[ast.expr]], shapes: list[list[tuple[int, int]]]
) -> str:
    """The one block among two by two that fits when it is transposed, and only then; "" if there is none."""
    if [len(row) for row in rows] != [2, 2]:
        return ""
    turned = []
    for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
        other = [
            [shape[::-1] if (k, m) == (i, j) else shape for m, shape in enumerate(row)] for k, row in enumerate(shapes)
        ]
        (a, b), (c, d) = other
        if (a[0], c[0], a[1], b[1]) == (b[0], d[0], c[1], d[1]):
            turned.append((i, j))
    if len(turned) != 1:
        return ""
    ((i, j),) = turned
    written = [[ast.unparse(part) for part in row] for row in rows]
    block = written[i][j]
    written[i][j] = block[:-2] if block.endswith(".T") else f"{block}.T"
    repair = f"[{', '.join(f'[{parts}]' for parts in map(', '.join, written))}]"
    proposed = proposal(stop, whole, repair, f"Is `{written[i][j]}` meant?")
    return f" All fit when `{block}` is transposed. {proposed}".rstrip()


def unfit_right_side(stop: Stop, _: re.Match[str]) -> str | None:
    """`solve` with a right-hand side of another length."""
    for node in stop.expressions():
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("solve") and len(node.args) == 2:
            left, right = (stop.shape(part) for part in node.args)
            if left and right and left[0] != right[0]:
                A, b = map(ast.unparse, node.args)
                fault = never_inverted(stop)
                said = (
                    f"`solve(A, b)` solves A x = b: A, here `{A}`, has {left[0]} rows, and b, here `{b}`, has "
                    f"{right[0]}."
                )
                if fault:
                    return f"{said} {fault}"
                inner = node.args[0]
                if isinstance(inner, ast.BinOp) and isinstance(inner.op, ast.MatMult):
                    first = stop.shape(inner.left)
                    repair = f"{ast.unparse(inner.left)} @ {b}"
                    if first and len(first) == 2 and first[1] == right[0] and mends(stop, node.args[1], repair):
                        also = f"The right-hand side of the normal equations is multiplied, too: `{repair}`."
                        solved = f"{ast.unparse(node.func)}({A}, {repair})"
                        said = f"{said} {proposal(stop, node, solved, also)}".rstrip()
                names = [
                    one.id for one in ast.walk(inner) if isinstance(one, ast.Name) and "@" in stop.made.get(one.id, "")
                ]
                return " ".join((said, *(f"`{name}` is made by `{stop.made[name]}`." for name in dict.fromkeys(names))))
    sizes = re.search(r"size (\d+) is different from (\d+)", stop.text)
    here = f" Here these are {sizes[1]} and {sizes[2]}." if sizes else ""
    return f"`solve(A, b)` needs as many entries in b as A has rows.{here}"


def unfit_rows(stop: Stop, _: re.Match[str]) -> str | None:
    """`lstsq` with another number of rows in A than in b."""
    for node in stop.expressions():
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("lstsq") and len(node.args) > 1:
            left, right = (stop.shape(part) for part in node.args[:2])
            A, b = map(ast.unparse, node.args[:2])
            listed = stop.things.get(A)
            if listed is not None and listed.kind == "list" and listed.lengths and right:
                return (
                    f"`lstsq(A, b)`: `{A}` is a list of {len(listed.lengths)} arrays, which are taken for rows, and "
                    f"`{b}` has {right[0]} entries. With a column for each of them it is `np.column_stack(...)`."
                )
            if left and right:
                is_near = 2 * min(left[0], right[0]) >= max(left[0], right[0])
                samples = " (of signals, both must cover the same samples)" if is_near else ""
                return (
                    f"`lstsq(A, b)`: `{A}` has {left[0]} rows and `{b}` has {right[0]} entries. Each row needs its own "
                    f"entry of b{samples}."
                )
    return "`lstsq(A, b)`: A and b must have the same number of rows."


_TAKE_MATRICES = ("solve", "lstsq", "inv", "pinv", "det", "eig", "eigvals", "eigh", "eigvalsh", "svd", "qr", "cholesky")


def flat_matrix(stop: Stop, _: re.Match[str]) -> str | None:
    """A flat array or a number in the place of a matrix; of `solve` and `lstsq`, the two may be swapped."""
    for node in stop.expressions():
        if isinstance(node, ast.Call) and node.args:
            first = stop.things.get(ast.unparse(node.args[0]))
            if first is not None and first.kind == "function" and "0-dimensional" in stop.text:
                written = ast.unparse(node.args[0])
                return f"`{written}` is a function, and a matrix is asked for: it is called, `{written}(...)`."
            shapes = [stop.shape(part) for part in node.args[:2]]
            if called(node) == "append" and len(node.args) == 2:
                return (
                    f"`{ast.unparse(node)}` is flat: without a third argument, the axis, `np.append` takes all apart."
                )
            if shapes[0] is None or len(shapes[0]) != 1 or called(node) not in _TAKE_MATRICES:
                continue
            A = ast.unparse(node.args[0])
            said = f"`{A}` is flat, shape {shapes[0]}, and stands where `{ast.unparse(node.func)}` takes a matrix."
            second = shapes[1] if len(shapes) == 2 else None
            is_swapped = second is not None and len(second) == 2 and second[0] == shapes[0][0]
            solver = ast.unparse(node.func).rpartition(".")[2]
            return f"{said} `{solver}(A, b)` takes the matrix first: the two are swapped." if is_swapped else said
    if "0-dimensional" in stop.text:
        return "One number stands where a matrix belongs. The inverse of a number x is `1 / x`."
    return "A flat array stands where a matrix belongs: print the shapes of the parts."


_MATRICES = ("A", "B", "C", "D")


def _turned(parts: dict[str, ast.expr]) -> str:
    """Which of B and C, written as lists of rows, is turned; empty if none is."""
    B, C = parts.get("B"), parts.get("C")
    if isinstance(B, ast.List) and len(B.elts) == 1 and isinstance(B.elts[0], ast.List) and len(B.elts[0].elts) > 1:
        column = ", ".join(f"[{ast.unparse(one)}]" for one in B.elts[0].elts)
        return f"B, here `{ast.unparse(B)}`, is one row. With one input it is a column, n by 1: `[{column}]`."
    if (
        isinstance(C, ast.List)
        and len(C.elts) > 1
        and all(isinstance(r, ast.List) and len(r.elts) == 1 for r in C.elts)
    ):
        row = ", ".join(ast.unparse(one.elts[0]) for one in C.elts if isinstance(one, ast.List))
        return f"C, here `{ast.unparse(C)}`, is one column. With one output it is a row, 1 by n: `[[{row}]]`."
    return ""


def flat_state_space(stop: Stop, found: re.Match[str]) -> str | None:
    """A list of numbers in the place of a matrix of a state space, or a row in the place of a column."""
    for node in stop.expressions():
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("ss"):
            for name, part in zip(_MATRICES, node.args, strict=False):
                if isinstance(part, ast.List) and not any(isinstance(row, ast.List | ast.Tuple) for row in part.elts):
                    return (
                        f"{name}, here `{ast.unparse(part)}`, is a flat list. A matrix is a list of its rows, each of "
                        "them a list: `[[0, 1], [2, 3]]`, and a column `[[0], [1]]`."
                    )
            turned = _turned(dict(zip(_MATRICES, node.args, strict=False)))
            if turned:
                return turned
    return "In `ct.ss(A, B, C, D, Ts)`, A is n by n, B n by 1, C 1 by n and D 1 by 1, each as a list of its rows."
