"""The table seed item -> function -> step of a notebook -> test; `test_seed_coverage.py` holds it to the code."""

from seed_coverage import least_squares, unsw
from seed_coverage.row import Row

ROWS: tuple[Row, ...] = (*unsw.ROWS, *least_squares.ROWS)
