"""Python's errors, explained: each cause with the mistake, and with a neighbour that must not get it."""

import ast
from dataclasses import replace
from typing import Any

import control
import matplotlib.pyplot as plt
import numpy as np
import pytest

from labsid.checks.asked_texts import OF_VARIABLES
from labsid.checks.python_errors import details, explain, told
from labsid.checks.repairs import beside, mends, shape_of_repair
from labsid.checks.stops import OTHERWISE, RIGHT, SHAPED, Stop, packed, stop_of, unpacked
from labsid.rig.switchable.withheld_effects import EFFECT_PATHS

N = 20
VALUES: dict[str, Any] = {
    "np": np, "Phi": np.arange(2.0 * N).reshape(N, 2) ** 2, "Y": np.arange(float(N)), "R": np.eye(2), "W": np.eye(3),
    "y": np.arange(float(N)), "u": np.arange(float(N)), "w": np.arange(5.0), "zeros": np.zeros((N, 2)),
    "data": {"t": np.arange(3.0)}, "k": 2, "single": np.zeros((1, 1)), "one": np.zeros(1), "handed": lambda f: f(1),
    "log": type("Record", (), {})(), "pair": np.where(np.arange(3) > 1), "plt": plt, "ct": control, "z": 0,
}  # fmt: skip


def stopped(code: str) -> Stop:
    names = dict(VALUES)
    try:
        exec(compile(code, "<no file>", "exec"), names)
    except Exception as error:
        return stop_of(error, names, code)
    raise AssertionError(f"{code} does not stop")


