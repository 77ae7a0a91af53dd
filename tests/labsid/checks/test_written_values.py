"""Which values the cells of a notebook have typed in."""

import pytest

from labsid.checks.written_values import typed_names

_COMPUTED = (
    "for k in range(2, 9):\n    a.append(y[k])",
    "for k in range(2, 9):\n    a.extend([y[k]])",
    "for v in y:\n    a.insert(0, v)",
    "for v in y:\n    a.append(1 if v > 0 else 0)",
    "for v in y:\n    if v > 0:\n        a.append(1)",
    "for v in y:\n    a += [v]",
    "for v in y:\n    a[0] += v",
    "a.extend(y)",
    "a += list(y)",
    "a[:] = y[2:half]",
    "[a.append(v) for v in y]",
    "list(map(a.append, y))",
    "add = a.append\nfor v in y:\n    add(v)",
    "rows = a\nfor v in y:\n    rows.append(v)",
    "a = rows = []\nfor v in y:\n    rows.append(v)",
    "a = rows = []\nfor v in y:\n    rows += [v]",
    "k = 2\nwhile k < 9:\n    a.append(y[k])\n    k += 1",
    "def fill():\n    for v in y:\n        a.append(v)\nfill()",
    "def fill():\n    global a\n    a = y\nfill()",
    "simulate(a, u)",
    "a = np.array([0.0, 0])\nnp.copyto(a, y[:2])",
    "a = np.array([0.0, 0])\nnp.add(y[1], y[2], out=a)",
    "a = np.array([0.0, 0])\na.fill(y[3])",
)


@pytest.mark.parametrize(
    ("source", "typed"),
    [
        ("a = 2.3", "a"),
        ("a, b = 2.3, -0.4", "ab"),
        ("a, b = np.array([2.3, 1])", "ab"),
        ("a = np.array([[1, 2], [3, 4.5]], dtype=float)", "a"),
        ("a = b = 3", "ab"),
        ("a: float = -(2 / 3)", "a"),
        ("a = np.r_[1.5, 2]", "a"),
        ("a = np.array([1, 2]).reshape(-1, 1)", "a"),
        ("%matplotlib inline\na = 'input'", "a"),
        ("a = u[0]", ""),
        ("a = 2 * b", ""),
        ("a = np.mean([1, 2])", ""),
        ("a = 0\nfor k in range(9):\n    a = a + k", ""),
        ("a = np.zeros(3)", ""),
        ("a = 1\na = f(2)", ""),
        ("a = [0]\na[0] = u[3]", ""),
        ("a = 3\na += 1", "a"),
        ("def a():\n    return 3", ""),
        ("a = 3\na =", ""),
        ("a = []\na.append(0.12)\na.append(-0.3)", "a"),
        ("a = [0.5]\na[0] = 0.7\na.sort()\nprint(a)\nb = f(a)", "a"),
        ("a = [1.5, 2]\nplt.plot(t, a)\nlen(a)\ng = ct.tf(a, [1, 2], out)", "a"),
        ("a = [1.5]\ndef f(y):\n    a = []\n    a.append(y)\n    return a", "a"),
        ("b = 2.0\na = [b, 3]", "ab"),
        *((f"a = []\n{changed}", "") for changed in _COMPUTED),
    ],
)
def test_typed_names(source: str, typed: str) -> None:
    assert typed_names([source], ["a", "b"]) == set(typed)


def test_a_value_is_filled_in_another_cell() -> None:
    assert typed_names(["a = []", "print(a)"], ["a"]) == {"a"}
    assert typed_names(["a = []", "for v in y:\n    a.append(v)"], ["a"]) == set()
