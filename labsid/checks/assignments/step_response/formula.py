"""Check of step 2 of the appendix: the student's formula for the response of a first-order model with delay."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import as_vector, close
from labsid.checks.double_mistakes import Edit, pairs_of
from labsid.checks.question import Ask, returned
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, first_failure, judge
from labsid.lab.step_response import FirstOrderDelay, first_order_response


@first_failure
def check_response(ask: Ask) -> Iterator[Verdict]:
    """Step 2: first_order_response on other models."""
    for sign, is_delayed in ((1, True), (-1, True), (1, False)):
        Ts = float(ask.rng.choice([0.1, 0.25, 0.5]))
        t: FloatArray = Ts * np.arange(ask.rng.integers(140, 180), dtype=np.float64)
        td = float(t[ask.rng.integers(12, 30)]) if is_delayed else 0.0
        K, tau = float(ask.rng.uniform(0.4, 5)), float(Ts * ask.rng.uniform(15, 40))
        amplitude = sign * float(ask.rng.uniform(1.5, 4))
        value = returned(ask, "first_order_response", t, K, tau, td, amplitude)
        model = FirstOrderDelay(K, tau, td)
        _require_no_fixed_step(value, t, model, amplitude)
        got = as_vector("first_order_response(...)", value, t.size)
        yield judge(
            got,
            first_order_response(model, t, amplitude),
            close(1e-6),
            "zero up to the delay, then rising to K times the amplitude.",
            f"`first_order_response` does not follow the formula of step 1. {_seen(t, got, model, amplitude)}",
            [*response_slips("`first_order_response`", t, model, amplitude), *_two_slips(t, model, amplitude)],
        )


def _require_no_fixed_step(value: Value, t: FloatArray, model: FirstOrderDelay, amplitude: float) -> None:
    """Refuse a response shifted by a number of samples that is right for another sampling time only."""
    if not isinstance(value, np.ndarray) or value.ndim != 1 or value.dtype.kind != "f" or not np.any(value):
        return
    samples, Ts = int(np.argmax(value != 0)) - 1, float(t[1] - t[0])
    if model.td == 0 or samples < 1 or samples == round(model.td / Ts) or samples in (int(model.td), round(model.td)):
        return
    at_once = first_order_response(FirstOrderDelay(model.K, model.tau, 0.0), t, amplitude)
    shifted = value[samples:]
    if 1 < shifted.size <= t.size and close(1e-6)(shifted, at_once[: shifted.size]):
        long = "" if value.size == t.size else f" (It returns {value.size} values for {t.size} times.)"
        raise NoAnswer(
            f"`first_order_response` begins {samples} samples late for td = {model.td:g} s. That is right where "
            f"samples are {model.td / samples:.3g} s apart, and those of `t` are {Ts:g} s apart here: take the delay "
            f"off the times, t - td.{long}",
            "sampling time fixed",
        )


def _seen(t: FloatArray, got: FloatArray, model: FirstOrderDelay, amplitude: float) -> str:
    """Where the student's response differs from one of this kind: before the delay, at the end, or in between."""
    size = model.K * amplitude
    before = got[t < model.td]
    if before.size and np.max(np.abs(before)) > 1e-6 * abs(size):
        risen = t[np.argmax(np.abs(got) > 1e-6 * abs(size))]
        return f"Before td, here {model.td:g} s, it is not zero: it is {np.interp(risen, t, got):.3g} at {risen:g} s."
    if abs(got[-1] - size * (1 - np.exp(-(t[-1] - model.td) / model.tau))) > 0.02 * abs(size):
        return f"At the end it is {got[-1] / size:.2g} times K times the amplitude, and should have reached that."
    return "Before td and at the end it is right, in between it is not: look at the exponent."