CAUSES = [
    ("Phi.T * Y[:, np.newaxis] * Phi", "Phi.T * w", "entry by entry. The product"),
    ("Phi.T * Phi", "u * w", "`Phi.T @ Phi`, which fits"),
    ("y[1:] - u", "Phi[1:] - Phi", "19 entries and `u` has 20"),
    ("y - w", "Phi - W", "they do not pair up"),
    ("np.linalg.solve(R, w)", "np.linalg.solve(Phi, Y)", "has 2 rows, and b, here `w`, has 5"),
    ("np.linalg.inv(zeros @ zeros.T)", "np.linalg.inv(zeros.T @ zeros)", "of rank 2 at most"),
    ("np.linalg.inv(zeros.T @ zeros)", "np.linalg.inv(zeros @ zeros.T)", "columns are dependent"),
    ("np.linalg.inv(single + k * single)", "np.linalg.inv(zeros.T @ zeros)", "is a single number, and it is zero"),
    ("np.linalg.inv(zeros.T @ zeros)", "np.linalg.solve(single, one)", "columns are dependent"),
    ("np.linalg.lstsq(Y, Phi, None)", "np.linalg.solve(Phi.T @ Y, w)", "`lstsq(A, b)` takes the matrix first"),
    ("np.linalg.svd(R * np.nan)", "np.linalg.inv(0 * R)", "a nan or an inf in it"),
    ("np.mean(Phi, axis=1) - w", "np.mean(Phi, axis=0) - w", "number of each *row*"),
    ("[1].remove(2)", "[1].index(2)", "leave the inner loop: `break`"),
    ("['a'].split(',')", "['a'].strip()", "with commas between the names"),
    ("handed(max(1, 2))", "handed(k)", "hand over its name alone, `max`"),
    ("a, b = log", "a, b = k", "The parts of a record have names"),
    ("raise ValueError('(1, 2, 3) is not a valid value for color')", "raise ValueError('c')", "from 0 to 1: divide"),
    ("np.linalg.inv(Phi)", "np.linalg.inv(zeros.T @ zeros)", "`Phi` is 20 by 2; only a square"),
    ("R @ 3", "R @ w", "`3` is one number: a multiple is made by `*`"),
    ("y[:-0] @ y", "y[:0] @ y", "`[:-0]` takes nothing"),
    ("y[:-z] @ y", "y[: z - 1] @ u", "With z = 0, `y[:-z]` takes nothing. `y[: len(y) - z]` is the same"),
    ("y[z - 3 : z + 1] @ y", "y[:0] @ y", "`z - 3` is -3, and an index below zero counts from the end"),
    ("np.linalg.inv(Phi @ Phi.T) @ w", "np.linalg.inv(Phi.T @ Phi) @ Y", "of rank 2 at most: it never has an inverse"),
    ("G = np.linalg.inv(Phi @ Phi.T)\nG @ w", "G = np.linalg.pinv(Phi @ Phi.T)\nG @ w", "of rank 2 at most"),
    (
        "np.linalg.solve(Phi @ Phi.T, Phi.T @ Y)",
        "np.linalg.solve(Phi @ Phi.T + np.eye(20), Phi.T @ Y)",
        "it never has an inverse. `Phi.T @ Phi` is 2 by 2",
    ),
    (
        "W = np.eye(2)\nPhi.T @ W @ Phi",
        "W = Phi.T @ Phi\nPhi.T @ W @ Phi",
        "Between `Phi.T` and `Phi` a square matrix is 20 by 20, and between `Phi` and `Phi.T` 2 by 2",
    ),
    ("np.arange(0, 2).reshape(20, 1)", "y.reshape(3, 1)", "start and stop, and the step is 1"),
    ("np.arange(0, 1.9, 0.1).reshape(20, 1)", "np.arange(0, 1.5, 0.1).reshape(20, 1)", "is left out. 20 are asked for"),
    ("np.linspace(0, 1).reshape(20, 1)", "np.linspace(0, 1, 19).reshape(20, 1)", "it makes 50"),
    ("math.log(y)", "maths.log(y)", "numpy has `np.log`, the natural logarithm"),
    ("math.pi * y", "math.perm(3)", "not needed: numpy has `np.pi`."),
    ("ln(y)", "lnn(y)", "`np.log(x)`, the natural logarithm"),
    ("y(y > 3)", "y(Phi)", "`y[y > 3]`"),
    ("m = (y > 3) & (y < 5)\ny(m)", "m = u\ny(m)", "taken with square brackets, `y[m]`"),
    ("(k - 1)(2)", "k(2)", "calls it: a product needs its `*`"),
    ("while y[k - 1] == y[k - 1]: k += 1", "while y[k - 1] == y[k - 1] + z: k += 1", "compares `y[k - 1]` with itself"),
    ("q = 1\nwhile y[q] < 99: q += 1", "q = k\nwhile y[q] < 99: q += 1", "its condition held for all of them"),
    ("np.where(y, 3)", "np.where(y > 3, y, Phi)", "takes one condition, such as `y >= 3`"),
    ("np.interp(y, u, 3.0)", "np.interp(y, u, Phi)", "Here `3.0` is one number"),
    (
        "np.digitize(np.array([1.0, 2.0]), y[::-1] * u)",
        "np.digitize(y, np.array([1.0, 2.0])) + w[:3]",
        "and then the edges",
    ),
    (
        "np.histogram(np.array([0.0, 9.0]), y, weights=u)",
        "np.histogram(y, np.array([0.0, 9.0]), weights=w)",
        "takes the values first, with a weight for each of them",
    ),
    ("y - np.polyval(y, w)", "y - np.polyval(w, w)", "takes the coefficients first"),
    ("y[np.where(y > 99)[0][0]]", "y[:0][0]", "No entry meets the condition `y > 99`."),
    ("np.column_stack([y, 1])", "np.column_stack([y, w])", "`1` is one number, a column of one row"),
    ("np.vstack([Phi, y])", "np.column_stack([Phi, w])", "all need the same number of columns"),
    ("np.hstack([Phi, 0])", "np.hstack([Phi, y])", "as a table of one row and one column it is `[[0]]`"),
    ("np.concatenate(y, u)", "np.zeros(y)", "handed over together, in a list: `np.concatenate([y, u])`"),
    ("y[y > 3 & y < 5]", "y ^ 2.0", "each comparison needs brackets of its own"),
    ("del y[0]", "y.remove(0)", "Entries of an array cannot be deleted"),
    ("next(one for one in y if one > 99)", "list(k)", "`next` finds nothing"),
    ("np.linalg.svd(Phi).V", "np.linalg.eig(R).V", "the last is V transposed"),
    ("np.polyfit(Phi, y, 1)", "np.polyfit(w, y, 1)", "of one flat x, and takes no table"),
    ("h = y.mean\ny - h", "y - abs", "`h` is a function, by `h = y.mean`: there it is not called"),
    ("v = k y", "v = k if", "`k y`: two names stand side by side"),
    ("t = np.arange(0:0.1:1)", "t = y[0:1:2 3]", "between the arguments of a function stand commas"),
    ("y[20]", "y[25]", "Python counts from 0: 20 entries"),
    ("y[25]", "y[:0][3]", "There are 20 entries"),
    ("y[:0][3]", "y[20]", "It is empty along that axis"),
    ("y[:, 1]", "Phi[:, 1, 0]", "`y` has shape (20,): it is flat"),
    ("data.t", "data.time", 'a key of it, `data["t"]`'),
    ('data["y"]', "data.time", '`data` has the keys "t"'),
    ("y(1)", "k(1)", "round brackets call, square ones take entries"),
    ("k(1 + 1)", "y(1)", "a product is `k * "),
    ("np.column_stack([y[1:], u])", "np.concatenate([Phi, W])", "Here `y[1:]` has 19, `u` has 20"),
    ("np.column_stack(y, u)", "np.array([y, w])", "in a list: `np.column_stack([y, u])`"),
    ("np.concatenate([Phi, y])", "np.column_stack([y[1:], u])", "one is flat, (N,)"),
    ("if y > 3: pass", "if y.undefined: pass", "need one True or False"),
    (
        "a, b = np.linalg.lstsq(Phi, Y, rcond=None)",
        "a = np.array(np.linalg.lstsq(Phi, Y))",
        "the solution is its first",
    ),
    ("np.zeros(20 / 2)", "np.zeros(-1)", "`//` a whole number"),
    ("y ^ 2", "y @ 2", "write `**`"),
    ("np.inv(R)", "np.invert_it(R)", "`np.linalg.inv`"),
    ("zeros((2, 2))", "np.zeros(2, 2)", "`zeros` is no function"),
    ("np.zeros(2, 3)", "np.zeros('a')", "brackets of its own"),
    ("abs - 1", "[1, 2] - 1", "A function itself is no number"),
    ("[1.0, 2.0] - 1", "abs - 1", "make an array of it"),
    ("solve(R, w)", "solved(R, w)", "`np.linalg.solve`"),
    ("length(y)", "lengths(y)", "`len(x)`"),
    ("phi = Phi + PHI", "phi = Phi + other", "capital and small letters differ"),
    ("t = 1:0.1:100", "t = y[1:5 3]", "is MATLAB's range"),
    ("for q = 1:3\n pass", "if k = 1: pass", "MATLAB's loop"),
    ("if k = 1: pass", "t = 1:0.1:100", "`==` compares"),
    ("p = Phi(:, 2)", "p = f(lambda x: x x)", "`A[:, 1]`"),
    ("R = Phi' * Phi", "s = 'it", "The transpose is `.T`"),
    ("s = 'it's fine'", "R = Phi' * Phi", "one with an apostrophe in double quotes"),
    ('print("a\\n)', "c = R \\ w", "that is begun is not ended"),
    ("c = R \\ w", 'print("a\\n)', "`np.linalg.solve(A, b)`"),
    ("v = y(1:end)", "v = y[1 2]", "Python has no `end`"),
    ("v = [1 2 3]", "v = [k for k in y", "separated by commas"),
    ("v = 2pi", "v = 1e-3 2", "a product needs its `*`"),
    ("v = u.*y", "v = 2.*k +", "work entry by entry"),
    ("f(lambda, 1)", "f(lambda x: x x)", "call the variable `lam`"),
    ("t = (0:0.1:100)'", "t = 0:0.1:100", "the transpose of a flat array is the same array"),
    ("t = [0:0.1:100]", "t = (0:0.1:100)'", "where a column vector is asked for, add `.reshape(-1, 1)`"),
    ("R = Phi' * Phi", "t = (0:0.1:100)'", "The transpose is `.T`"),
    ("v = y(1:450)", "t = (1:450)", "`A(1:9)` is `A[0:9]`"),
    ("rand(3, 1)", "randn(3, 1)", "from 0 to 1; between other bounds `rng.uniform(low, high, shape)`"),
    ("x = Phi(1, 2)", "x = Phi(0, 1)", "MATLAB's `Phi(1, 2)` is `Phi[0, 1]`"),
    ("np.linalg.det(Phi)", "np.linalg.inv(Phi)", "`np.linalg.matrix_rank(Phi)`"),
    ("np.linalg.inv(Phi)", "np.linalg.det(Phi)", "Least squares inverts `Phi.T @ Phi`"),
    ("np.linalg.inv(Phi.T * Phi) * Phi.T * Y", "Phi.T * Phi * Y", "each of the 3 `*` in this line is an `@`"),
    ("effect = input-delay", "delay = input-delay", '`"input-delay"`'),
    ("effect = input delay", "effect = input lag", '`"input-delay"`'),
    ("path = dynamics", "place = dynamics", '`"dynamics"`'),
    ("p = {delay: 3.0}", "p = {k: delay}", '`{"delay": ...}`'),
    ("x = data[t]", "x = data[s]", '`data["t"]`'),
    ("np.linespace(0, 1)", "np.lines(0, 1)", "There is `np.linspace`, which is spelt nearly alike"),
    ("np.linalg.rank(R)", "np.linalg.ranks(R)", "It is `np.linalg.matrix_rank`"),
    ("y.diff()", "y.different()", "`np.diff(y)`"),
    ("R.inv()", "y.diff()", "`np.linalg.inv(R)`"),
    ("y.length", "y.t", "`len(y)`"),
    ("Phi.t", "Phi.length", "`Phi.T`, with a capital letter"),
    ("k.shape", "y.shapes", "`k` is one number, no array"),
    ("np.mean(Phi, axis=2)", "np.mean(y, 1)", "the axes 0, down the rows, and 1, along them"),
    ("np.linspace(0, 1, 0.1)", "np.zeros(0.5)", "is the number of points, here `0.1`"),
    ("range(0, 1, 0.1)", "np.zeros(0.5)", "takes any step"),
    ("sum(y, axis=0)", "sorted(y, axis=0)", "`np.sum(...)`"),
    ("max(y, 0)", "max(Phi)", "`np.maximum(y, 0)`"),
    ("max(Phi)", "max(y, 0)", "`np.max(...)`"),
    ("np.sum(y, u)", "np.zeros(y)", "`np.sum` takes one array"),
    ('y["t"]', "y[0.5]", "a text, which is a key of a dictionary"),
    ("for i in len(y): pass", "list(k)", "`range(len(y))` counts from 0"),
    ('y + "2"', 'y + "V"', "a number stands without quotes"),
    ('"V = " + 0.5 * k', 'y + "V"', "`str(0.5 * k)` is one"),
    ("y.mean[0]", "k[0]", "`y.mean` is a function"),
    ("k[0]", "y.mean[0]", "`k` is one number"),
    ("y.shape(0)", "y(0)", "and its first number `y.shape[0]`"),
    ("np.array(1, 2, 3)", "np.append(y)", "`np.array([1, 2, 3])`"),
    ("np.append(y)", "handed()", "`help(np.append)`"),
    ("len(k)", "k[0]", "which has no length"),
    ("x = zero", "x = Y_", "There is `zeros`"),
    ("R^-1 @ w", "R @ 3", "`^` is no power in Python"),
    ("R @ 3", "R^-1 @ w", "a multiple is made by `*`"),
    ("a, b = Phi", "a, b = W", "its 2 columns are `Phi[:, 0]`"),
    ("a, b = W", "a, b = Phi", "`W` has 3 parts, and on the left of `=` stand 2 names"),
    ("a_new = y[1:] - a_new[0]", "a_new = y[1:] - b_new[0]", "stands on the right of `=`, too"),
    ("effect == 'x'", "y[0] == effect", "`effect` gets its value by `=`"),
    ("p = {delay=3.2}", "p = {delay 3.2}", "a colon stands between key and value"),
    ("p = delay: 3.2", "t = 1: 32", "`delay: 3.2` stands in braces"),
    ("t = 1: 32", "p = delay: 3.2", "MATLAB's range"),
    ("kind = 1\nif kind: return positive definite", "if k: return positively", '`"positive definite"`'),
    ("data('t')", "y(0)", "`data['t']`"),
    ("y[pair:]", "y[w:]", "`pair[0][0]`"),
    ("[1.0] + 2.0", "y + None", "make an array of it"),
    ("np.array(y, u)", "np.zeros('a')", "in a list: `np.column_stack([a, b])`"),
    ("np.find(y)", "np.finds(y)", "`np.flatnonzero(condition)`"),
    ("y.plot(u)", "y.plots(u)", "Then take one, `y[0]`"),
    ("plt.subplot(2, 1)", "plt.subplots(2, 1, 3, 4)", "with an s at the end"),
    ("plt.gca().set_xlimit(1)", "plt.gca().frobnicate(1)", "There is `.set_xlim`"),
    ("plt.plot(y, colour='r')", "plt.plot(y, frobnicate=1)", "is spelt `color`"),
    ("plt.plot(y, frobnicate=1)", "plt.plot(y, colour='r')", "A curve has no `frobnicate`"),
    ("plt.gca().stairs(y, y)", "plt.plot(y, w)", "MATLAB's `stairs`"),
    ("ct.tf(1, 2, 3, 4)", "np.zeros(-1)", "two lists of coefficients"),
    ("control.tf([1], [1, 2])", "kontrol.tf([1], [1, 2])", "`ct`, the name under which"),
    ("ct.lsim(1)", "ct.lsims(1)", "`ct.forced_response(sys, inputs=u).outputs`"),
    ("def g(a, b): pass\ng(1)", "np.append(y)", "The first line of `g` has `b`, too"),
    ("size(y, 1)", "sizes(y, 1)", "`size(A, 1)` is `A.shape[0]`"),
    ("np.size(Phi, 2)", "np.mean(Phi, axis=2)", "`size(Phi, 2)` is `Phi.shape[1]`"),
    ("y.shape // 2", "data // 2", "`y.shape` is a tuple"),
    ("Phi.shape[2]", "pair[3]", "is counted from 0: `[0]` is the number of rows"),
    ("n = Phi.shape\nrange(n)", "n = 2.5\nrange(n)", "a whole shape, a tuple, by `n = Phi.shape`"),
    ("n = np.where(y > 3)\nn - 1", "n = np.linalg.lstsq(Phi, Y)\nn - 1", "The first index is `n[0][0]`"),
    ("n = np.linalg.lstsq(Phi, Y)\nn - 1", "n = np.where(y > 3)\nn - 1", "is all that `np.linalg.lstsq` returns"),
    ("n = y[np.where(y > 3)]\nn - y", "n = y[4:]\nn - y", "one for each index that `np.where` finds"),
    ("n = y[3]\ny[:n]", "n = k / 2\ny[:n]", "An index counts samples"),
    ("y[np.min(y)]", "y[k / 2]", "where it is, `np.argmin(...)` tells"),
    ("phi = Phi[:, 0]\nphi @ w[:2]", "phi = Phi[0]\nphi @ w[:3]", "is a column of `Phi`, with 20 entries"),
    ("Phi[0] - y", "w[:2] - y", "is a row of `Phi`, with 2 entries; a column, `Phi[:, 0]`, has 20"),
    ("for phi in Phi.T:\n phi @ w[:2]", "for phi in Phi:\n phi @ w[:3]", "is gone through column by column"),
    ("theta = np.zeros(len(Phi))\nPhi[0] @ theta", "theta = np.zeros(5)\nPhi[0] @ theta", "`Phi.shape[1]`, 2"),
    ("H = np.zeros((3, 4))\nH[:, 0] = w[:4]", "H = np.zeros((3, 4))\nH[0] = w[:3]", "a row, `H[0]`, has 4"),
    ("H = np.zeros(5)\nH[0] = w", "H = np.zeros((4, 4))\nH[0] = w", "MATLAB's `zeros(n)` is n by n"),
    ("np.linalg.solve((R, w))", "np.linalg.solve(R)", "`np.linalg.solve(R, w)`"),
    ("def g(a): pass\ng(*w)", "def g(a): pass\ng(w, w)", "each of its 5 parts as an argument of its own"),
    ("def g(a): pass\ng(1, 2)", "def g(a): pass\ng(*w)", "`g` takes `a`, and the call hands over 2"),
    ("np.column_stack(*[y, u])", "np.column_stack(y, u)", "without the star"),
    ('data["t.values"]', 'data["values"]', "names two levels at once"),
    ("data[4]", 'data["y"]', "A number is no key here"),
    ("f = np.fft.rfftfreq(20, 1)\nf * np.fft.fft(y)", "f = y[:11]\nf * y", "Here are `fft` and `rfftfreq`"),
    ("np.fft.rfftfreq(y, 1)", "np.zeros('a')", "takes the number of samples first"),
    ("np.linalg.lstsq(Phi, w)", "np.linalg.lstsq(Y, Phi, None)", "`Phi` has 20 rows and `w` has 5 entries"),
    ("i = np.digitize(20, y)\ny[i]", "i = 20\ny[i]", "counts its cells from 1"),
    ("np.eye(3, -1)", "np.zeros(-1)", "`np.eye(3, k=-1)`"),
    ("range([1, 2])", "range(1.5)", "goes through it itself"),
    ("a, b = np.size(Phi)", "a, b = k", "Rows and columns are `Phi.shape`"),
    ("U, s, V, r = np.linalg.svd(R)", "U, s = w", "`np.linalg.svd` returns 3 things"),
    ("np.linalg.inv(Phi * Phi.T)", "Phi.T * Phi", "20 by 20, and never has an inverse; `Phi.T @ Phi` is 2 by 2"),
    ("[w, w].T @ w", "['a'].split(',')", "`np.column_stack(...)` one with a column for each"),
    ("W = np.zeros((3, 2))\nW[0] = R * w[:2] * w[:2, np.newaxis]", "W = np.zeros(3)\nW[0] = w", "Often here: `*`"),
    ("ct.ss([[0, 1], [2, 3]], [[0, 1]], [[1, 2]], [[0]], 1)", "ct.ss(R, w, w, 0)", "`[[0], [1]]`"),
    # repairs that were tried, by their shapes, in the line
    ("Y - Phi * w[:2]", "Phi - Y", "has shape (20, 2). The product of the matrix and the vector is `Phi @ w[:2]`"),
    ("y_hat = Phi * w[:2]\nY - y_hat", "y_hat = Phi * 2\nY - y_hat", "In `y_hat = Phi * w[:2]`, `Phi * w[:2]`"),
    ("Y - Phi - w", "y[1:] - u", "`Phi` has shape (20, 2)"),
    ("Phi.T @ Y + Phi.T @ w[:2]", "Phi.T @ w[:2]", "Beside `Phi.T @ Y`, of shape (2,), the product must have"),
    ("w[:2] - Phi.T * Phi", "w - Phi.T * Phi", "`Phi.T @ Phi`, which fits"),
    # a number that is called, lists that are joined, functions that are not called
    ("theta, n = 2.5, 5\ntheta(n - 1)", "theta, n = 2.5, 5\ntheta(n * 3.5)", "is the value at that index"),
    ("def g(theta, n):\n return theta(n - 1)\ng(2.5, 5)", "k(1 + 1)", "the argument holds that value already"),
    ("a, b = [y, u], [y]\nnp.column_stack(a, b)", "np.column_stack(y, u)", "`np.column_stack(a + b)`"),
    ("a, b = [y, u], [w]\nnp.column_stack(a, b)", "a, b = [y], [y]\nnp.column_stack(a, b)", "with 5 and 20 rows"),
    ("np.column_stack(y, w)", "np.column_stack(y, u)", "and these have 20 and 5 rows"),
    (
        "J = handed\nJ.T @ J",
        "handed.frob",
        "a function, by `J = handed`, and not what it returns: it is called, `J(f)`",
    ),
    # names that are not known
    ("traces = y\ntrace(R)", "x = zero", "It is a function of numpy: `np.trace`"),
    ("x = zero", "zero(3)", "There is `zeros`"),
    ("bode(1)", "bodes(1)", "It is a function of control: `ct.bode`"),
    ("comb(5, 2)", "combs(5, 2)", "`math.comb`, after `import math`"),
    ("step(1)", "steps_1(1)", "`ct.step_response(sys)`"),
    ("stats.t.ppf(1)", "stats.frob(1)", "It is a part of scipy: `scipy.stats.t`"),
    ("t_step = y\nt_fine = w\nplt.plot(q, y) if 0 else (t, y)", "plt.plot(q, y)", "There is `t_step`"),
    ("load_record = handed\nload_record('a.csv', inputs=Q1)", "handed(Q1)", 'as texts, in quotes: `"Q1"`'),
    ("r = load_record('a', inputs=Q1,Q2, outputs=T1,T2)", "f(inputs=Q1, 3)", '`inputs="Q1,Q2"`'),
    ("f(inputs=Q1,Q2)", "f(inputs=Q1, 3)", "stand in a list: `inputs=[Q1,Q2]`"),
    ("def g(a):\n return a = k", "def g(a):\n return f(a=1) b", "`==` compares two values"),
    ("def g(a):\n return a = k", "def g(a):\n return a == 1 b", "`==` compares two values"),
    # columns of different lengths, and lists
    (
        "c = []\nfor i in range(2):\n c.append(y[:-i])\nnp.column_stack(c)",
        "c = []\nfor i in range(2):\n c.append(y[: 9 - i])\nnp.column_stack(c)",
        "`y[:-i]` takes nothing",
    ),
    (
        "d = 2\nc = [y[d - i : d + 9 - i] for i in range(4)]\nnp.column_stack(c)",
        "np.column_stack([y[1:], u])",
        "`d - i` is below zero",
    ),
    ("np.column_stack([y[1:], y[:-2]])", "np.column_stack([[1], y])", "Here `y[1:]` has 19, `y[:-2]` has 18"),
    ("[1, 2, 3][k + 1]", "[1, 2][k]", "The list has 3 entries"),
    (
        "c = [1, 2]\nc[k]",
        "[1, 2, 3][k + 1]",
        "`c` has 2 entries: Python counts from 0, so the last is `[1]`. Here `k` is 2",
    ),
    # each with another mistake that stops with the same error
    ("y[3] - y[:0].remove(1)", "y.plot(u)", "a method of lists, and `y[:0]` is an array"),
    ("np.mean(Phi, axis=1) - w[:2]", "np.mean(Phi, axis=1) - w", "`axis=0` makes one of each column, 2 in all"),
    ("Phi - Phi.mean(axis=1)", "Phi - y", "`axis=0` makes one of each column, 2 in all"),
    ("np.convolve(w, u) - u", "np.convolve(w, u)[1:] - u", "are the first, `np.convolve(w, u)[: len(u)]`"),
    ("u[0] - Phi[0] - (y - w)", "Phi[0] - y", "do not pair up"),
    ("Phi[0] - y", "Phi[0, 0] - (y - w)", "is a row of `Phi`"),
    ("n = len(Phi[0])\ny[n:] - y", "Phi[0] - y", "18 entries and `y` has 20"),
    ("Phi[0] = y", "Phi[0] = w", "a column, `Phi[:, 0]`, has 20"),
    ("Phi[0] = w", "Phi[0] = y", "`Phi[0]` takes 2 numbers, and `w` has 5"),
    ("H = np.eye(3, 1)\nH[0] = w[:3]", "H = np.zeros((3, 1))\nH[0] = w[:2]", "is the number of columns"),
    ("H = np.zeros(4)\nH[0] = w * k", "H = np.zeros(4)\nH[0] = {}", "Is it to be one number?"),
    ("for k in range(30):\n y[k]", "y[20]", "Here `k` is 20"),
    ("for k in range(9):\n Phi[0, k]", "for k in range(30):\n Phi[k, 0]", "`Phi` has 2 columns (and 20 rows)"),
    ("i = np.digitize(25, y)\ny[i + 1]", "i = np.digitize(19, y)\ny[i]", "A value at the last edge"),
    ("k()", "k(1 + 1)", "it takes no round brackets"),
    ("y(w)", "y(k)", "hand over the function by its name alone"),
    ("y(k)", "y(w)", "square ones take entries"),
    ("np.ones(y)", "np.ones(20 / 3)", "its length is `len(y)`"),
    ("np.ones(20 / 3)", "np.ones(2.5)", "`/` always gives a float"),
    ("for row in Phi:\n Phi[row]", "for row in Phi:\n Phi[row[0] / 2]", "and an index is one whole number"),
    ("y[2.0:3.0]", "y[20 / 4:]", "`2.0` is no whole number"),
    ("np.where(np.diff(y)) + 1", "np.where(y > 3) + 1", "the array of all of them `np.where(np.diff(y))[0]`"),
    ("np.where(y > 3) + 1", "np.where(np.diff(y)) + 1", "`np.argmax(y > 3)`"),
    ("y > 3 and y < 5", "if y > 3: pass", "`(y > 3) & (y < 5)`"),
    ("3 < y < 5", "y > 3 and y < 5", "A chain of comparisons"),
    ("np.clip(y, 1, 2) if y[0] < y else 1", "np.arange(3)[:2].round(y == y)", "`y[0] < y` gives one for each entry"),
    ("sorted([y, u])", "if y: pass", "arises within the function that is called"),
    ("def g(x): pass\na, b = g(1)", "a, b = W", "nothing (None)"),
    ("U, V = np.linalg.svd(Phi)", "U, V = np.linalg.lstsq(Phi, Y)", "`np.linalg.svd` returns 3 things"),
    ("import scipy.signal\nscipy.signal.lfilter([1, k], y)", "np.linalg.solve((R, w))", "needs `x`, too"),
    ("np.linalg.solve((R, w))", "import scipy.signal\nscipy.signal.lfilter([1, k], y)", "handed over one by one"),
    ("import scipy.stats\nscipy.stats.t.ppf(1)", "def g(a, b): pass\ng(1)", "`scipy.stats.t.ppf` needs `df`, too"),
    ("[].append(1, 2)", "[].insert(1)", "`[].append([1, 2])`"),
    ("len(Phi, 1)", "abs(Phi, 1)", "`Phi.shape[1]`"),
    (
        "A = w[np.newaxis, :3]\nnp.block([[W, A], [A, 0]])",
        "np.block([[R, Phi[:3].T], [Phi[:3], 0]])",
        "All fit when `A` is transposed",
    ),
    (
        "np.block([[R, Phi[:3].T], [Phi[:3], 0]])",
        "A = w[np.newaxis, :3]\nnp.block([[W, A], [A, 0]])",
        "The empty corner",
    ),
    ("np.linalg.inv(np.dot(zeros, zeros.T))", "np.linalg.inv(np.dot(zeros.T, zeros))", "of rank 2 at most"),
    ("np.linalg.inv(Phi)", "np.linalg.inv(Phi.T)", "Least squares inverts"),
    ("np.linalg.inv(1 + k)", "np.linalg.inv(y)", "The inverse of a number x is `1 / x`"),
    ("np.linalg.lstsq(handed, y)", "np.linalg.lstsq(3, y)", "it is called, `handed(...)`"),
    ("np.linalg.lstsq([u, y], Y)", "np.linalg.lstsq(Phi, w)", "which are taken for rows"),
    ("np.array([[1, 2], [3]])", "np.array([y, w])", "have 2 and 1 entries: these must be equal"),
    ("np.array([k, w])", "np.array([y, w])", "`*w` puts each of its entries"),
    ("np.array([y, w])", "np.array([k, w])", "have 20 and 5 entries"),
    ("np.concatenate([0, y])", "np.concatenate([Phi, y])", "an array of one entry is `[0]`"),
    ("y[w > 2]", "y[20]", "and `w > 2` has 5"),
    ("data[:, 1]", "data['y']", 'with the keys "t"'),
    ("plt.plot(y, w)", "plt.plot(y, [y, u])", "`y` has 20 entries and `w` has 5"),
    ("plt.plot(y, [y, u])", "plt.plot(y, w)", "a table is drawn column by column"),
    ("np.histogram(y, 3, weights=w)", "np.fft.rfftfreq(y, 1)", "`y` has shape (20,) and `w` (5,)"),
    ("ct.tf([1, w], [1])", "ct.tf([[1], [2]], [[1], [2], [3]], 1)", "`w` is an array, of shape (5,), among numbers"),
    ("ct.tf([[1], [2]], [[1], [2], [3]], 1)", "ct.tf([1, w], [1])", "is a list within a list"),
    ("ct.tf([1], [1, 2], Ts=1)", "ct.forced_response(1, frob=2)", "or the keyword `dt`"),
    ("float(handed)", "float(y)", "is a function, and numbers are asked for"),
    ("np.random.default_rng().rand(3)", "np.random.default_rng().unifrom(3)", "random(shape)`"),
    ("x = e**2", "x = y @ e", "`np.exp(x)` for a power of e"),
    ("x = var(y)", "x = 3 * var", "It is a part of numpy: `np.var`"),
    ("p = {'low' = 1, 'high' = 2}", "p = {k == 2 3}", "a colon stands between key and value"),
    ("f(y, 200:)", "f(y 200)", "a range `a:b` stands in square brackets only"),
    ("Phi[0, 1, 0]", "y[0, 1]", "it takes 2 indices, not 3"),
    ("P = np.eye(20)\nphi = Phi[0]\nP @ phi", "phi = Phi[:, 0]\nphi @ w[:2]", "`P` is made by `P = np.eye(20)`"),
    ("phi = Phi[:, 0]\nphi @ w[:2]", "P = np.eye(20)\nphi = Phi[0]\nP @ phi", "of `Phi`, with 20 entries"),
    ("E = []\nE[0.5]", "E = []\nE['a']", "whole number"),
    ("E = []\nE[0] = 1", "E = []\nE[0]", "`append` adds one"),
    ("if y[:0] > 1 and k: pass", "y[:0].frob", "`and` asks for one True or False"),
    ("filter(1, 2, 3)", "map(1)", "`scipy.signal.lfilter(b, a, u)`"),
    ("np.arange((0, 1))", "np.arange(y)", "one by one, `np.arange(start, stop, step)`"),
    ("np.dot(R, Phi.T, w)", "np.dot(R, w)", "where the result is put"),
    ("ct.tf([1], [1, 2]).A", "ct.tf([1], [1, 2]).frob", "belong to a state space"),
    ("np.random.default_rng().uniform(0, 1, 3, 1)", "np.append(y)", "The shape is one argument"),
    ("def g(a): pass\nh = g\nh(1, 2)", "def g(a): pass\ng(1, 2)", "other arguments than its first line"),
    ("x = (y if k)", "x = (y for k)", "`a if condition else b` needs both"),
    ("k++", "k + + ", "counted up by `n += 1`"),
    ("v = 2 * lambda / (1 - lambda)", "v = 2 * (lambda x: x x)", "call the variable `lam`"),
]


