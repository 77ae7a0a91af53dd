"""Linear least squares as the lectures teach it, with the matrix appendix."""
