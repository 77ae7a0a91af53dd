"""Checks of definiteness, the matrix of Example 2-3, and derivatives with respect to a vector."""

from collections.abc import Callable, Iterator
from functools import partial
from operator import ge, gt

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray
from labsid.checks.answer_code import code_of
from labsid.checks.asked_texts import KINDS
from labsid.checks.compare import as_array, as_matrix, as_vector, close, kind_of
from labsid.checks.double_mistakes import with_factors
from labsid.checks.question import Ask, returned
from labsid.checks.verdict import NoAnswer, Slip, Verdict, are_named, first_failure, judge
from labsid.least_squares.gradients import gradient_quadratic, jacobian_cubic
from labsid.least_squares.quadratic_form import definiteness
from labsid.model_structures.structures import Structure, build_equations

_EXACT = close(1e-9)


def check_kind(ask: Ask) -> Verdict:
    """`kind(M)`, on symmetric and unsymmetric matrices of every kind."""
    trials = trial_forms(ask.rng)
    answers, truth = [_kind(ask, M) for M, _ in trials], [kind for _, kind in trials]
    if answers == truth:
        told = _of_other_sizes(ask)
        praise = "it distinguishes bowl, trough, hill and saddle, for symmetric and unsymmetric matrices."
        return told or Verdict(True, praise)
    for slip, hint, rule in _WRONG_RULES:
        if answers == [rule(M) for M, _ in trials]:
            return Verdict(False, f"`kind` {hint}", slip)
    wrong = [i for i, (answer, right) in enumerate(zip(answers, truth, strict=True)) if answer != right]
    exact = [i for i in wrong if np.count_nonzero(trials[i][0] - np.diag(np.diag(trials[i][0]))) == 0]
    missed = sorted({truth[i] for i in wrong})
    if all("semi" in kind for kind in missed) and exact:
        return Verdict(
            False,
            f"`kind` does not recognise a {' or a '.join(missed)} matrix, not even a diagonal one with an exact zero, "
            f"{truth[exact[0]]}, which it calls {answers[exact[0]]}. {_never_returned(answers, missed)}".rstrip(),
            "branch missing",
        )
    if all("semi" in kind for kind in missed):
        return Verdict(
            False,
            "`kind` misses a semidefinite matrix: by rounding, a zero eigenvalue is computed as about 1e-16, of "
            "either sign. Compare with a small tolerance, not with 0.",
            "zero compared exactly",
        )
    if all(answers[i] == truth[i].replace(" ", " semi") for i in wrong):
        return Verdict(
            False,
            f"`kind` calls {len(wrong)} matrices semidefinite that are definite. Where all eigenvalues are > 0 they "
            "are "
            "also >= 0: it is semidefinite only where it is not definite.",
            "semidefinite asked first",
        )
    M = trials[wrong[0]][0]
    is_symmetric = "a symmetric" if np.array_equal(M, M.T) else "an unsymmetric"
    return Verdict(
        False,
        f"`kind` calls {is_symmetric} {len(M)} by {len(M)} matrix {answers[wrong[0]]} that is "
        f"{truth[wrong[0]]}, and is wrong "
        f"for {len(wrong)} of {len(trials)} matrices. Which signs has x'Mx for the matrices of this kind?",
    )


_SMALL_EIGENVALUE = 5e-4  # beside 1: small, and far from the 1e-10 of the largest that the text takes for zero
_SMALL_UNIT = 1e-4  # of the entries of M, as another unit of x gives


def _of_other_sizes(ask: Ask) -> Verdict | None:
    """The verdict on small matrices, and on small eigenvalues beside large ones; None if all are told apart."""
    for eigenvalues, scale, kind in (
        ((1.0, 0.3), _SMALL_UNIT, "positive definite"),
        ((-1.0, -0.3), _SMALL_UNIT, "negative definite"),
        ((1.0, -0.3), _SMALL_UNIT, "indefinite"),
        ((1.0, -_SMALL_EIGENVALUE), 1.0, "indefinite"),
        ((1.0, _SMALL_EIGENVALUE), 1.0, "positive definite"),
        ((-1.0, -_SMALL_EIGENVALUE), 1.0, "negative definite"),
    ):
        angle = ask.rng.uniform(0.3, 1.2)
        Q = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        lam = scale * np.array(eigenvalues)
        answer = _kind(ask, Q @ np.diag(lam) @ Q.T)
        if answer != kind:
            return Verdict(
                False,
                f"`kind` calls a matrix {answer} whose eigenvalues are {lam[0]:g} and {lam[1]:g}. How small is zero? "
                "Compare with the largest magnitude of the eigenvalues: below 1e-10 of that, say, it is rounding.",
                "tolerance too large",
            )
    return None


