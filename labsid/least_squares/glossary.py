"""The function table of the Reading notes, in MATLAB and numpy, and their acronyms."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Function:
    """One row of the function table.

    Attributes
    ----------
    matlab : str
        The expression in MATLAB.
    python : str
        The equivalent with ``import numpy as np``, for arrays A, B and the order n.
    meaning : str
    """

    matlab: str
    python: str
    meaning: str


# Errata: the notes print svg(A) for svd(A), and the pseudo-inverse as (A A')^-1 A'.
FUNCTIONS = (
    Function("A*B", "A @ B", "matrix product (A * B in numpy multiplies entry by entry)"),
    Function("A+B", "A + B", "matrix sum"),
    Function("A\\B", "np.linalg.lstsq(A, B)[0]", "left division: solve A X = B, by least squares if A is tall"),
    Function("A/B", "np.linalg.lstsq(B.T, A.T)[0].T", "right division: solve X B = A"),
    Function("A'", "A.T", "transpose"),
    Function("eye(n)", "np.eye(n)", "identity matrix of size n"),
    Function("svd(A)", "np.linalg.svd(A)", "singular value decomposition; numpy returns V' and not V"),
    Function("eig(A)", "np.linalg.eig(A)", "eigenvalues and eigenvectors"),
    Function("rank(A)", "np.linalg.matrix_rank(A)", "number of independent rows or columns"),
    Function("cond(A)", "np.linalg.cond(A)", "condition number: largest over smallest singular value"),
    Function("det(A)", "np.linalg.det(A)", "determinant"),
    Function("inv(A)", "np.linalg.inv(A)", "inverse"),
    Function("pinv(A)", "np.linalg.pinv(A)", "pseudo-inverse, (A'A)^-1 A' for full column rank"),
    Function(
        "adjoint(A)", "labsid.least_squares.matrix_inverse.adjoint(A)", "adjoint (adjugate): |A| times the inverse"
    ),
)

ACRONYMS = {
    "AR": "AutoRegressive",
    "ARIMA": "AutoRegressive Integrated Moving Average",
    "ARMA": "AutoRegressive Moving Average",
    "ARMAX": "AutoRegressive Moving Average with eXogenous input",
    "ARX": "AutoRegressive with eXogenous input",
    "CARMA": "Controlled AutoRegressive Moving Average (another name for ARMAX)",
    "FIR": "Finite Impulse Response",
    "IIR": "Infinite Impulse Response",
    "IV": "Instrumental Variable",
    "LS": "Least Squares",
    "MA": "Moving Average",
    "PRBS": "Pseudo-Random Binary Signal",
    "RELS": "Recursive Extended Least Squares",
    "RLS": "Recursive Least Squares",
    "SSE": "Sum of Squared Errors",
    "SVD": "Singular Value Decomposition",
}