PROPOSALS = [
    ("Phi.T @ Y @ Phi", "`np.diag(Y)`"),
    ("Phi.T @ w[:2]", "Is `Phi @ w[:2]` meant?"),
    ("np.linalg.inv(Phi.T @ Phi) @ Y + w[:2]", "`Phi.T @` before `Y`"),
    ("np.zeros(3) + u", "join them"),
    ("Phi.T @ Y @ Phi - R", "`np.diag(Y)`"),
    ("sigma = np.arange(20.0)\nsigma * Phi", "`sigma[:, np.newaxis]`"),
    ("Phi - y", "`y[:, np.newaxis]`"),
    ("np.zeros(3) + u", "Is one to stand behind the other?"),
    ("Phi * Y", "`Y[:, np.newaxis]`"),
    ("np.linalg.solve(Phi.T @ Phi, Y)", "multiplied, too: `Phi.T @ Y`"),
    ("np.zeros(3) + u", "join them: `np.concatenate([np.zeros(3), u])`"),
    ("np.linalg.inv(Phi.T @ Phi) @ Phi", "Is `Phi.T` in place of `Phi` meant?"),
    ("np.linalg.inv(Phi.T @ Phi) @ Y", "Is `Phi.T @` before `Y` meant?"),
    ("Phi @ Y", "Is `Phi.T @ Y` meant?"),
    ("H = np.eye(20)\nPhi @ H", "Is `H @ Phi` meant?"),
    ("A = w[np.newaxis, :3]\nnp.block([[W, A], [A, 0]])", "Is `A.T` meant?"),
    ("A = Phi[:3]\nR @ A", "Is `R @ A.T` meant?"),
    ("Phii @ w", "Is `Phi` meant?"),
]
"""Repairs that are proposed where the answer is right with them."""