def _never_returned(answers: list[str], missed: list[str]) -> str:
    """Which of the missed texts is returned for no matrix at all; empty if each is for some."""
    never = [f"`{text}`" for text in missed if text not in answers]
    return f"Of all {len(answers)} matrices tried it returns {' or '.join(never)} for none." if never else ""


def trial_forms(rng: np.random.Generator) -> list[tuple[FloatArray, str]]:
    """Matrices and the kind of their quadratic form, known by construction; in random order, and some twice."""

    def rotated(*eigenvalues: float) -> FloatArray:
        n = len(eigenvalues)
        Q = np.linalg.qr(rng.standard_normal((n, n)))[0]
        M = Q @ np.diag(eigenvalues) @ Q.T
        return (M + M.T) / 2

    def skew(n: int) -> FloatArray:
        K = rng.uniform(1, 3, (n, n))
        return K - K.T

    a, b, c = rng.uniform(0.5, 3, 3)
    far = rng.uniform(3, 6)
    trials = [
        (np.array([[a]]), "positive definite"),
        (np.array([[-b]]), "negative definite"),
        (rotated(a, -b, c, -far), "indefinite"),
        (rotated(a, b), "positive definite"),
        (rotated(a, b, c), "positive definite"),
        (rotated(-a, -b), "negative definite"),
        (rotated(a, -b), "indefinite"),
        (rotated(a, -b, -c), "indefinite"),
        (np.array([[a, far], [far, a / 2]]), "indefinite"),
        (np.array([[1.0, far], [0.0, 1.0]]), "indefinite"),
        (np.array([[1.0, 0.0], [far, 1.0]]), "indefinite"),
        (rotated(a, b, c) + skew(3), "positive definite"),
        (rotated(-a, -b) + skew(2), "negative definite"),
        (np.diag([a, 0.0]), "positive semidefinite"),
        (np.diag([0.0, -a, -b]), "negative semidefinite"),
        *((rotated(a + i, b + i, 0.0), "positive semidefinite") for i in range(4)),
        (rotated(-a, 0.0, -c) + skew(3), "negative semidefinite"),
    ]
    order = rng.permutation([*range(len(trials)), *rng.integers(0, len(trials), 3)])
    return [trials[i] for i in order]


def _without_semidefinite(M: FloatArray) -> str:
    return kind_of_form(M).replace("semi", "")


def kind_of_form(M: FloatArray) -> str:
    """The kind of a quadratic form, with a tolerance for eigenvalues that should be zero."""
    eigenvalues = definiteness(M).eigenvalues
    return definiteness(np.diag(np.where(np.abs(eigenvalues) < 1e-9, 0, eigenvalues))).kind


def _of_determinant(of_symmetric: bool, zero: float, below: str) -> Callable[[FloatArray], str]:
    """The rule by the determinant alone, whose zero is a trough; `below` is what it calls a negative one."""

    def answer(M: FloatArray) -> str:
        determinant = np.linalg.det(M + M.T if of_symmetric else M)
        if abs(determinant) <= zero:
            return "positive semidefinite"
        return "positive definite" if determinant > 0 else below

    return answer


_OPPOSITE = {"positive": "negative", "negative": "positive"}


def _opposite(M: FloatArray) -> str:
    first, *rest = kind_of_form(M).split()
    return " ".join([_OPPOSITE.get(first, first), *rest])


def _rounded(rule: Callable[[FloatArray], ArrayLike]) -> Callable[[FloatArray], str]:
    def answer(M: FloatArray) -> str:
        numbers = np.atleast_1d(np.asarray(rule(M), float))
        return definiteness(np.diag(np.where(np.abs(numbers) < 1e-6, 0, numbers))).kind

    return answer


