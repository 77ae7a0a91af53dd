"""The catalogue of effects, one class each, grouped by where they enter the loop."""