@pytest.mark.parametrize(("mistake", "said"), PROPOSALS, ids=[one[0] for one in PROPOSALS])
def test_a_repair_is_proposed_only_where_the_answer_is_right_with_it(mistake: str, said: str) -> None:
    stop = stopped(mistake)
    assert said in explain(replace(stop, outcome=lambda mend: RIGHT))
    assert said not in explain(replace(stop, outcome=lambda mend: OTHERWISE))
    assert said not in explain(stop)
    assert "meant" not in explain(replace(stop, outcome=lambda mend: SHAPED))


@pytest.mark.parametrize(("mistake", "neighbour", "said"), CAUSES, ids=[one[0] for one in CAUSES])
def test_a_cause_is_told_and_only_where_it_holds(mistake: str, neighbour: str, said: str) -> None:
    assert said in explain(stopped(mistake))
    assert said not in explain(stopped(neighbour))


def test_a_repair_is_tried_by_its_shapes_and_none_of_it_is_run() -> None:
    stop = stopped("Y - 2 * Phi @ w + handed")
    part = next(node for node in stop.operations(ast.MatMult))
    assert not mends(stop, part, "Phi @ w[:3]")
    assert mends(stop, part, "Y")
    assert mends(stop, part, "2 * Y[:, np.newaxis].ravel()")
    assert not mends(stop, part, "w")
    assert not mends(stop, part, "handed(Y)")
    assert not mends(stop, part, "Y +")
    assert shape_of_repair(stop, "Phi.T @ Y") == (2,)
    assert shape_of_repair(stop, "Phi @ Y") is None
    assert beside(stop, part) == ("Y", (N,))
    systems = stopped("np.linalg.solve(Phi.T @ Phi, Y) - w[:2]")
    right = next(node for node in ast.walk(ast.parse(systems.line)) if ast.unparse(node) == "Y")
    assert mends(systems, right, "Phi.T @ Y")  # type: ignore[arg-type]
    assert not mends(systems, right, "Phi @ Y")  # type: ignore[arg-type]


