"""The assignments in the order in which they are taught, with the time that a student needs for each."""

HOURS = {
    "prelab-sinusoids": 1.0,
    "lab-identification": 3.0,
    "postlab-model-order": 1.25,
    "step-response": 2.0,
    "least-squares": 3.0,
    "model-structures": 3.25,
    "recursive-identification": 2.75,
    "armax-and-instruments": 2.75,
    "nonlinear-least-squares": 2.75,
    "sim-to-real-gap": 3.0,
    "several-signals": 1.5,
}
"""Hours for each assignment, estimated from the length of its text and the number of its questions."""


def in_course_order(assignment: str) -> tuple[int, str]:
    """Sort key for the order in which assignments are taught."""
    order = list(HOURS)
    return (order.index(assignment) if assignment in order else len(order), assignment)
