"""Tries in rows: of one question or of several, with the changes of the model solution or with the code."""

from tries import ACCEPTED, TAUGHT, Try, edited


def in_rows(*rows: tuple[str, str, str, tuple[tuple[str, str], ...] | str]) -> tuple[Try, ...]:
    """Tries from rows of question, name, what the message says, and the changes of the model solution or the code.

    Where nothing is said, the answer is acceptable.
    """
    return tuple(
        Try(
            question,
            name,
            code if isinstance(code, str) else edited(question, *code),
            says,
            TAUGHT if says else ACCEPTED,
        )
        for question, name, says, code in rows
    )


TO_Y = "is right, with the rows of k = .*What is wrong is"