def _exact(rule: Callable[[FloatArray], ArrayLike]) -> Callable[[FloatArray], str]:
    def answer(M: FloatArray) -> str:
        numbers = np.atleast_1d(np.asarray(rule(M), float))
        if np.all(numbers > 0) or np.all(numbers < 0):
            return "positive definite" if numbers[0] > 0 else "negative definite"
        if np.all(numbers >= 0) or np.all(numbers <= 0):
            return "positive semidefinite" if np.all(numbers >= 0) else "negative semidefinite"
        return "indefinite"

    return answer


def _of_determinant_and(
    of_sign: Callable[[FloatArray], float], of_symmetric: bool, tolerance: float, corner: Callable[[float, float], bool]
) -> Callable[[FloatArray], str]:
    """The rule for two by two, by the determinant and the first entry or the trace, for every size."""

    def answer(M: FloatArray) -> str:
        determinant = np.linalg.det((M + M.T) / 2 if of_symmetric else M)
        sign = "positive" if corner(float(of_sign(M)), 0.0) else "negative"
        if abs(determinant) <= tolerance:
            return f"{sign} semidefinite"
        return f"{sign} definite" if determinant > 0 else "indefinite"

    return answer


def _first_entry(M: FloatArray) -> float:
    return float(M[0, 0])


def _of_minors(zero: float, alternating: bool) -> Callable[[FloatArray], str]:
    """The rule by the leading minors, whose signs alternate for a negative definite matrix, or do not in this one."""

    def answer(M: FloatArray) -> str:
        S = (M + M.T) / 2
        minors = np.array([np.linalg.det(S[:i, :i]) for i in range(1, len(S) + 1)])
        minors[np.abs(minors) <= zero] = 0
        for sign, turned in (("positive", 1.0), ("negative", -1.0)):
            if np.all(minors * (turned ** np.arange(1, len(S) + 1) if alternating else turned) > 0):
                return f"{sign} definite"
        for sign, turned in (("positive", 1.0), ("negative", -1.0)):
            if np.all(minors * (turned ** np.arange(1, len(S) + 1) if alternating else turned) >= 0):
                return f"{sign} semidefinite"
        return "indefinite"

    return answer


_MINORS = (
    "uses the leading minors. {}If one of them is zero they do not decide: use the signs of the eigenvalues, which do."
)

_WRONG_RULES: tuple[tuple[str, str, Callable[[FloatArray], str]], ...] = (
    (
        "eigenvalues of M itself",
        "uses the eigenvalues of M. For an unsymmetric M, use those of its symmetric part, (M + M')/2.",
        _rounded(lambda M: np.linalg.eigvals(M).real),
    ),
    (
        "eigenvalues of M itself",
        "uses only one triangle of M, as `eigvalsh` does without a warning: form (M + M')/2 first.",
        _rounded(lambda M: np.linalg.eigvalsh(M)),
    ),
    (
        "eigenvalues of M itself",
        "uses the eigenvalues of M, and compares them with 0 exactly. For an unsymmetric M use "
        "those of (M + M')/2, and treat "
        "tiny ones as zero.",
        _exact(lambda M: np.linalg.eigvals(M).real),
    ),
    (
        "eigenvalues of M itself",
        "uses only one triangle of M, and compares with 0 exactly: form (M + M')/2 first, and "
        "treat tiny eigenvalues as "
        "zero.",
        _exact(lambda M: np.linalg.eigvalsh(M)),
    ),
    (
        "semidefinite forgotten",
        "calls a trough definite: if x'Mx is zero for some x other than 0, the matrix is only semidefinite.",
        _without_semidefinite,
    ),
    ("positive and negative swapped", "has positive and negative swapped: a bowl is positive definite.", _opposite),
    (
        "diagonal entries only",
        "uses only the diagonal of M. The other entries matter too: see the saddle with a positive diagonal.",
        _rounded(np.diag),
    ),
    *(
        (
            "determinant only",
            "uses the determinant, the product of all eigenvalues: two negative ones make it positive.",
            _of_determinant(of_symmetric, zero, below),
        )
        for of_symmetric in (True, False)
        for zero in (0.0, 1e-6)
        for below in ("negative definite", "indefinite")
    ),
    *(
        (
            "determinant only",
            f"uses the determinant and the {what}. That is enough for two by two alone: of three eigenvalues, "
            "two negative ones make the determinant positive. Use the signs of the eigenvalues"
            f"{'.' if of_symmetric else ' of (M + M^T)/2.'}",
            _of_determinant_and(of_sign, of_symmetric, tolerance, corner),
        )
        for what, of_sign in (("first entry", _first_entry), ("trace", np.trace))
        for of_symmetric in (True, False)
        for tolerance in (0.0, 1e-6)
        for corner in (gt, ge)
    ),
    *(
        ("leading minors", _MINORS.format(said), _of_minors(zero, alternating))
        for zero in (0.0, 1e-6)
        for alternating, said in (
            (False, "Of a negative definite matrix their signs alternate; they are not all negative. "),
            (True, ""),
        )
    ),
)


