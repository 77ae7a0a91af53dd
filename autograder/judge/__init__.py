"""Judging one submission: ask its process for values, compare them with labsid."""
