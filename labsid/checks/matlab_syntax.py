"""Lines that Python cannot read, and names that it does not know: above all what is right in MATLAB."""

import ast
import re
from collections.abc import Callable
from dataclasses import dataclass

from labsid.checks.asked_texts import (
    column_without_quotes,
    columns_without_quotes,
    key_without_quotes,
    text_without_quotes,
)
from labsid.checks.module_names import in_place_of_math, module_of
from labsid.checks.repairs import proposal
from labsid.checks.stops import Stop


@dataclass(frozen=True, slots=True)
class Spelling:
    """What stands in a line, and what Python writes for it."""

    pattern: str
    python: str


_MOST_SPELLINGS = 2
_TEXTS = re.compile(r"(?<![\w\])])[frbFRB]{0,2}(\"[^\"]*\"|'[^']*')|#.*")
_HEADS = "if|elif|else|while|for|def|with|try|except|finally|class"
_WORDS = (
    "and|as|assert|class|def|del|elif|else|end|except|for|from|function|global|if|import|in|is|lambda|nonlocal|not|or|"
    "print|raise|return|try|while|with|yield"
)
"""Words beside which a name may stand without an operator; `print` has a message of its own."""
_RANGE = (
    "`{0}` is MATLAB's range. In numpy it is `np.arange(start, stop, step)`, which leaves out the stop, or "
    "`np.linspace(first, last, number)`, which has both ends. Both are flat arrays"
)
_COLUMN = ": where a column vector is asked for, add `.reshape(-1, 1)`."
_TURNED = ", and the transpose of a flat array is the same array: `.reshape(-1, 1)` makes a column vector."
_TURNED_RANGE = re.compile(r"[)\]]\s*(?:'|\.T\b)[\s;]*$")
_QUOTES = 'A text stands in quotes: `"{}"`.'
_BRACKETS = (
    "`{0}` has round brackets: entries are taken with square ones and counted from 0, so "
    "MATLAB's `A(:, 2)` is `A[:, 1]`, "
    "`A(1:9)` is `A[0:9]` and `A(1)` is `A[0]`."
)
SPELLINGS: tuple[Spelling, ...] = (
    Spelling(r"\blambda\b(?=\s*(?:[-+*/,)=\]]|$))", "`lambda` is a word of Python's own: call the variable `lam`."),
    Spelling(r"\w+\s*(?:\+\+|--)\s*;?\s*$", "`{0}` is no Python: a variable is counted up by `n += 1`."),
    Spelling(
        r"\b(?:arange|linspace|range)\(\s*[^(),]*:[^(),]*\)",
        "`{0}`: between the arguments of a function stand commas, `np.arange(start, stop, step)`. A range `a:b` stands "
        "in square brackets only.",
    ),
    Spelling(
        r"\w+\([^():\[\]{}]*,\s*(?P<shown>[\w.]*:[\w.]*)\s*[,)]",
        "`{0}`: a range `a:b` stands in square brackets only, after an array. Handed over to a function, it is "
        "`slice(a, b)`, or `np.arange(a, b)` for the numbers themselves.",
    ),
    Spelling(
        r"\w+\([^()]*\bend\b[^()]*\)",
        ("`{0}`: Python has no `end`. An open slice goes to the end, `y[half:]`; the last entry is `y[-1]`."),
    ),
    Spelling(
        r"\w+\[[^\[\]]*\bend\b[^\[\]]*\]",
        ("`{0}`: Python has no `end`. An open slice goes to the end, `y[half:]`; the last entry is `y[-1]`."),
    ),
    Spelling(
        r"\w+\(\s*[A-Za-z_]\w*\s*,\s*:\s*\)",
        "`{0}` has round brackets: entries are taken with square ones, and a whole row is `A[k, :]`, with rows counted "
        "from 0.",
    ),
    Spelling(
        r"\w+\(\s*:\s*,\s*[A-Za-z_]\w*\s*\)",
        "`{0}` has round brackets: entries are taken with square ones, and a whole column is `A[:, k]`, with columns "
        "counted from 0.",
    ),
    Spelling(
        r"[\w\]]+\((?!\s*(?:[A-Za-z_]\w*\s*,\s*:|:\s*,\s*[A-Za-z_]\w*)\s*\))\s*(?:\d*\s*:|[^()]*[,\s]:)[^()]*\)",
        _BRACKETS,
    ),
    Spelling(
        r"^\s*for\s+\w+\s*=\s*.*",
        ("`{0}` is MATLAB's loop. Python's is `for k in range(first, stop):`, which leaves out the stop."),
    ),
    Spelling(
        r"^\s*function\b.*",
        ("`{0}` is MATLAB's function. Python's is `def name(arguments):`, with `return` and the result at the end."),
    ),
    Spelling(
        r"=\s*(?P<shown>(?:\"\"|[A-Za-z_]\w*)\s*:\s+[-\d.]+)\s*$",
        'In a dictionary, `{0}` stands in braces, and a key that is a text in quotes: `{{"key": 1.2}}`.',
    ),
    Spelling(
        r"\{\s*(?:\"\"|\w+)\s*=(?!=)[^}]*\}",
        "`{0}`: in a dictionary a colon stands between key and value, and a key that is a text in quotes: "
        '`{{"key": 1.2}}`.',
    ),
    Spelling(
        rf"^(?!\s*(?:{_HEADS})\b)(?!.*(?:\{{|\blambda\b)).*?"
        r"(?<![\w\])[])(?<!\[ )(?P<shown>[-\w.]+\s*:\s*[-\w.*/]+(?:\s*:\s*[-\w.]+)?)(?=\s*\)?(?:'|\.T)?\s*;?$)",
        _RANGE,
    ),
    Spelling(r"=\s*\[\s*(?P<shown>[-\w.]+\s*:\s*[-\w.*/]+(?:\s*:\s*[-\w.]+)?)\s*\]", _RANGE),
    Spelling(
        r"(?<![\w\])])\(\s*(?P<shown>(?!lambda\b)[-\w.]+\s*:\s*(?!=)[-\w.*/]+(?:\s*:\s*[-\w.]+)?)\s*\)(?!')",
        _RANGE,
    ),
    Spelling(
        r"[\w\])]+\s*\\\s*\w+",
        (
            "`{0}`: Python has no `\\`. A square system is `np.linalg.solve(A, b)`, least squares "
            "`np.linalg.lstsq(A, b)[0]`."
        ),
    ),
    Spelling(r"\"\"\w", "A text in quotes ends at the next such quote: put one with an apostrophe in double quotes."),
    Spelling(
        r"^(?!.*\"\"\w).*?(?P<shown>[\w\])]+'(?!\w*'))",
        "`{0}`: an apostrophe begins a text. The transpose is `.T`, as in `Phi.T`.",
    ),
    Spelling(
        rf"^(?=.*(?:=|\breturn\b)).*?(?<![\w.])(?P<shown>(?!(?:{_WORDS})\b)[A-Za-z_]\w* (?!(?:{_WORDS})\b)[A-Za-z_]\w*)"
        r"(?=\s*(?:[-+*/(,)]|$))",
        "`{0}`: two names stand side by side. A product needs its `*`.",
    ),
    Spelling(r"~=", '`{0}` is MATLAB\'s "not equal": write `!=`.'),
    Spelling(r"&&|\|\|", "`{0}` is MATLAB's: write `and`, `or`."),
    Spelling(
        r"(?:\b[A-Za-z_]\w*|[\])])\s*\.[*/^]|\d\.\^",
        ("`{0}` is MATLAB's: in Python `*`, `/` and `**` work entry by entry, and `@` multiplies matrices."),
    ),
    Spelling(r"^\s*%.*", "`{0}`: a comment begins with `#`."),
    Spelling(
        r"\[\s*[\w.]+(?:\s+(?!(?:for|in|if|else|and|or|not|is)\b)[\w.]+)+\s*\]",
        "`{0}`: the items of a list are separated by commas.",
    ),
    Spelling(
        r"\b\d+(?:\.\d+)?(?!e[-+]?\d|[jJ]\b)[A-Za-z_]\w*",
        "`{0}`: a product needs its `*`, and a name begins with a letter.",
    ),
)
"""Tried in order on a line that Python cannot read; `{0}` is what was found."""