def _kind(ask: Ask, M: FloatArray) -> str:
    value = returned(ask, "kind", M)
    if not isinstance(value, str):
        raise NoAnswer(f"`kind` should return one of the five texts; it returns {kind_of(value)}.")
    text = " ".join(value.lower().replace("-", " ").split()).replace("semi definite", "semidefinite")
    if text not in KINDS:
        raise NoAnswer(f"`kind` returns {value[:40]!r}; it should return one of: {', '.join(KINDS)}.", "another text")
    return text


@first_failure
def check_delays(ask: Ask) -> Iterator[Verdict]:
    """`delayed_inputs(u, n)`, Example 2-3."""
    for n, samples in ((3, 9), (2, int(ask.rng.integers(5, 9))), (5, 11), (1, 7), (4, 4)):
        yield _judge_delays(ask, ask.rng.uniform(1, 4, samples), n)


def _judge_delays(ask: Ask, u: FloatArray, n: int) -> Verdict:
    samples = u.size
    call = f"delayed_inputs(u, {n})"
    try:
        value = returned(ask, "delayed_inputs", u, n)
    except NoAnswer as stopped:
        if not any(told in str(stopped) for told in ("must match exactly", "inhomogeneous")):
            raise
        rows = str(stopped).partition(" `y[a:b]` has")[0].partition(" One is empty, as")[0]
        if "takes nothing" in rows:
            raise
        zeros = "Each column has len(u) rows: that of u(t-i) begins with i zeros and leaves out the last i samples."
        raise NoAnswer(f"{rows} {zeros}", stopped.slip) from None
    shape = as_array(call, value).shape
    if n != 3 and shape == (samples, 3):
        return Verdict(False, f"`{call}` always has three columns: use the argument n.", "n not used")
    if n > 1 and shape == (samples - n + 1, n) and _EXACT(as_array(call, value), _rows(u, n)[n - 1 :]):
        return Verdict(
            False,
            "`delayed_inputs` omits the first rows. Example 2-3 keeps them, with zeros for the samples before the "
            "first: there is one row for every y(t).",
            "first rows left out",
        )
    right = _rows(u, n)
    return judge(
        as_matrix(call, value, (samples, n), right),
        right,
        _EXACT,
        "one row per sample, one column per lag.",
        "`delayed_inputs` does not give the matrix of Example 2-3: write down its first three rows.",
        [
            Slip(
                "not shifted",
                "column i of `delayed_inputs` is u(t) itself with its first i entries zero; it should hold u(t-i).",
                lambda: np.column_stack([np.where(np.arange(u.size) < i, 0, u) for i in range(n)]),
            ),
            Slip(
                "index wraps around",
                "`delayed_inputs` uses the last samples as those before the first: `np.roll` and negative indices "
                "wrap around. Before the first sample the input is zero.",
                lambda: np.column_stack([np.roll(u, i) for i in range(n)]),
            ),
            Slip(
                "mirrored at the start",
                "`delayed_inputs` has u(i-t) above its diagonal, as `scipy.linalg.toeplitz(u)` has. Before the "
                "first sample the input is zero.",
                lambda: np.array([[u[abs(t - i)] for i in range(n)] for t in range(u.size)]),
            ),
            Slip(
                "lag off by one",
                "`delayed_inputs` begins with u(t-1); the first column of Example 2-3 is u(t).",
                lambda: _rows(u, n + 1)[:, 1:],
            ),
            Slip(
                "columns in reverse order",
                "`delayed_inputs` has the oldest input first; the columns are u(t), u(t-1), u(t-2), ...",
                lambda: right[:, ::-1],
            ),
            Slip(
                "first sample repeated",
                "`delayed_inputs` repeats the first sample for the times before it; Example 2-3 has zeros there.",
                lambda: _rows(u - u[0], n) + u[0],
            ),
            Slip(
                "shifted the wrong way",
                "`delayed_inputs` contains u(t+1), u(t+2): shift the columns down, not up.",
                lambda: _rows(u[::-1].copy(), n)[::-1],
            ),
        ],
    )


