"""Rigs whose unmodelled effects can be switched on one by one, at any strength."""
