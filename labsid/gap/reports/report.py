"""The JSON report (layout ``labsid.gap/4``), from which the text and HTML reports are made."""

from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np
from scipy.special import gammaincc

from labsid._arrays import FloatArray, stretches_of, up_to_next
from labsid.gap.effects.base import Effect, Fitted
from labsid.gap.effects.families import DESCRIPTIONS
from labsid.gap.effects.inside import MISMATCH, place_inside, with_nominal
from labsid.gap.effects.output import Drift
from labsid.gap.fits.fitting import Fit, mean_square, rms
from labsid.gap.fits.log_rounding import log_rounding_error
from labsid.gap.fits.parameter_estimates import estimate_numbers, estimate_parameters, parameters_at_limit
from labsid.gap.fits.residual_tests import input_correlation
from labsid.gap.fits.switching import only_switches
from labsid.gap.limits.smallest_sizes import Limits, find_smallest_sizes
from labsid.gap.model_file import export_model
from labsid.gap.record.controllers import has_controller
from labsid.gap.record.data import Data
from labsid.gap.reports import location
from labsid.gap.reports.experiment import Experiment, next_experiment
from labsid.gap.reports.layout import SCHEMA
from labsid.gap.reports.limit_rows import as_rows
from labsid.gap.reports.pole_rows import linear_dynamics
from labsid.gap.reports.quantities import chance, counted, number, percent
from labsid.gap.reports.share_intervals import share_interval
from labsid.gap.search.explanation import Explanation
from labsid.gap.simulations.baseline import Baseline
from labsid.gap.simulations.simulated_output import OutputModel, SimulatedOutput
from labsid.gap.verdict.answer import Answer
from labsid.gap.verdict.baseline_choice import without_unseen_pole
from labsid.gap.verdict.decision import Decision
from labsid.gap.verdict.scores import closed_share
from labsid.records.record import Record
from labsid.records.signal_quality import lattice_step

LAGS = 20
MIN_LOGGED = 0.3  # of the error left, from which the rounding of the log of the input is mentioned
NOISELESS = 0.9  # rms of the added noise over the error that is left, from which it is nearly all of it
LEAST_SHIFT = 3.0  # standard deviations of the noise, from which the shift of a simulated output is said
COURSE = 80  # points of the time course of a drift
INTERVALS = 8  # rows of the ranking with an interval
SAME_SHARE = 0.005  # of the gap: an interval belongs to the share if it is of the same errors
MIN_FLOOR = 0.5  # rms of the added noise over the error that is left, from which it is said


def build_report(
    record: Record, answer: Answer, base: Baseline, rng: np.random.Generator, holdout: Record | None = None
) -> dict[str, Any]:
    """Assemble the report, in the units of the record.

    Parameters
    ----------
    record : Record
    answer : Answer
    base : Baseline
    rng : Generator
        For the proposed input.
    holdout : Record, optional
        The record on which the gap was scored, if it is another one.

    Returns
    -------
    dict
        JSON-ready, in the layout ``labsid.gap/4``.
    """
    explanation, decision, score, data = answer.explanation, answer.decision, answer.score, answer.explanation.data
    unit = data.y_scale.unit
    numbers = estimate_numbers(explanation.data, explanation.best)
    effects = [effect | _course(record, answer, effect["name"]) for effect in _effects(answer, numbers)]
    t, u, y, e = _located(record, answer, holdout)
    return _holdout(answer, holdout) | {
        "schema": SCHEMA,
        "verdict": decision.verdict,
        "effects": effects,
        "ambiguous": list(decision.ambiguous),
        "ranking": _with_intervals(_ranking(answer), answer, holdout),
        "explanation": {**asdict(answer.complete), "evidence": answer.complete.evidence._asdict()},
        "where": {
            "path": effects[0]["path"] if effects else decision.verdict,
            "time": location.share_by_time(t, e, record.Ts, _acting_samples(answer, t.size)),
            "band_hz": location.share_by_frequency(data.readings(e), data.every * record.Ts),
            "operating": location.most_uneven_signal(u, y, record.Ts, e),
            "map": location.operating_map(u, y, e),
        },
        "gap": {
            "before": score.before * unit,
            "after": score.after * unit,
            "noise_floor": score.floor * unit,
            "mode": "free" if answer.corrected is None else "stabilised",
            "corrected": answer.corrected,
            "closed": score.closed,
            "ci95": None if score.ci95 is None else list(score.ci95),
            "holdout": _stretches(holdout or record, up_to_next(score.scored)),
        },
        "product": decision.product,
        "noise": {
            "sd": float(np.sqrt(np.mean((explanation.data.y - explanation.best.output)[explanation.data.rows] ** 2)))
            * unit,
            "correlation_time": explanation.best.noise.correlation_time * record.Ts,
        },
        "reference": answer.novelty.reference,
        "novelty": {"features": answer.novelty.features, "beyond": list(answer.novelty.beyond)},
        "unexplained": _unexplained(answer),
        "limits": [] if _without_limits(answer, base) else as_rows(record_limits(answer)),
        "next_experiment": None if data.beside else _experiment(record, explanation, decision, rng),
        "record": {"name": record.name, "samples": len(record), "Ts": record.Ts},
        "simulation": {
            "given": base.given,
            "output_only": base.output_only,
            "closed": base.structure.plant.kind == "given" and base.structure.plant.simulation.port is None,
            "output": None if base.output is None else _simulated_output(base.output, base.model),
            "model": _linear_model(answer),
        },
        "dynamics": linear_dynamics(answer, base),
        "numbers": numbers,
        "screen": screen_sentences(explanation),
    }


