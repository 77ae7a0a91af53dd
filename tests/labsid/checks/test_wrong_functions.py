"""Wrong functions fail on every draw of the trial data: none passes by luck."""

from collections.abc import Callable
from itertools import groupby
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
from variants import Wrong, variants_of

from labsid.checks.notebook import load_assignment
from labsid.checks.question import Question

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


def passes(check: Question, asked: Any, variant: Wrong) -> bool:
    """Whether the verdict is right, unless the check calls the function through a helper of the notebook.

    Such a helper still calls the right function here; `test_variants` runs the whole notebook.
    """
    passed = check.verdict(asked).passed
    written = " ".join(variant.code.values())
    return passed and all(f"def {name}(" in written for name in asked.called)


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
            passed += [
                (variant.name, seed) for seed in range(DRAWS) if passes(check, answers(variables, seed), variant)
            ]
    assert passed == []
