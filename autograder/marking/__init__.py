"""Marking of open questions in the browser."""
