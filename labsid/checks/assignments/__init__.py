"""One module an assignment: its questions, the right values and the known slips."""