_MESSAGES: tuple[Spelling, ...] = (
    Spelling(
        r"Missing parentheses in call to 'print'",
        "`print` is a function: `print(...)`. (A result is handed back by `return`.)",
    ),
    Spelling(
        r"expected 'else'",
        "`a if condition else b` needs both parts. The entries for which a condition holds are `t[condition]`.",
    ),
    Spelling(r"was never closed|incomplete input", "Count the brackets: one that opens is not closed."),
    Spelling(r"unmatched|does not match", "Count the brackets: one closes that was not opened, or of another kind."),
    Spelling(r"expected ':'", "The line of `if`, `for`, `while` or `def` ends with a colon."),
    Spelling(
        r"expected an indented block", "What belongs to `if`, `for`, `while` or `def` is indented by four spaces."
    ),
    Spelling(
        r"unindent|unexpected indent|inconsistent use of tabs", "All lines of one block begin at the same column."
    ),
    Spelling(r"Maybe you meant '=='", "`=` assigns; `==` compares."),
    Spelling(r"cannot assign to", "On the left of `=` stands the name that gets the value."),
    Spelling(r"'return' outside function", "`return` stands indented, inside a function."),
    Spelling(
        r"unterminated string",
        "A text that is begun is not ended on its line: look at the quotes. (MATLAB's transpose, an apostrophe, is "
        "`.T`.)",
    ),
    Spelling(r"forgot a comma", "Between two items a comma is missing, or between two factors a `*`."),
    Spelling(
        r"",
        "Python's mark `^` points at what it cannot read there. (A bracket that is not closed in a line before shows "
        "here, too.)",
    ),
)