def _two_slips(t: FloatArray, model: FirstOrderDelay, amplitude: float) -> Iterator[Slip[FloatArray]]:
    """Two mistakes in the formula at once."""
    K, tau, td = model.K, model.tau, model.td
    since = np.maximum(t - td, 0)

    def made(
        gain: float = K,
        size: float = amplitude,
        time: FloatArray = since,
        rate: float = -1 / tau,
        one: float = 1.0,
        from_td: bool = False,
    ) -> FloatArray:
        response = gain * size * (one - (1 if one else -1) * np.exp(time * rate))
        return np.where(t >= td, response, 0.0) if from_td else response

    edits = (
        Edit("gain", 1.0, "it does not depend on K"),
        Edit("size", 1.0, "it does not depend on the amplitude"),
        Edit("time", t, "the time in the exponent is t, and not t - td"),
        Edit("time", t - td, "it is not zero before td"),
        Edit("time", t + td, "the time in the exponent is t + td, and not t - td"),
        *(
            Edit("time", np.maximum(t - samples * (t[1] - t[0]), 0), "td is taken for a number of samples: it is in s")
            for samples in {int(td), round(td)}
        ),
        Edit("rate", 1 / tau, "the exponent has no minus, so that it grows without limit"),
        Edit("rate", -tau, "the exponent is multiplied by tau, and not divided by it"),
        Edit("rate", -1.0, "tau is missing in the exponent"),
        Edit("one", 0.0, "it falls: 1 minus the exponential rises"),
    )
    yield from pairs_of("`first_order_response`", edits, made)
    yield from pairs_of("`first_order_response`", edits, partial(made, from_td=True))


def response_slips(what: str, t: FloatArray, model: FirstOrderDelay, amplitude: float) -> list[Slip[FloatArray]]:
    """Mistakes in the formula of the response; `what` is what the sentences begin with."""
    K, tau, td = model.K, model.tau, model.td
    Ts, size = t[1] - t[0], K * amplitude

    def slip(name: str, hint: str, wrong: FloatArray) -> Slip[FloatArray]:
        return Slip(name, f"{what} {hint}", lambda: wrong)

    since = np.maximum(t - td, 0)
    no_delay = "starts at once, without the delay td: use t - td instead of t, and return zero before td."
    return [
        slip(
            "not zero before the delay",
            "is not zero before td: the formula alone gives large values of the other sign there.",
            size * (1 - np.exp(-(t - td) / tau)),
        ),
        slip(
            "amplitude forgotten", "does not depend on the amplitude: multiply by it.", K * (1 - np.exp(-since / tau))
        ),
        slip(
            "amplitude of 2 assumed",
            "always uses the amplitude 2: use the argument `amplitude`.",
            2 * K * (1 - np.exp(-since / tau)),
        ),
        slip("gain forgotten", "does not depend on K: multiply by it.", amplitude * (1 - np.exp(-since / tau))),
        slip("no delay", no_delay, size * (1 - np.exp(-t / tau))),
        slip(
            "delay cut but not shifted",
            "is zero before td, but then jumps: the exponent needs t - td as well.",
            np.where(t >= td, size * (1 - np.exp(-t / tau)), 0),
        ),
        slip("decays", "falls where it should rise: use 1 minus the exponential.", size * np.exp(-since / tau)),
        slip(
            "decays",
            "falls where it should rise: use 1 minus the exponential.",
            np.where(t >= td, size * np.exp(-(t - td) / tau), 0),
        ),
        slip(
            "multiplied by the time constant",
            "multiplies by tau in the exponent: divide by it.",
            size * (1 - np.exp(-since * tau)),
        ),
        slip(
            "brackets forgotten",
            "divides e^... by tau, not its exponent: that is -(t - td)/tau, as a whole.",
            size * (1 - np.exp(-since) / tau),
        ),
        slip(
            "sign of the exponent",
            "grows without limit: the exponent is negative.",
            size * (1 - np.exp(since / tau)),
        ),
        slip(
            "impulse response",
            "is the response to an impulse, the derivative of what is asked: a step gives K a (1 - e^...).",
            size / tau * np.exp(-since / tau) * (t >= td),
        ),
        slip(
            "ramp for the rise",
            "rises along a straight line and stops: the rise is 1 minus the exponential.",
            size * np.minimum(since / tau, 1),
        ),
        slip(
            "delay added to the time constant",
            "has tau + td in the exponent: the delay is taken off the time, t - td.",
            size * (1 - np.exp(-t / (tau + td))),
        ),
        slip(
            "no time constant",
            "does not use tau: divide the time in the exponent by it.",
            size * (1 - np.exp(-since)),
        ),
        slip(
            "jump",
            "jumps to its end at once: multiply by 1 minus the exponential.",
            np.where(t >= td, size, 0.0),
        ),
        *(
            slip(
                "delay in samples",
                "uses td as a number of samples; it is in seconds.",
                first_order_response(FirstOrderDelay(K, tau, Ts * samples), t, amplitude),
            )
            for samples in {int(td), round(td)}
        ),
        slip(
            "delay with the wrong sign",
            "starts before the step: the time since the delay is t - td.",
            size * (1 - np.exp(-(t + td) / tau)),
        ),
    ]
