"""The effects of the table: one small class each, grouped by the path on which they enter the loop."""
