"""ARX to ARMAX: polynomials in the shift operator, prediction, model order, residual tests, input signals."""
