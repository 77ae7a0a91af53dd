"""What was replaced for an answer in the second run, in words for the student."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from autograder.judge.answer import Answer, wrong_steps


@dataclass(frozen=True, slots=True)
class Replaced:
    """Right values and functions that an answer was judged with.

    Attributes
    ----------
    causes : tuple of str
        Ids of the wrong questions that the answer starts from.
    steps : tuple of str
        Ids of the questions whose values were replaced.
    functions : tuple of str
        Names of the functions that were replaced.
    called : bool
        Whether the answer itself calls these functions.
    """

    causes: tuple[str, ...]
    steps: tuple[str, ...]
    functions: tuple[str, ...]
    called: bool

    def beside_right(self) -> str:
        """The note after the reason of a right answer."""
        notes = []
        if self.functions:
            one = len(self.functions) == 1
            verb, are = "calls" if self.called else "depends on", "is" if one else "are"
            place = "a right one in its place" if one else "right ones in their place"
            notes.append(f"(This {verb} your {self._names}, which {are} wrong: it was judged with {place}.)")
        if self.steps:
            notes.append(f"(Judged {self._values}.)")
        return " ".join(notes)

    def before_wrong(self) -> str:
        """The note before the reason of a wrong answer."""
        functions = f"with a right {self._names} in place of yours" if self.functions else ""
        return f"Judged {' and '.join(filter(None, (self._values, functions)))}:"

    @property
    def _names(self) -> str:
        return " and ".join(f"`{name}`" for name in self.functions)

    @property
    def _values(self) -> str:
        return f"on the right values of {', '.join(self.steps)}" if self.steps else ""


def replaced_for(answer: Answer, wrong: Sequence[Answer], functions_of: Callable[[Answer], Sequence[str]]) -> Replaced:
    """What an answer was judged with in the second run.

    Parameters
    ----------
    answer : Answer
    wrong : sequence of Answer
        The earlier answers that were replaced, or follow from such ones.
    functions_of : callable
        Names of the functions that an answer should define.
    """
    direct = [
        earlier
        for earlier in wrong
        if earlier.question.id in answer.question.uses
        or any(map(answer.reads, (*earlier.right, *functions_of(earlier))))
    ]
    causes = wrong_steps(direct or wrong)
    steps: list[str] = []
    functions: list[str] = []
    for earlier in (earlier for earlier in wrong if earlier.question.id in causes):
        called = list(filter(answer.reads, functions_of(earlier)))
        if called or not earlier.right:
            functions += called or list(filter(earlier.reads, functions_of(earlier))) or functions_of(earlier)
        else:
            steps.append(earlier.question.id)
    return Replaced(causes, tuple(steps), tuple(functions), all(map(answer.reads, functions)))
