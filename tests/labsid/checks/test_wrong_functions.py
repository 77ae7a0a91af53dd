"""Wrong functions fail on every draw of the trial data: none passes by luck."""

from collections.abc import Callable
from itertools import groupby

import matplotlib.pyplot as plt
import numpy as np
import pytest
from variants import Wrong, variants_of

from labsid.checks.notebook import load_assignment

LECTURES = (
    "least-squares",
    "model-structures",
    "recursive-identification",
    "armax-and-instruments",
    "nonlinear-least-squares",
)
DRAWS = 8
WRONG = [
    pytest.param(name, question, list(variants), id=question)
    for name in LECTURES
    for question, variants in groupby(
        sorted((v for v in variants_of(name) if isinstance(v, Wrong)), key=lambda v: v.question),
        key=lambda v: v.question,
    )
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "question", "variants"), WRONG)
def test_no_wrong_function_passes_by_luck(
    name: str, question: str, variants: list[Wrong], solved: Callable, answers: Callable
) -> None:
    check = load_assignment(name).question(question)
    passed = []
    for variant in variants:
        variables = dict(solved(name))
        try:
            with np.errstate(all="ignore"):
                for source in variant.code.values():
                    exec(compile(source, question, "exec"), variables)
        except Exception:
            continue  # such an answer stops in its own cell; what is judged then is not a function
        finally:
            plt.close("all")
        with np.errstate(all="ignore"):
            passed += [(variant.name, seed) for seed in range(DRAWS) if check.verdict(answers(variables, seed)).passed]
    assert passed == []
