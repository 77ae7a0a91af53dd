"""One package per assignment: its questions, the right values and the known mistakes."""