def test_names_within_a_lambda_or_a_comprehension_are_not_those_of_the_notebook() -> None:
    inside = "def g(y, n):\n return [y[i:n] - u for i in range(3)]\ni = 999\ng(y, 4)"
    assert stopped(inside).things["i"].value == 0
    outside = "i = 999\ndef g(y, n):\n return np.column_stack([y[i:n - i] for i in range(3)])\ng(y, 4)"
    assert "i" not in stopped(outside).things
    searched = "start = 3\ndef g(y):\n start = y\n return handed(lambda a: (y - w, start)[0])\ng(y)"
    assert "start" in stopped(searched).things
    unused = "start = 3\ndef g(y):\n start = y\n return handed((lambda a: y - w) if 1 else start)\ng(y)"
    assert "start" not in stopped(unused).things


def test_a_whole_number_is_no_fraction_in_another_process() -> None:
    stop = stopped("m = 2.5\ny[k:m]")
    again = unpacked(packed(stop), stop.kind, stop.text, lambda text: True)
    assert explain(again) == explain(stop)
    assert explain(again).startswith("`m` is no whole number")


def test_the_texts_that_are_known_without_quotes_are_those_that_are_asked_for() -> None:
    assert set(OF_VARIABLES["effect"]) == set(EFFECT_PATHS)
    assert set(OF_VARIABLES["path"]) == set(EFFECT_PATHS.values())
    returned = "def kind(M):\n return positive definite", "def layout(beacons):\n return mirror\nlayout(1)"
    assert [explain(stopped(code)) for code in returned] == [
        'A text stands in quotes: `"positive definite"`.', 'A text stands in quotes: `"mirror"`.'
    ]  # fmt: skip


