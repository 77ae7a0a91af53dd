"""Gates of a verdict: what is compared with which constant, and what follows."""

from dataclasses import dataclass
from types import ModuleType


@dataclass(frozen=True, slots=True)
class Threshold:
    """A constant that decides.

    Attributes
    ----------
    value : float
    place : str
        Module within `labsid/gap`, and name: ``verdict/decision.MIN_CONFIDENCE``.
    """

    value: float
    place: str


@dataclass(frozen=True, slots=True)
class Gate:
    """One condition of the verdict.

    Attributes
    ----------
    name : str
        What is compared.
    value : float
    relation : str
        What passes: ``">"``, ``">="``, ``"<"`` or ``"<="`` the threshold.
    threshold : Threshold
    meaning : str
        What follows from its result.
    """

    name: str
    value: float
    relation: str
    threshold: Threshold
    meaning: str

    @property
    def passed(self) -> bool:
        """Whether the value satisfies the condition."""
        limit = self.threshold.value
        passes = {
            ">": self.value > limit,
            ">=": self.value >= limit,
            "<": self.value < limit,
            "<=": self.value <= limit,
        }
        return passes[self.relation]


@dataclass(frozen=True, slots=True)
class Probability:
    """A probability as the logistic function of a sum of evidence times weight.

    Attributes
    ----------
    of : str
        Name of the effect, or ``""`` for the explanation as a whole.
    value : float
        By this evidence alone; a gate says where a rule replaces it.
    prior : Threshold
        Constant of the sum.
    weights : str
        Place of the weights.
    terms : tuple of (str, float, float)
        Measure of evidence, its value, and its weight.
    """

    of: str
    value: float
    prior: Threshold
    weights: str
    terms: tuple[tuple[str, float, float], ...]

    @property
    def total(self) -> float:
        """The sum."""
        return self.prior.value + sum(value * weight for _, value, weight in self.terms)


@dataclass(frozen=True, slots=True)
class NotTaken:
    """A combination of effects that was tried and not taken.

    Attributes
    ----------
    names : tuple of str
    figures : tuple of float
        As the columns of its stage say; nan if not computed.
    reason : str
    """

    names: tuple[str, ...]
    figures: tuple[float, ...]
    reason: str


@dataclass(frozen=True, slots=True)
class Stage:
    """One question of the decision, with what answers it.

    Attributes
    ----------
    question : str
    gates : tuple of Gate
    result : str
        The answer.
    probabilities : tuple of Probability
    columns : tuple of str
        Titles of the figures of `not_taken`.
    not_taken : tuple of NotTaken
        Best first.
    """

    question: str
    gates: tuple[Gate, ...]
    result: str
    probabilities: tuple[Probability, ...] = ()
    columns: tuple[str, ...] = ()
    not_taken: tuple[NotTaken, ...] = ()


@dataclass(frozen=True, slots=True)
class Why:
    """Why a verdict is what it is.

    Attributes
    ----------
    verdict : str
    names : tuple of str
        The effects that are named.
    stages : tuple of Stage
        In the order in which they were decided.
    """

    verdict: str
    names: tuple[str, ...]
    stages: tuple[Stage, ...]


def threshold_of(module: ModuleType, name: str, place: int | None = None) -> Threshold:
    """A constant of a module of `labsid.gap`, or one of a tuple of them."""
    value = getattr(module, name)
    where = module.__name__.removeprefix("labsid.gap.").replace(".", "/")
    index = "" if place is None else f"[{place}]"
    return Threshold(float(value if place is None else value[place]), f"{where}.{name}{index}")