def _rows(u: FloatArray, n: int) -> FloatArray:
    return build_equations(Structure(0, n, delay=0), u, np.zeros(u.size), start=0).Phi


@first_failure
def check_derivatives(ask: Ask) -> Iterator[Verdict]:
    """`gradient_form(A, x)` and `jacobian_cubic(x)`."""
    for n in (3, 2, 4):
        A, x = ask.rng.uniform(-2, 2, (n, n)), ask.rng.uniform(0.5, 2, n)
        yield _gradient(ask, A, x)
        yield _jacobian(ask, x)
    yield Verdict(True, "both derivatives are right, for vectors of any length.")


def _gradient(ask: Ask, A: FloatArray, x: FloatArray) -> Verdict:
    got = as_vector("gradient_form(A, x)", returned(ask, "gradient_form", A, x), x.size)
    verdict = judge(
        got,
        gradient_quadratic(A, x),
        _EXACT,
        "",
        "`gradient_form` is not the derivative of x'Ax: compare it with differences, as in the hint.",
        [
            Slip(
                "A taken for symmetric",
                "`gradient_form` returns 2Ax, which is right only for symmetric A. Each x_k is in row k *and* in "
                "column k of the double sum.",
                lambda: 2 * A @ x,
            ),
            Slip("A taken for symmetric", "`gradient_form` returns 2A'x; Ax is missing.", lambda: 2 * A.T @ x),
            Slip(
                "one of the two terms",
                "`gradient_form` has only one of the two terms: each x_k is in row k *and* in column k.",
                lambda: A @ x,
            ),
            Slip(
                "one of the two terms",
                "`gradient_form` has only one of the two terms: each x_k is in row k *and* in column k.",
                lambda: A.T @ x,
            ),
            Slip(
                "sign of one term",
                "`gradient_form` subtracts one of the two terms: both count with a plus.",
                lambda: A @ x - A.T @ x,
            ),
            Slip(
                "half of the gradient",
                "`gradient_form` is half of the gradient: do not divide by two.",
                lambda: gradient_quadratic(A, x) / 2,
            ),
        ],
    )
    verdict = _with_differences(ask, verdict, "gradient_form", (got, gradient_quadratic(A, x)), _form(A), x)
    terms = {"A x": A @ x, "A'x": A.T @ x}
    return with_factors(verdict, "`gradient_form`", got, terms, {"A x": 1.0, "A'x": 1.0})


_NEAR_TO_DIFFERENCES = 0.01  # of what differences are off by: the same differences, up to rounding


def _with_differences(
    ask: Ask,
    verdict: Verdict,
    name: str,
    got_and_right: tuple[FloatArray, FloatArray],
    f: Callable[[FloatArray], FloatArray],
    x: FloatArray,
) -> Verdict:
    """A verdict that names no mistake, with the step of the differences of f that the result is made of, if it is."""
    if verdict.passed or verdict.slip is not None or not are_named():
        return verdict
    got, right = got_and_right
    code = code_of(ask, name)
    steps = {10.0**-k for k in range(1, 9)} | {h for h in (code.numbers if code is not None else ()) if 0 < h < 1}
    for h in sorted(steps, reverse=True):
        for sides, central in (("one side", False), ("both sides", True)):
            made = _differences(f, x, h, central).reshape(got.shape)
            off = float(np.max(np.abs(made - right)))
            if np.max(np.abs(made - got)) <= _NEAR_TO_DIFFERENCES * off:
                text = (
                    f"`{name}` is made of differences with a step of {h:g} on {sides}, and is off by up to {off:.2g}. "
                    "Differences are for comparing: asked for is the formula of the derivative."
                )
                return Verdict(False, text, "differences for the derivative")
    return verdict


