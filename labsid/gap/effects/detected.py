"""Effects that are found without a simulation of them: in the samples, or in the paths of a given simulation."""

from labsid.gap.effects.base import Effect
from labsid.gap.effects.description import Description, Reported
from labsid.gap.effects.sketch import Sketch, same, some_steps, stepped


class Converter(Effect):
    """The converter's step is coarse; found in the samples (`sample_faults`)."""

    name = "output-quantization"
    description = Description(
        path="output",
        noun="a coarse converter",
        clauses=(
            "The output is quantised in steps of {step}",
            "The output is quantised in coarse steps",
        ),
        meaning=(
            "The record contains only multiples of the step, so smaller changes are lost. Check the resolution of the"
            " converter and rounding in the logger."
        ),
        excited_by="Any record: it shows in the samples themselves.",
        parameters={"step": Reported("converter step", "y")},
        sketch=Sketch(
            "Output of the process",
            "y",
            "Reading",
            "y",
            stepped,
            same,
            ("step",),
            reach=some_steps,
        ),
    )


class Spikes(Effect):
    """Isolated readings that the process cannot have produced; found in the samples (`sample_faults`)."""

    name = "output-outliers"
    description = Description(
        path="output",
        noun="a spiking sensor",
        clauses=(
            "Of the readings, {share:%} are isolated spikes",
            "Some readings are isolated spikes",
        ),
        meaning=(
            "Isolated samples that the process cannot have produced. The fits exclude them. Check for loose contacts "
            "and electrical interference."
        ),
        excited_by="Any record: it shows in the samples themselves.",
        parameters={"share": Reported("share of the samples", "1", share=True)},
    )


class HeldValues(Effect):
    """The logger repeats its last value; found in the samples (`sample_faults`)."""

    name = "output-dropout"
    description = Description(
        path="output",
        noun="a logger that holds its last value",
        clauses=(
            "The logger repeats its last value over {share:%} of the record",
            "The logger repeats its last value over stretches of the record",
        ),
        meaning=(
            "Where a new reading was missing, the logger wrote the last one again. The fits exclude these samples. "
            "Check the connection and the load of the logging computer."
        ),
        excited_by="Any record whose output changes: held values repeat.",
        parameters={"share": Reported("share of the samples", "1", share=True)},
    )


class ColouredNoise(Effect):
    """Noise that is correlated over many samples; found in the residual (`search/explanation`)."""

    name = "coloured-noise"
    description = Description(
        path="disturbance",
        noun="coloured noise",
        clauses=(
            "The output contains noise of {amplitude} rms that is correlated over many samples",
            "The output contains noise that is correlated over many samples",
        ),
        meaning=(
            "A random disturbance that keeps its sign for many samples. It does not depend on the input, so no "
            "simulation can reproduce it; it limits the accuracy of every simulation."
        ),
        excited_by="A record much longer than the time over which the noise is correlated.",
        parameters={
            "amplitude": Reported("rms", "y"),
            "pole": Reported("pole (0: white; near 1: slow)", "1"),
        },
        confused_with=("output-drift", "periodic-disturbance"),
    )


class Coupling(Effect):
    """A path from an input to an output that a given simulation lacks (`signals/couplings`)."""

    name = "coupling"
    description = Description(
        path="dynamics",
        noun="a coupling",
        clauses=(
            "The input moves the output, and in the simulation it does not; the steady gain is {gain}",
            "The input moves the output, and in the simulation it does not",
        ),
        meaning=(
            "The simulation has no path from this input to this output; the rig has one. Look for shared supplies, "
            "heat or flow between neighbours, and forces through a common frame."
        ),
        excited_by="Several inputs, each of which moves while the others rest; only with --sim.",
        parameters={"gain": Reported("steady gain", "y/u")},
        confused_with=("parameter-mismatch",),
        given_only=True,
    )


DETECTED: tuple[type[Effect], ...] = (Converter, Spikes, HeldValues, ColouredNoise, Coupling)
UNSIMULATED = tuple(one.name for one in (HeldValues, Spikes, Converter, ColouredNoise))
"""Effects that are detected in the samples, in the order of the report."""
