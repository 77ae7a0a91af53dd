"""Nonlinear least squares: Gauss-Newton and Levenberg-Marquardt, exponential fits, position from ranges."""
