"""One line of the table seed item -> function -> step of a notebook -> test."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """One line of "Seed coverage".

    Attributes
    ----------
    seed : str
        "UNSW", "Reading" or "SUSTech".
    item : str
        What the seed asks for.
    functions : tuple of str
        Where the reference computes or draws it, ``module:name``.
    steps : tuple of str
        Cells of the notebooks in which it is done or shown, ``assignment/cell id``.
    tests : tuple of str
        ``file::function``.
    """

    seed: str
    item: str
    functions: tuple[str, ...]
    steps: tuple[str, ...]
    tests: tuple[str, ...]


VARIANT = "tests/autograder/test_variants.py::test_variant"
