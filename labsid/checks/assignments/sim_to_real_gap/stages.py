"""Hints."""

STAGES = {}
