"""Causes of Python's errors in products, inverses and systems of equations, by the shapes of the matrices."""

import ast
import re
from collections.abc import Iterator

from labsid.checks.line_values import parsed_line, shape_of
from labsid.checks.repairs import beside, mends
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


def _products(stop: Stop) -> Iterator[tuple[ast.expr, ast.expr]]:
    """The factors of the products of matrices in a line, by `@`, `np.dot` or `np.matmul`, outermost first."""
    for node in stop.expressions():
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult):
            yield node.left, node.right
        elif (
            isinstance(node, ast.Call)
            and len(node.args) == 2
            and ast.unparse(node.func).rpartition(".")[2] in ("dot", "matmul")
        ):
            yield node.args[0], node.args[1]


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
                return (
                    f"`@` is the product of arrays, and `{ast.unparse(side)}` is one number: a multiple is made by `*`."
                )
    return "`@` is the product of arrays; one of the two is a number. A multiple is made by `*`."


def unfit_product(stop: Stop, _: re.Match[str]) -> str | None:
    """`@` between shapes that do not fit."""
    for first, second in _products(stop):
        one, other = stop.shape(first), stop.shape(second)
        if not one or not other or one[-1] == other[0]:
            continue
        left, right = ast.unparse(first), ast.unparse(second)
        empty = next((text for text, shape in ((left, one), (right, other)) if 0 in shape), "")
        if ":-" in empty.replace(" ", ""):
            return f"`{empty}` is empty: `[:-0]` takes nothing. `[: len(x) - k]` is right for k = 0, too."
        said = (
            f"In `{left} @ {right}` the first has {one[-1]} columns and the second {other[0]} rows: "
            f"these must be equal."
        )
        parts = (*ast.walk(first), *ast.walk(second))
        flat = [part for part in parts if isinstance(part, ast.Name) and len(stop.shape(part) or ()) == 1]
        product = ast.BinOp(first, ast.MatMult(), second)
        if len(other) == 2 and other[0] == 1 and other[1] == one[-1] and mends(stop, second, f"{right}.ravel()"):
            return f"{said} `{right}` has shape {other}, a table of one row; `{right}.ravel()` is flat."
        weight = next((part.id for part in flat if one[0] != other[0] and re.search(rf"@ {part.id} @", stop.line)), "")
        if weight and mends(stop, ast.Name(weight), f"np.diag({weight})"):
            return f"`{weight}` is flat. A matrix with these numbers on its diagonal is `np.diag({weight})`."
        inverse = re.search(r"inv\((\w+)\.T @ \1\)$", left)
        if inverse is not None and one[0] < other[0]:
            name = inverse[1]
            if right.endswith(".T"):
                turned = f"{left} @ {name}.T @ {right[:-2]}"
                is_mended = mends(stop, product, turned)
                return f"{said} Is `{turned}` meant, with `{name}` transposed instead?" if is_mended else said
            if not mends(stop, product, f"{left} @ {name}.T" + (f" @ {right}" if right != name else "")):
                return said
            before = f"`{name}.T` in place of `{name}`" if right == name else f"`{name}.T @` before `{right}`"
            return f"{said} Is {before} meant?"
        if "inv(" in left:
            return " ".join(filter(None, (said, _without_inverse(stop))))
        if one[0] == other[0] and re.fullmatch(r"(-?[\w.]+ \* )?\w+(\.T)?", left):
            turned = left[:-2] if left.endswith(".T") else f"{left}.T"
            repairs = [f"{turned} @ {right}"]
            if len(one) == len(other) == 2 and other[1] == one[0]:
                repairs.append(f"{right} @ {left}")
            mended = [f"`{repair}`" for repair in repairs if mends(stop, product, repair)]
            if len(mended) > 1:
                return f"{said} {mended[0]} and {mended[1]} would fit."
            return f"{said} Is {mended[0]} meant?" if mended else f"{said}{_owed(stop, product)}"
        is_swapped = len(one) == 1 and len(other) == 2 and other[1] == one[0]
        if is_swapped and mends(stop, product, f"{right} @ {left}"):
            return f"{said} Is `{right} @ {left}` meant?"
        made = [name for name in (left, right) if name in stop.made and not stop.made[name].startswith("for ")]
        return " ".join((said, *(f"`{name}` is made by `{stop.made[name]}`." for name in made)))
    return "In `A @ B` the columns of A must be as many as the rows of B."


def _owed(stop: Stop, product: ast.expr) -> str:
    """The shape that a product must have beside another term; empty where it stands alone."""
    other = beside(stop, product)
    return "" if other is None else f" Beside `{other[0]}`, of shape {other[1]}, the product must have that shape, too."


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
        return f"{said}{_not_transposed(rows, known) or _empty_corner(rows, known)}"
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


