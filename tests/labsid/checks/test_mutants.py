"""Single changes of the model solutions fail. `make mutants` tries all of them, this a few."""

import mutants
import numpy as np
import pytest
from one_answer import solve

A_FEW = 12
QUICK = ("prelab-sinusoids", "postlab-model-order", "least-squares", "model-structures")


@pytest.mark.slow
@pytest.mark.parametrize("name", QUICK)
def test_what_the_checks_do_not_notice_is_listed_with_its_reason(name: str) -> None:
    solved, known = solve(name), mutants.equivalent()
    every = list(mutants.mutants_of(solved))
    few = np.random.default_rng(21).choice(len(every), A_FEW, replace=False)
    assert [every[i].name for i in few if mutants.survives(solved, every[i]) and every[i].name not in known] == []


def test_every_reason_is_given() -> None:
    assert all(mutants.equivalent().values())


@pytest.mark.parametrize(
    ("written", "changed"),
    [
        ("x = 2", {"x = 3", "x = -2", "x = 1"}),
        ("x = y + z", {"x = y - z"}),
        ("x = y < z", {"x = y <= z"}),
        ("x = y and z", {"x = y or z"}),
        ("x = -y", {"x = +y"}),
        ("x -= y", {"x += y"}),
        ("def f(u, y):\n    return u", {"def f(u, y):\n    return y"}),
        ("plot(y, linewidth=2)", set()),
        ("x = f(y)", set()),
    ],
)
def test_single_changes(written: str, changed: set[str]) -> None:
    lines = written.split("\n")
    inside = "\n".join([*lines[:-1], "### BEGIN SOLUTION", lines[-1], "### END SOLUTION"])
    assert {source for _, source in mutants.mutated(inside)} == changed


def test_given_lines_stay() -> None:
    source = "x = 1\n### BEGIN SOLUTION\ny = x\n### END SOLUTION\nz = 2\n"
    assert list(mutants.mutated(source)) == []