_SET_AFTER_RETURN = (
    "After `return` stands what is handed back: `==` compares two values. (`=` gives a name its value, in a line of "
    "its own before.)"
)
_MARKED = "Python's mark `^` points at what it cannot read there."

_NUMPY = re.compile(
    "sin|cos|tan|exp|log|sqrt|pi|zeros|ones|eye|linspace|arange|array|mean|std|var|abs|sum|cumsum|diff|roots|polyval|dot|"
    "outer|column_stack|hstack|vstack|concatenate|shape|reshape|floor|ceil|sign|conv|convolve"
)
_LINEAR = re.compile("inv|solve|lstsq|det|eig|eigvals|pinv|norm|svd")
MATLAB = {
    "true": "`True`",
    "false": "`False`",
    "length": "`len(x)`",
    "numel": "`x.size`",
    "size": "`A.shape`; `size(A, 1)` is `A.shape[0]`, the number of rows, and `size(A, 2)` is `A.shape[1]`",
    "disp": "`print(x)`",
    "rand": "`rng.random((rows, columns))`, from 0 to 1; between other bounds `rng.uniform(low, high, shape)`",
    "randn": "`rng.standard_normal((rows, columns))`",
    "ln": "`np.log(x)`, the natural logarithm (`np.log10` is the one of base 10)",
    "tf": "`ct.tf`",
    "ss": "`ct.ss`",
    "lsim": "`ct.forced_response(sys, inputs=u).outputs`",
    "filter": "`scipy.signal.lfilter`",
    "rank": "`np.linalg.matrix_rank(A)`",
    "tinv": "`scipy.stats.t.ppf(p, degrees_of_freedom)`",
    "norminv": "`scipy.stats.norm.ppf(p)`",
    "plot": "`ax.plot(x, y)`",
    "figure": "`plt.subplots()`",
    "subplot": "`plt.subplots(2, 1)`",
    "stairs": '`ax.step(t, u, where="post")`',
    "end": '`y[half:]` for "to the end", `y[-1]` for the last entry; Python has no `end`',
    "step": "`ct.step_response(sys)`",
    "impulse": "`ct.impulse_response(sys)`",
    "find": "`np.flatnonzero(condition)`",
    "e": "`np.exp(x)` for a power of e",
    "control": "`ct`, the name under which the first cell imports it",
    "numpy": "`np`, the name under which the first cell imports it",
    "pyplot": "`plt`, the name under which the first cell imports it",
    "null": "`None`, and of a matrix `scipy.linalg.null_space(A)`",
    "nan": "`np.nan`",
    "inf": "`np.inf`",
}


_NO_FUNCTIONS = ("true", "false", "end", "control", "numpy", "pyplot", "null", "nan", "inf")


