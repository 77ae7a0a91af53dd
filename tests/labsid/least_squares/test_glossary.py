"""The function table runs."""

import numpy as np
import pytest

import labsid.least_squares.matrix_inverse
from labsid.least_squares.glossary import ACRONYMS, FUNCTIONS

A = np.array([[4.0, 1, 2], [0, 3, 1], [1, 0, 5]])
B = np.array([[1.0, 2, 0], [0, 1, 1], [3, 0, 1]])
EXPECTED = {
    "A\\B": np.linalg.inv(A) @ B,
    "A/B": A @ np.linalg.inv(B),
    "pinv(A)": np.linalg.inv(A),
    "adjoint(A)": np.linalg.det(A) * np.linalg.inv(A),
    "det(A)": 61.0 - 6 + 0,
    "rank(A)": 3,
}


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda function: function.matlab)
def test_every_python_expression_runs_and_is_what_the_matlab_one_is(function):
    value = eval(function.python, {"np": np, "labsid": labsid, "A": A, "B": B, "n": 3})
    if function.matlab in EXPECTED:
        np.testing.assert_allclose(value, EXPECTED[function.matlab], atol=1e-12)


def test_the_acronyms_of_the_notes_are_there():
    assert {"ARIMA", "ARMAX", "ARX", "CARMA", "FIR", "IIR", "RLS"} <= set(ACRONYMS)
    for acronym, words in ACRONYMS.items():
        initials = iter("".join(letter for letter in words if letter.isupper()))
        assert all(letter in initials for letter in acronym), (acronym, words)