def _not_transposed(rows: list[list[ast.expr]], shapes: list[list[tuple[int, int]]]) -> str:
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
            turned.append(ast.unparse(rows[i][j]))
    if len(turned) != 1:
        return ""
    block = turned[0]
    return f" All fit when `{block}` is transposed: is `{block[:-2] if block.endswith('.T') else f'{block}.T'}` meant?"


def unfit_right_side(stop: Stop, _: re.Match[str]) -> str | None:
    """`solve` with a right-hand side of another length."""
    for node in stop.expressions():
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("solve") and len(node.args) == 2:
            left, right = (stop.shape(part) for part in node.args)
            if left and right and left[0] != right[0]:
                A, b = map(ast.unparse, node.args)
                said = (
                    f"`solve(A, b)` solves A x = b: A, here `{A}`, has {left[0]} rows, and b, here `{b}`, has "
                    f"{right[0]}."
                )
                inner = node.args[0]
                if isinstance(inner, ast.BinOp) and isinstance(inner.op, ast.MatMult):
                    first = stop.shape(inner.left)
                    repair = f"{ast.unparse(inner.left)} @ {b}"
                    if first and len(first) == 2 and first[1] == right[0] and mends(stop, node.args[1], repair):
                        said += (
                            f" The right-hand side of the normal equations is multiplied, too: "
                            f"`{ast.unparse(inner.left)} @ {b}`."
                        )
                return said
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


def flat_matrix(stop: Stop, _: re.Match[str]) -> str | None:
    """A flat array or a number in the place of a matrix; of `solve` and `lstsq`, the two may be swapped."""
    for node in stop.expressions():
        if isinstance(node, ast.Call) and node.args:
            first = stop.things.get(ast.unparse(node.args[0]))
            if first is not None and first.kind == "function" and "0-dimensional" in stop.text:
                written = ast.unparse(node.args[0])
                return f"`{written}` is a function, and a matrix is asked for: it is called, `{written}(...)`."
            shapes = [stop.shape(part) for part in node.args[:2]]
            if shapes[0] is None or len(shapes[0]) != 1:
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


def _without_inverse(stop: Stop) -> str:
    """A product in the line that cannot have an inverse, by its shapes; empty if there is none."""
    for first, second in _products(stop):
        one, other = stop.shape(first), stop.shape(second)
        if one and other and len(one) == len(other) == 2 and one[0] == other[1] > one[1]:
            left, right = ast.unparse(first), ast.unparse(second)
            return (
                f"The product of `{left}` and `{right}` is {one[0]} by {one[0]}, but of rank {one[1]} at most: "
                "it never has an inverse. "
                f"`{right} @ {left}` is {one[1]} by {one[1]}."
            )
    return ""


def product_without_inverse(stop: Stop, _: re.Match[str]) -> str | None:
    """A product that is singular by its shapes, a single zero, or dependent columns."""
    for node in stop.expressions():
        if isinstance(node, ast.Call) and node.args and ast.unparse(node.func).endswith(("inv", "solve")):
            shapes = {stop.shape(part) for part in ast.walk(node.args[0]) if isinstance(part, ast.expr)} - {None}
            if (1, 1) in shapes and shapes <= {(1, 1), (1,)}:
                return f"`{ast.unparse(node.args[0])}` is a single number, and it is zero: print what it is made of."
    if not _without_inverse(stop) and ".jac" in stop.line:
        return (
            "Where the search ended, the output does not depend on each of the parameters. That is so when the model "
            "does not use one of them, when it lacks one, so that no value of the others fits, and when the "
            "search begins far from the data: print where it ended."
        )
    return _without_inverse(stop) or (
        "The matrix has no inverse: its columns are dependent, as they are when a column of Phi is zero or a multiple "
        "of others, or when Phi has fewer rows than columns. Print `np.linalg.matrix_rank(...)` of each factor."
    )


def not_square(stop: Stop, _: re.Match[str]) -> str | None:
    """The inverse, or the determinant, of a tall matrix."""
    for node in stop.expressions():
        if isinstance(node, ast.Call) and node.args and ast.unparse(node.func).endswith(("inv", "solve", "det")):
            shape, name = stop.shape(node.args[0]), ast.unparse(node.args[0])
            if shape and len(shape) == 2 and shape[0] != shape[1]:
                said = f"`{name}` is {shape[0]} by {shape[1]}; only a square matrix has "
                if ast.unparse(node.func).endswith("det"):
                    return (
                        f"{said}a determinant. How many columns of any matrix are independent, its rank says: "
                        f"`np.linalg.matrix_rank({name})`."
                    )
                tall = (
                    f" (Least squares inverts `{name}.T @ {name}`, or takes `np.linalg.lstsq({name}, ...)[0]`.)"
                    if shape[0] > shape[1]
                    else ""
                )
                return f"{said}an inverse.{tall}"
    return "Only a square matrix has an inverse: in least squares Phi'Phi is square, and Phi is not."