def cause_of_syntax(stop: Stop) -> str:
    """Why Python cannot read a line."""
    code = _TEXTS.sub(lambda text: '""' if text[1] else "", stop.line)
    code = re.split(r"(?<![\w\])'\"])'|(?<!\")\"(?!\")", code)[0]  # a text that is not ended is no code
    text = text_without_quotes(stop.line)
    if text:
        return _QUOTES.format(text)
    matches = ((one, re.search(one.pattern, code)) for one in SPELLINGS)
    said = [
        one.python.format((found.groupdict().get("shown") or found[0]).strip())
        for one, found in matches
        if found is not None
    ]
    if said and "between the arguments" in said[0]:
        return said[0]
    if said and _is_range(said[0]):
        return said[0] + (_TURNED if _TURNED_RANGE.search(code) else _COLUMN)
    said = [one for one in said if not _is_range(one)]
    columns = columns_without_quotes(stop)
    if columns or _is_set_after_return(code):
        return columns or _SET_AFTER_RETURN
    if said:
        return " ".join(said[:_MOST_SPELLINGS])
    told = next(one.python for one in _MESSAGES if re.search(one.pattern, stop.text))
    return told if stop.number != 1 or told != _MESSAGES[-1].python else _MARKED


def _is_set_after_return(code: str) -> bool:
    """Whether a `=` stands after `return`, outside brackets."""
    inside = re.compile(r"\([^()]*\)|\[[^\[\]]*\]|\{[^{}]*\}")
    while inside.search(code):
        code = inside.sub("_", code)
    return re.match(r"\s*(?:return|.*:\s*return)\b[^=]*(?:[=<>!]=[^=]*)*(?<![=<>!])=(?!=)", code) is not None


def _is_range(said: str) -> bool:
    return said.endswith(_RANGE.rpartition("`")[2])


def _near_name(name: str, stop: Stop) -> str:
    """The variable that is spelt nearly like an unknown name, and whether it is meant, where that was tried."""
    proposed = proposal(stop, ast.Name(name), stop.near)
    alike = f"with `{name}` as a part of its name" if name in stop.near.split("_") else "which is spelt nearly alike"
    return f"There is `{stop.near}`, {alike}. {proposed}".rstrip()


def cause_of_unknown_name(name: str, stop: Stop, made_by: Callable[[str], str] | None) -> str:
    """Why a name is not defined: it is MATLAB's or numpy's, misspelt, or its cell has not been run."""
    where = "" if made_by is None else made_by(name)
    text = text_without_quotes(stop.line, name)
    known = (
        _QUOTES.format(text) if text else where or key_without_quotes(name, stop) or column_without_quotes(name, stop)
    )
    if known:
        return known
    if stop.near and stop.near.lower() == name.lower():
        return f"There is `{stop.near}`: capital and small letters differ."
    is_called = re.search(rf"\b{name}\s*\(", stop.line) is not None
    if _NUMPY.fullmatch(name) and (is_called or name == "pi"):
        return f"It is a part of numpy: `np.{name}`."
    if _LINEAR.fullmatch(name) and is_called:
        return f"It is in numpy's part for linear algebra: `np.linalg.{name}`."
    is_power = name == "e" and re.search(r"\be\s*(?:\*\*|\^)", stop.line) is not None
    if name == "math":
        return in_place_of_math(stop.line)
    if name in MATLAB and (is_called or is_power or name in _NO_FUNCTIONS):
        return f"In Python: {MATLAB[name]}."
    if name == "z" and re.search(r"/.*\bz\b", stop.line):
        power = " (And a power is `**`, not `^`.)" if re.search(r"\bz\s*\^", stop.line) else ""
        return (
            "In Python `z` is no variable of its own: a transfer function is made of its coefficients, the highest "
            f"power first, `ct.tf(numerator, denominator, Ts)` with two lists.{power}"
        )
    module = module_of(name, stop.line, is_called)
    if module:
        return module
    if re.match(rf"{name}\s*==", stop.line):
        return f"`==` compares; `{name}` gets its value by `=`."
    if re.match(rf"{name}\s*=(?!=).*\b{name}\b", stop.line):
        return f"`{name}` stands on the right of `=`, too, and has no value there yet: name what it is made of."
    if stop.near:
        return _near_name(name, stop)
    if stop.arguments:
        arguments = ", ".join(f"`{one}`" for one in stop.arguments)
        return (
            f"It is no argument of the function, which has {arguments}, and neither a line before this one nor a cell "
            "that has been run makes it. (Spelt alike in both places?)"
        )
    return (
        "No cell that has been run defines it: run the cells above in their order, or define it. "
        "(Spelt alike in both places?)"
    )
