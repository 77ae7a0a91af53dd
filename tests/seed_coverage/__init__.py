"""The table seed item -> function -> step of a notebook -> test; `test_seed_coverage.py` holds it to the code."""

from seed_coverage import (
    armax_and_instruments,
    least_squares,
    model_structures,
    nonlinear_least_squares,
    recursive_identification,
    unsw,
)
from seed_coverage.row import Row

ROWS: tuple[Row, ...] = (
    *unsw.ROWS,
    *least_squares.ROWS,
    *model_structures.ROWS,
    *recursive_identification.ROWS,
    *armax_and_instruments.ROWS,
    *nonlinear_least_squares.ROWS,
)