def test_a_variable_of_a_natural_name_is_no_text() -> None:
    assert "quotes" not in explain(stopped("def is_unique(Phi):\n return unique\nis_unique(1)"))


def test_a_name_that_a_function_lacks_is_said_with_what_it_has() -> None:
    said = explain(stopped("def loss(Phi, theta):\n return E @ theta\nloss(1, 2)"))
    assert said.startswith("It is no argument of the function, which has `Phi`, `theta`")


def test_a_call_by_the_check_is_not_told_as_a_call_of_the_students() -> None:
    stop = Stop("TypeError", "fit() takes 1 positional argument but 2 were given")
    assert "with the arguments of the question" in explain(stop)
    assert "with the arguments of the question" not in explain(stopped("handed()"))


def test_the_message_begins_with_pythons_own_line_and_the_shapes() -> None:
    text = told(stopped("theta = np.linalg.solve(Phi.T @ Phi, Y)"), "The answer cell")
    assert text.startswith("The answer cell stopped with ValueError: solve")
    assert "in line 1: `theta = np.linalg.solve(Phi.T @ Phi, Y)`. There `Phi` has shape (20, 2), `Y` has " in text


def test_an_undefined_name_names_the_cell_that_makes_it() -> None:
    assert explain(stopped("missing + 1"), lambda name: f"`{name}` is made in question 3.") == (
        "`missing` is made in question 3."
    )
    assert "No cell that has been run defines it" in explain(stopped("missing + 1"), lambda name: "")