def _form(A: FloatArray) -> Callable[[FloatArray], FloatArray]:
    return lambda z: np.atleast_1d(z @ A @ z)


def _cubic(z: FloatArray) -> FloatArray:
    return np.asarray((z @ z) * z, float)


def _differences(f: Callable[[FloatArray], FloatArray], x: FloatArray, h: float, central: bool) -> FloatArray:
    """The quotients of differences of f, one column for each entry of x."""
    steps = h * np.eye(x.size)
    columns = [(f(x + d) - f(x - d)) / (2 * h) if central else (f(x + d) - f(x)) / h for d in steps]
    return np.asarray(np.column_stack(columns), float)


def _jacobian(ask: Ask, x: FloatArray) -> Verdict:
    n, square, outer = x.size, (x @ x) * np.eye(x.size), np.outer(x, x)
    value = returned(ask, "jacobian_cubic", x)
    if as_array("jacobian_cubic(x)", value).shape in ((n,), ()):
        return Verdict(
            False,
            "`jacobian_cubic` should return a matrix: f has n entries, and each has n partial derivatives.",
            "vector instead of a Jacobian",
        )
    product = "`jacobian_cubic` lacks a term: by the product rule, differentiate both x'x and the second factor x."
    got = as_matrix("jacobian_cubic(x)", value, (n, n))
    verdict = judge(
        got,
        jacobian_cubic(x),
        _EXACT,
        "",
        "`jacobian_cubic` is not the derivative of (x'x) x: compare it with differences, as in the hint.",
        [
            Slip("product rule", product, lambda: square),
            Slip("product rule", product, lambda: 2 * outer),
            Slip("product rule", product, lambda: outer),
            Slip(
                "the 2 forgotten",
                "`jacobian_cubic` has x x' once: both factors of x'x are x, and each is differentiated.",
                lambda: square + outer,
                mend="The derivative of x'x is 2x'.",
            ),
            Slip(
                "3 x'x as for a number",
                "`jacobian_cubic` differentiates as if x were a number, 3x^2. For a vector, x'x I and x x' differ.",
                lambda: 3 * square,
            ),
            Slip(
                "3 x'x as for a number",
                "`jacobian_cubic` differentiates as if x were a number, 3x^2. For a vector, x'x I and x x' differ.",
                lambda: 3 * outer,
            ),
            Slip(
                "3 x'x as for a number",
                "`jacobian_cubic` is zero off its diagonal, as if entry i were x_i^3. It is (x'x) x_i, and "
                "every entry of x is in x'x.",
                lambda: np.diag(3 * x**2),
            ),
            Slip(
                "phi'phi for phi phi'",
                "`jacobian_cubic` adds the number 2x'x to every entry: for a flat array `x @ x.T` is a "
                "number. The matrix x x' "
                "is `np.outer(x, x)`.",
                lambda: square + 2 * (x @ x),
            ),
            *(
                Slip(
                    "entry by entry",
                    f"`jacobian_cubic` adds {factor}x_j^2 to every row of column j: `x * x` multiplies entry by entry, "
                    "and so does `x * x.T`, as the transpose of a flat array is the array itself. The matrix of all "
                    "products x_i x_j is `np.outer(x, x)`.",
                    partial(np.add, square, wrong),
                )
                for factor, wrong in (("2 ", 2 * x * x), ("", x * x))
            ),
            Slip(
                "x'x added to every entry",
                "`jacobian_cubic` adds x'x to every entry.",
                lambda: x @ x + 2 * outer,
                mend="Add it only to the diagonal, with `np.eye(n)`.",
            ),
        ],
    )
    verdict = _with_differences(ask, verdict, "jacobian_cubic", (got, jacobian_cubic(x)), _cubic, x)
    terms = {"x'x I": square, "x x'": outer, "x'x in every entry": (x @ x) * np.ones((n, n))}
    return with_factors(verdict, "`jacobian_cubic`", got, terms, {"x'x I": 1.0, "x x'": 2.0})
