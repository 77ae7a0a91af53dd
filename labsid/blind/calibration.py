"""Fit the probabilities of explanations to the `dev` suite: ``python -m labsid.blind.calibration``.

The diagnosis runs on the `dev` records of the rows below. Every explanation of the beam search is one observation: its
evidence, as the report gives it, and whether it, or one that is as likely, is the whole truth. So is every effect of
every partial explanation. Logistic regressions with a weak ridge give the constants of `labsid.gap.verdict.decision`,
which this module prints and does not import. Evidence that no record shows gets the weight 0; the one of `decision`
then stays.
"""

import argparse
from collections.abc import Iterable, Sequence

import numpy as np
from scipy.optimize import minimize

from labsid._arrays import FloatArray
from labsid.blind.metrics import CaseOutcome
from labsid.blind.runner import run_batch
from labsid.blind.suite import label_dict, make_cases

ROWS = ("single-clear", "single-hard", "short", "pair", "none", "unknown", "partial", "families")
RIDGE = 0.5  # prior precision of every weight
Observation = tuple[dict[str, float], bool]


def complete_observations(cases: Iterable[CaseOutcome]) -> list[Observation]:
    """Evidence for the explanations of the beam search, and whether nothing else acts.

    Parameters
    ----------
    cases : iterable of CaseOutcome
    """
    observed = []
    for case in cases:
        if case.result is not None and case.result.get("verdict") != "error":
            explanation, true = case.result["explanation"], set(case.label["labels"])
            near = {*explanation["names"], *case.result["ambiguous"]}
            right = case.label["row"] != "partial" and (true <= near if true else not explanation["names"])
            observed.append((explanation["evidence"], right))
    return observed


def partial_observations(cases: Iterable[CaseOutcome]) -> list[Observation]:
    """Evidence for each effect of the partial explanations, and whether the rig has it.

    Parameters
    ----------
    cases : iterable of CaseOutcome
    """
    observed = []
    for case in cases:
        if case.result is not None and case.result.get("verdict") == "partial":
            for effect in case.result["effects"]:
                observed.append((effect["evidence"], effect["name"] in case.label["labels"]))
    return observed


def fit_weights(found: Sequence[Observation]) -> tuple[float, dict[str, float]]:
    """Constant and weights of a logistic regression.

    Parameters
    ----------
    found : sequence of (dict, bool)
        From one of the functions above.

    Raises
    ------
    ValueError
        If there are no observations of either outcome.
    """
    if len({right for _, right in found}) < 2:
        raise ValueError(f"both right and wrong answers are needed; got {len(found)} of one kind. Use more records.")
    names = list(found[0][0])
    X = np.array([[1.0, *(evidence[name] for name in names)] for evidence, _ in found])
    sign = np.array([1.0 if right else -1.0 for _, right in found])

    def cost(weights: FloatArray) -> float:
        return float(np.sum(np.logaddexp(0.0, -sign * (X @ weights))) + 0.5 * RIDGE * np.sum(weights[1:] ** 2))

    constant, *weights = minimize(cost, np.zeros(X.shape[1]), method="BFGS").x
    return float(constant), dict(zip(names, map(float, weights), strict=True))


_FITS = (("", "Evidence", complete_observations), ("PARTIAL_", "PartialEvidence", partial_observations))


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the diagnosis on the `dev` records and print the constants."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--per-row", type=int, default=80, help="records of each row")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    chosen = parser.parse_args(arguments)
    cases = list(make_cases("dev", chosen.per_row, ROWS, chosen.jobs))
    results, _ = run_batch(cases, chosen.jobs)
    outcomes = [CaseOutcome(label_dict(case), results.get(case.name)) for case in cases]
    for prefix, kind, observations in _FITS:
        observed = observations(outcomes)
        constant, weights = fit_weights(observed)
        values = ", ".join(f"{name}={weight:.1f}" for name, weight in weights.items())
        print(f"# {len(observed)} observations, {sum(right for _, right in observed)} of them right")
        print(f"{prefix}PRIOR = {constant:.1f}\n{prefix}WEIGHTS = {kind}({values})")


if __name__ == "__main__":
    main()
