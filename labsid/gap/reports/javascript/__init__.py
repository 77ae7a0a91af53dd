"""Fitted simulations in JavaScript, for pages that can be operated: translated from the Python source."""