def _holdout(answer: Answer, holdout: Record | None) -> dict[str, Any]:
    """How many samples of a holdout determine its initial state and are not scored, and how that is estimated."""
    if holdout is None:
        return {}
    state = "refitted" if answer.start.is_refitted(len(holdout)) else "estimated"
    found: dict[str, Any] = {"holdout_unscored": answer.start.samples(len(holdout)), "holdout_state": state}
    if answer.on_other is None:
        return found
    data, before, _ = answer.on_other
    unit = data.y_scale.unit
    gap = {
        "on_record": rms(answer.explanation.data, answer.before) * unit,
        "offset": float(np.mean((data.y - before.output)[data.rows])) * unit,
    }
    return found | {"only_on_holdout": gap}


def _located(
    record: Record, answer: Answer, holdout: Record | None
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Times, input, output and error of the simulation before, where the gap is: on the record, or on the holdout."""
    if answer.on_other is None or holdout is None:
        e = record.y - answer.outputs[0]
        rows = answer.explanation.data.rows  # what the fits exclude, such as an outlier, is no gap of the simulation
        return record.t, record.u, record.y, np.where(rows, e, 0.0)
    data, before, _ = answer.on_other
    e = np.where(data.rows, data.y - before.output, 0.0) * data.y_scale.unit
    first = slice(answer.start.samples(len(holdout)), None)
    return holdout.t[first], holdout.u[first], holdout.y[first], e[first]


def _simulated_output(output: SimulatedOutput, model: OutputModel | None) -> dict[str, Any]:
    """How a simulated output was read: as the linear model that reproduces it, or as it is."""
    opened = None if model is None else {"order": model.order, "dead_time": model.dead_time, "error": model.error}
    return {"resampled": output.resampled, "model": opened}


def _without_limits(answer: Answer, base: Baseline) -> bool:
    """Whether the limits are left out: too many runs of a simulation, or a record that shows a controller only."""
    if answer.explanation.data.beside:
        return True
    return (base.is_run and bool(base.meter.budget)) or (answer.steps.regulated and not answer.decision.names)


def fit_of_limits(answer: Answer) -> Fit:
    """The fit to which effects are added to see what the record could have shown."""
    data, best = answer.explanation.data, answer.explanation.best
    is_linear = answer.linear is not None and best is answer.explanation.path[0]
    return without_unseen_pole(data, best) if is_linear else best


def record_limits(answer: Answer) -> tuple[Limits, ...]:
    """What the record could have shown of each effect; it excludes a size only if nothing but noise is left."""
    data, best = answer.explanation.data, fit_of_limits(answer)
    only_noise = answer.decision.verdict in ("none", "effect") or answer.only_elsewhere
    return find_smallest_sizes(data, best, rms(data, best), only_noise)


def _linear_model(answer: Answer) -> dict[str, Any] | None:
    """How the linear model was fitted; None for a given simulation."""
    linear, unit = answer.linear, answer.explanation.data.y_scale.unit
    if linear is None:
        return None
    errors = {method: error * unit for method, error in linear.errors.items()}
    return {"method": linear.method, "observed": linear.observed, "errors": errors}


def _effects(answer: Answer, numbers: list[dict[str, Any]]) -> list[dict[str, Any]]:
    explanation, decision, closed = answer.explanation, answer.decision, answer.closed
    found = []
    by_name: dict[str, Effect] = {
        e.name: e for e in explanation.best.hypothesis.effects[explanation.best.hypothesis.n_given :]
    }
    for name in sorted(decision.names, key=lambda name: _step(explanation, name)):
        effect = by_name.get(name)
        limits = [] if effect is None else parameters_at_limit(explanation.data, explanation.best, effect)
        found.append(
            place_inside(explanation.best, effect)
            | ({"at_limit": limits} if limits else {})
            | {
                "name": name,
                "path": DESCRIPTIONS[name].path,
                "parameters": with_nominal(
                    explanation.best, estimate_parameters(explanation.data, explanation.best, effect)
                )
                if effect is not None
                else {str(one["name"]): one | {"unit": ""} for one in numbers}
                if name == MISMATCH
                else _sample_parameters(explanation, name),
                "probability": float(decision.probability[name]),
                "chance": chance(decision.probability[name], answer.novelty.reference),
                "closed": closed[_step(explanation, name)],
                "evidence": answer.evidence[name]._asdict() if name in answer.evidence else None,
            }
        )
    return found


def _course(record: Record, answer: Answer, name: str) -> dict[str, Any]:
    """The time course of a drift of the sensor, which its parameters do not tell; empty for other effects."""
    fit, data = answer.explanation.best, answer.explanation.data
    drift = next((effect for effect in fit.hypothesis.effects if isinstance(effect, Drift)), None)
    if name != "output-drift" or drift is None or data.pieces:
        return {}
    at = np.unique(np.linspace(0, data.samples - 1, COURSE).astype(int))
    course = data.y_scale.unit * drift.added(Fitted.of(fit, data))[at]
    return {"course": {"t": record.t[at].tolist(), "y": course.tolist()}}


def _step(explanation: Explanation, name: str) -> int:
    """Step of the path at which an effect is added; the last one for effects found in the samples."""
    for step, fit in enumerate(explanation.path):
        if name in fit.hypothesis.names:
            return step
    return 0 if name == MISMATCH else len(explanation.path) - 1


def _sample_parameters(explanation: Explanation, name: str) -> dict[str, dict[str, Any]]:
    faults, data = explanation.faults, explanation.data
    exact = {"stderr": 0.0}
    if name == "output-dropout":
        return {"share": {"value": float(data.readings(faults.held).mean()), "unit": "1", **exact}}
    if name == "output-outliers":
        return {"share": {"value": float(data.readings(faults.spikes).mean()), "unit": "1", **exact}}
    if name == "output-quantization":
        return {"step": {"value": float(faults.lattice or 0.0) * data.y_scale.unit, "unit": "y", **exact}}
    if name == "coloured-noise":
        e = (data.y - explanation.best.output)[data.rows]
        amplitude = float(np.sqrt(max(np.mean(e**2) - explanation.best.noise.sigma2, 0.0))) * data.y_scale.unit
        pole = explanation.best.noise.pole
        n = e.size
        return {
            "amplitude": {
                "value": amplitude,
                "stderr": amplitude / np.sqrt(2.0 * n * max(1.0 - pole, 1e-3)),
                "unit": "y",
            },
            "pole": {"value": pole, "stderr": float(np.sqrt(max(1.0 - pole**2, 0.0) / n)), "unit": "1"},
        }
    return {}


def _ranking(answer: Answer) -> list[dict[str, Any]]:
    """Every combination tried, best first: by the free-run error if that decided, else by probability and BIC."""
    explanation, decision, unit = answer.explanation, answer.decision, answer.explanation.data.y_scale.unit
    if decision.verdict in ("partial", "unknown"):
        start, floor = answer.score.before**2, answer.score.floor**2
        rows = [
            {
                "name": "+".join(names),
                "probability": decision.weights.get(names, 0.0),
                "rmse": float(np.sqrt(mse)) * unit,
                "closed": closed_share(start, mse, floor),
            }
            for names, mse in answer.tried.items()
        ]
        accepted = "+".join(sorted(set(decision.names) - {MISMATCH}))
        return sorted(rows, key=lambda row: (row["name"] != accepted, row["rmse"]))
    start, floor = mean_square(explanation.data, answer.before), float(explanation.best.noise.sigma2)
    fits = [(names, fit) for level in explanation.levels[1:] for names, fit in level.items()]
    ordered = sorted(fits, key=lambda item: (-decision.weights.get(item[0], 0.0), item[1].bic))
    return [
        {
            "name": "+".join(names),
            "probability": decision.weights.get(names, 0.0),
            "rmse": rms(explanation.data, fit) * unit,
            "closed": closed_share(start, mean_square(explanation.data, fit), floor),
            "bic": fit.bic - explanation.path[0].bic,
        }
        for names, fit in ordered
    ]


def _with_intervals(rows: list[dict[str, Any]], answer: Answer, holdout: Record | None) -> list[dict[str, Any]]:
    """The first rows of the ranking with 95 % intervals of the closed shares; None where they cannot be computed."""
    compared = _compared_errors(answer, holdout)
    if compared is None:
        return rows
    before, after, floor = compared
    found = []
    for row in rows[:INTERVALS]:
        fit = answer.fits.get(tuple(sorted(row["name"].split("+"))))
        if fit is not None and row["closed"] is not None:
            e = after(fit)
            mean = closed_share(float(np.mean(before**2)), float(np.mean(e**2)), floor)
            same = mean is not None and abs(mean - row["closed"]) < SAME_SHARE
            row = row | {"ci95": share_interval(before, e, floor) if same else None}
        found.append(row)
    return [*found, *rows[INTERVALS:]]


def _compared_errors(
    answer: Answer, holdout: Record | None
) -> tuple[FloatArray, Callable[[Fit], FloatArray], float] | None:
    """Errors of the simulation before, those of any fit, and the noise, on the samples of the ranking.

    None for several records, each of which is simulated by fits to the others, and where a given simulation would have
    to run again.
    """
    data, scored = answer.explanation.data, answer.score.scored
    if answer.decision.verdict not in ("partial", "unknown"):
        rows = data.rows
        floor = float(answer.explanation.best.noise.sigma2)
        return (data.y - answer.before.output)[rows], lambda fit: (data.y - fit.output)[rows], floor
    if data.pieces:
        return None
    if holdout is None:
        y, output = data.y, answer.score.outputs[0]
        return (y - output)[scored], lambda fit: (y - fit.output)[scored], answer.score.floor**2
    if answer.explanation.best.hypothesis.plant.kind == "given":
        return None
    y, unit = data.y_scale.of(holdout.y), data.y_scale

    def error(fit: Fit) -> FloatArray:
        model = export_model(data, fit, start=answer.start)
        return np.asarray((y - unit.of(model.simulate(holdout.u, holdout.y)))[scored])

    return (y - answer.score.outputs[0])[scored], error, answer.score.floor**2


def _acting_samples(answer: Answer, samples: int) -> np.ndarray:
    """Samples on which the first effect acts that is confined to a part of the record; none of a holdout."""
    explanation, decision = answer.explanation, answer.decision
    if answer.only_elsewhere:
        return np.zeros(samples, bool)
    fit = explanation.best
    for effect in fit.hypothesis.effects[fit.hypothesis.n_given :]:
        at = effect.active_samples(Fitted.of(fit, explanation.data))
        if effect.name in decision.names and at.any() and not at.all():
            return at
    if "output-dropout" in decision.names:
        return explanation.faults.held
    if "output-outliers" in decision.names:
        return explanation.faults.spikes
    return np.zeros(explanation.data.samples, bool)


def _stretches(record: Record, scored: np.ndarray) -> list[list[float]]:
    return [[float(record.t[a]), float(record.t[b - 1] + record.Ts)] for a, b in stretches_of(scored)]


def _unexplained(answer: Answer) -> dict[str, Any]:
    left, remaining = answer.left, answer.remaining
    data, fit = answer.explanation.data, answer.explanation.best
    if answer.on_other is not None:
        data, _, fit = answer.on_other
    e = np.where(data.rows, data.y - fit.output, 0.0)
    return {
        "share": answer.share_left,
        "whiteness_p": _whiteness(e, data),
        "input_correlation_p": input_correlation(data, fit, e),
        "path": None if remaining is None else remaining.path,
        "kinds": None if remaining is None else remaining.kinds,
        "rms": (answer.score.after if answer.tried else left.rms) * data.y_scale.unit,
        "colour": left.colour,
        "repeats": left.repeats,
    }


def _whiteness(e: FloatArray, data: Data) -> float:
    """P-value of a test of the autocorrelation of the residual, whose size may vary along the record.

    The products of each lag are over their own squares, as for noise that is white and not of one size; for noise of
    one size this is the test of Box and Pierce (Lobato, Nankervis and Savin, 2001, "Testing for autocorrelation using a
    modified Box-Pierce Q test", International Economic Review 42).
    """
    x = data.readings(e - e[data.rows].mean() * data.rows)
    products = [x[lag:] * x[:-lag] for lag in range(1, LAGS + 1)]
    squares = np.array([one @ one for one in products])
    sums = np.array([one.sum() for one in products])
    return float(gammaincc(LAGS / 2.0, 0.5 * np.sum(sums**2 / np.where(squares > 0.0, squares, np.inf))))


def _experiment(
    record: Record, explanation: Explanation, decision: Decision, rng: np.random.Generator
) -> dict[str, Any] | None:
    """The input that best distinguishes the accepted explanation from its best rival, if there is one."""
    count = len(explanation.best.hypothesis.names)
    if not decision.ambiguous or not 0 < count < len(explanation.levels):
        return None
    level = explanation.levels[count]
    accepted = set(explanation.best.hypothesis.names)
    rivals = [fit for names, fit in level.items() if set(names) != accepted and set(names) & set(decision.ambiguous)]
    if not rivals:
        return None
    rival = min(rivals, key=lambda fit: fit.bic)
    found: Experiment | None = next_experiment(explanation.data, explanation.best, rival, rng)
    if found is None:
        return None
    return {
        "separates": list(found.separates),
        "why": f"On {found.why}, {found.separates[1]} cannot reproduce the response of {found.separates[0]}.",
        "t": (np.arange(found.u.size) * record.Ts).tolist(),
        "u": found.u.tolist(),
        "margin": found.margin,
    }


def about_shift(base: Baseline, answer: Answer) -> list[str]:
    """That the level of a simulated output is not that of the record, in a sentence; none for models of deviations."""
    before, data = answer.before, answer.explanation.data
    unit = data.y_scale.unit
    closed = before.hypothesis.plant.kind == "given" and before.hypothesis.plant.simulation.port is None
    if not (base.output is not None or base.is_run) or not closed or not before.gains.size:
        return []
    as_given = before.hypothesis.plant.simulation.run(data.u, {})
    shift = float(np.mean((before.output - as_given)[data.rows])) * unit
    if abs(shift) < LEAST_SHIFT * answer.score.floor * unit:
        return []
    return [
        f"The output of your simulation is on average {number(abs(shift))} {'above' if shift < 0.0 else 'below'} that "
        "of the record. It was shifted to it: a zero of the sensor is no part of the gap."
    ]


def screen_sentences(explanation: Explanation) -> list[str]:
    """Faults found in the samples, and a response without delay, in sentences."""
    faults = explanation.faults
    texts = []
    if explanation.path[0].hypothesis.plant.feedthrough:
        loop = " In a loop, a controller without delay has the same effect."
        texts.append(
            "The linear model has a direct feedthrough: it responds within the sample in which the input changes."
            + loop * has_controller(*explanation.data.sampled)
        )
    logged = float(np.sqrt(log_rounding_error(explanation.data, explanation.best)))
    if logged > MIN_LOGGED * rms(explanation.data, explanation.best):
        step = lattice_step(explanation.data.u) or 0.0
        texts.append(
            f"The input is logged in steps of {step * explanation.data.u_scale.unit:.4g}. If finer values acted, that "
            f"leaves an error of about {number(logged * explanation.data.y_scale.unit)} rms, which is no gap."
        )
    if explanation.floor > MIN_FLOOR * rms(explanation.data, explanation.best):
        added = number(explanation.floor * explanation.data.y_scale.unit)
        own = explanation.floor < NOISELESS * rms(explanation.data, explanation.best)
        texts.append(
            f"{'' if own else 'The record has hardly any noise of its own. '}White noise of {added} rms, below which "
            "printed digits and simulators may leave anything, was added to the output, and is part of all errors."
        )
    if only_switches(explanation.data, explanation.best):
        texts.append(
            "As fitted, the actuator only switches between two values, as a relay or an on/off controller does. Two "
            "values do not show the shape of a limit or a curve."
        )
    if faults.lattice is not None:
        texts.append(
            f"All output values are multiples of one step of {faults.lattice * explanation.data.y_scale.unit:.4g}."
        )
    if faults.stretches:
        share, places = (
            percent(float(explanation.data.readings(faults.held).mean())),
            counted(len(faults.stretches), "stretch", "stretches"),
        )
        texts.append(f"The output repeats its last value in {places}, {share} of the record.")
    spikes = int(faults.spikes.sum())
    if spikes == 1:
        texts.append("1 sample is an outlier; the fits exclude it.")
    elif spikes:
        texts.append(f"{spikes} samples are outliers; the fits exclude them.")
    return texts