def test_reading_a_line_runs_none_of_it() -> None:
    calls: list[int] = []

    class Loud:
        def __getitem__(self, index: int) -> int:
            calls.append(index)
            return 1

        @property
        def shape(self) -> tuple[int, ...]:
            calls.append(0)
            return (1,)

    names = {**VALUES, "loud": Loud(), "f": lambda: calls.append(1)}
    line = "y[1:] - u + (0 if True else loud[0] + loud.shape[0] + f())"
    with pytest.raises(ValueError, match="broadcast") as caught:
        exec(line, names)
    assert "19 entries" in explain(stop_of(caught.value, names, line))
    assert calls == []


def test_a_stop_is_the_same_after_the_way_to_another_process() -> None:
    stop = stopped("phi = Phi[:, 0]\ntheta = np.linalg.solve(R, phi)")
    again = unpacked(packed(stop), stop.kind, stop.text, lambda text: True)
    assert details(again) == details(stop)


@pytest.mark.parametrize(
    "message",
    [
        None, [], "text", {"things": 3}, {"things": [[1, 2]]}, {"things": [["Phi", "array", [-1, "x", 10**9], True]]},
        {"things": [["Phi", "secret of grading", [3], True]]}, {"arguments": 5, "line": ["x"]},
        {"made": [1]}, {"made": {"Phi": 3}},
    ],
)  # fmt: skip
def test_another_process_cannot_say_what_it_likes(message: Any) -> None:
    assert unpacked(message, "ValueError", "text", lambda text: False) in (
        Stop("ValueError", "text"),
        Stop("ValueError", "text", things={}),
    )


def test_only_what_stands_in_the_notebook_is_taken_over() -> None:
    sent = {
        "line": "theta_of_grading = 4.0",
        "part": "theta_of_grading",
        "things": [["theta_of_grading", "array", [4], True], ["y", "array", [20], True]],
        "arguments": ["theta_of_grading"],
        "near": "theta_of_grading",
        "made": {"theta_of_grading": "y", "y": "y = hidden"},
    }
    stop = unpacked(sent, "ValueError", "text", lambda text: text == "y")
    assert (stop.line, stop.part, stop.arguments, stop.near, stop.made) == ("", "", (), "", {})
    assert set(stop.things) == {"y"}
