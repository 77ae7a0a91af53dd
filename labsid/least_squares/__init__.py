"""Linear least squares, and the matrix appendix of the lectures."""
