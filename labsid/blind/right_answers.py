"""Whether the answer on a record is right, by the rule of its row."""

from collections.abc import Callable

from labsid.blind.honest import LIKELY, has_no_report, is_accepted, wrong_names
from labsid.blind.joints import names_the_cause
from labsid.blind.metrics import CaseOutcome, all_named, kind_recognised, nothing_asserted, right_part_named
from labsid.blind.placed_effects import names_effect, names_effect_and_signal
from labsid.blind.several import names_only_true


def is_silent_or_right(case: CaseOutcome) -> bool:
    """Whether there is a report without a wrong name above 0.5; nothing needs to be named."""
    return not has_no_report(case) and not wrong_names(case, LIKELY)


_RULES: dict[str, Callable[[CaseOutcome], bool]] = {
    "unknown": nothing_asserted,
    "partial": right_part_named,
    "with-sim": kind_recognised,
    "honest": is_accepted,
    "faint": is_silent_or_right,
    "joints": names_the_cause,
    "several": names_only_true,
    "signals": names_effect_and_signal,
    "signals-hard": names_effect_and_signal,
    "signals-none": names_effect,
    "loop": names_effect,
}


def is_right(case: CaseOutcome) -> bool:
    """Whether the answer is right; exactly the true effects, where the row has no rule of its own.

    Parameters
    ----------
    case : CaseOutcome
    """
    return _RULES.get(case.label["row"], all_named)(case)
