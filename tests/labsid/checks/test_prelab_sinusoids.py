"""The pre-lab's checks in the notebook, and how surely they tell right noise from wrong."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from labsid._arrays import FloatArray
from labsid.checks.assignments.prelab_sinusoids import ASSIGNMENT
from labsid.checks.assignments.prelab_sinusoids.noise_statistics import (
    require_independent,
    require_uniform,
    require_wave,
)
from labsid.checks.verdict import NoAnswer
from labsid.lab.sinusoid import make_sinusoids

NAME = "prelab-sinusoids"
QUESTIONS = [question.id for question in ASSIGNMENT.questions]
T = np.linspace(0, 100, 1001)
SINE = np.sin(0.02 * np.pi * T)
Noise = Callable[[np.random.Generator], FloatArray]


def refusal(check: Callable[..., None], *arguments: object) -> NoAnswer:
    with pytest.raises(NoAnswer) as caught:
        check(*arguments)
    return caught.value


def test_the_solution_passes(shipped_record_path: Path, run_notebook) -> None:
    assert run_notebook(NAME, shipped_record_path) == dict.fromkeys(QUESTIONS, "")


def test_every_check_of_an_empty_release_fails_kindly(shipped_record_path: Path, run_notebook) -> None:
    said = run_notebook(NAME, shipped_record_path, release=True)
    assert list(said) == QUESTIONS
    for question, text in said.items():
        assert re.match(rf"{question}:", text), text
        assert "Error" not in text


@pytest.mark.parametrize("seed", range(300))
def test_right_noise_is_never_refused(seed: int) -> None:
    made = make_sinusoids(np.random.default_rng(seed))
    noises = {}
    for name, y, wave, other in (("y1", made.y1, np.sin, np.cos), ("y2", made.y2, np.cos, np.sin)):
        require_wave(name, T, y.ravel(), wave, other)
        noises[name] = y.ravel() - wave(0.02 * np.pi * T)
        require_uniform(name, noises[name], wave(0.02 * np.pi * T))
    require_independent(noises)


@pytest.mark.parametrize(
    ("noise", "slip"),
    [
        (lambda rng: rng.uniform(0, 0.2, T.size), "one-sided noise"),
        (lambda rng: rng.uniform(-0.2, 0, T.size), "one-sided noise"),
        (lambda rng: rng.uniform(0, 0.4, T.size), "noise not centred"),
        (lambda rng: rng.uniform(-0.1, 0.1, T.size), "noise of half the bound"),
        (lambda rng: rng.uniform(-0.4, 0.4, T.size), "noise of twice the bound"),
        (lambda rng: rng.random(T.size), "noise straight from rand"),
        (lambda rng: rng.random(T.size) - 0.5, "noise shifted but not scaled"),
        (lambda rng: rng.random(T.size) - 0.2, "noise shifted but not scaled"),
        (lambda rng: 0.2 * rng.standard_normal(T.size), "Gaussian noise"),
        (lambda rng: 0.1 * rng.standard_normal(T.size), "Gaussian noise"),
        (lambda rng: 0.2 / np.sqrt(3) * rng.standard_normal(T.size), "Gaussian noise"),
        (lambda rng: np.clip(0.1155 * rng.standard_normal(T.size), -0.2, 0.2), "noise clipped at the bound"),
        (lambda rng: rng.uniform(-0.18, 0.18, T.size), None),
        (lambda rng: rng.uniform(-0.22, 0.22, T.size), None),
        (lambda rng: SINE * rng.uniform(-0.2, 0.2, T.size), "noise multiplied"),
        (lambda rng: np.zeros(T.size), "no noise"),
        (lambda rng: np.full(T.size, rng.uniform(-0.2, 0.2)), "one random number for all samples"),
    ],
)
def test_wrong_noise_is_always_refused_and_named(noise: Noise, slip: str | None) -> None:
    for seed in range(100):
        assert refusal(require_uniform, "y1", noise(np.random.default_rng(seed)), SINE).slip == slip


@pytest.mark.parametrize(
    ("angle", "slip"),
    [
        (0.04 * np.pi * T, "period of 50 s"),
        (0.01 * np.pi * T, "period of 200 s"),
        (3.6 * T, "degrees instead of radians"),
        (np.deg2rad(0.02 * np.pi * T), "degrees instead of radians"),
        (0.02 * T, "pi forgotten"),
        (T / 100, "two pi forgotten"),
        (T, "period of 2 pi seconds"),
        (200 * np.pi * T, "frequency in place of the period"),
        (0.2 * np.pi * T, "sample number in place of time"),
        (0.02 * np.pi * T + np.pi / 2, "sine and cosine swapped"),
        (0.02 * np.pi * T + 1, None),
    ],
)
@pytest.mark.parametrize("bound", [0.2, 0.4])
def test_a_wrong_sine_is_named_even_under_wrong_noise(angle: FloatArray, slip: str | None, bound: float) -> None:
    y = np.sin(angle) + np.random.default_rng(3).uniform(-bound, bound, T.size)
    assert refusal(require_wave, "y1", T, y, np.sin, np.cos).slip == slip


def test_noises_that_have_to_do_with_each_other_are_refused() -> None:
    rng = np.random.default_rng(5)
    one, two = rng.uniform(-0.2, 0.2, (2, T.size))
    assert refusal(require_independent, {"y1": one, "y2": one}).slip == "the same noise in both"
    assert refusal(require_independent, {"y1": one, "y2": -one}).slip == "the same noise in both"
    assert "are correlated" in str(refusal(require_independent, {"y1": one, "y2": one + two}))
    held = np.repeat(one, 3)[: T.size]
    assert refusal(require_independent, {"y1": held, "y2": two}).slip == "noise that is not random"


def test_an_entry_of_the_legend_that_lacks_one_curve_is_said(
    shipped_record_path: Path, run_notebook, notebook_cells
) -> None:
    answers = {str(words["grade_id"]): source for words, source in notebook_cells(NAME)}
    drawn = answers["prelab-5-original-answer"]
    for old, new, says in (
        (r', label=r"$\cos(0.02\pi t)$"', "", "should name 2 curves"),
        (r"\cos(0.02\pi t)", "other", r"has no entry cos\(0.02πt\)"),
        ('color="C1"', "color=(0.55, 0.7, 0.8)", "hard to distinguish"),
        ('xlabel("Time (s)")', 'xlabel("")', "the x-axis has no label"),
    ):
        assert old in drawn
        said = run_notebook(NAME, shipped_record_path, {"prelab-5-original-answer": drawn.replace(old, new)})
        assert re.search(says, said.pop("prelab-5-original"))
        assert set(said.values()) == {""}


def test_a_figure_that_is_none_or_lacks_the_lower_panel_is_said(shipped_record_path: Path, run_notebook) -> None:
    for code, says in (
        ("fig_1 = None\nax_b = plt.figure().add_subplot()", "should be the figure itself"),
        ("fig_1 = plt.figure()\nax_b = plt.figure().add_subplot()", "`fig_1` is empty"),
    ):
        said = run_notebook(NAME, shipped_record_path, {"prelab-5-original-answer": code})
        assert says in said["prelab-5-original"]
        assert says in said["prelab-6-cut-off"] or "two panels" in said["prelab-6-cut-off"]
