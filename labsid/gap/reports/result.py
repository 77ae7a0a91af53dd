"""The result of a diagnosis, as scripts and notebooks use it."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.model_file import ExportedModel
from labsid.gap.reports.html_report import render_html
from labsid.gap.reports.page_parts import in_frame
from labsid.gap.reports.replay_data import ReplayData
from labsid.gap.reports.text_report import format_report
from labsid.gap.reports.traces import record_traces
from labsid.gap.verdict.gates import Why


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Diagnosis:
    """Result of `diagnose`.

    JupyterLab shows it as the page of ``--html``; `print` shows the text of the command line.

    Attributes
    ----------
    summary : dict
        The report but for its entry ``replay``, which is None.
    model : ExportedModel
        The simulation with the effects added; ``--export`` writes it.
    replay : ReplayData
        Makes what a page replays.
    why : Why or None
        Each gate of the verdict, which ``--why`` prints; None unless asked for.
    """

    summary: dict[str, Any]
    model: ExportedModel
    replay: ReplayData
    why: Why | None = None

    @property
    def report(self) -> dict[str, Any]:
        """The report in the layout ``labsid.gap/4``, which ``--json`` writes."""
        return self.summary | {"replay": self.replay()}

    @property
    def verdict(self) -> str:
        """``"none"``, ``"effect"``, ``"partial"`` or ``"unknown"``."""
        return str(self.summary["verdict"])

    @property
    def effects(self) -> dict[str, dict[str, dict[str, Any]]]:
        """Parameters of the effects found, by name, as ``{name: {parameter: {value, stderr, unit}}}``."""
        return {effect["name"]: effect["parameters"] for effect in self.summary["effects"]}

    @property
    def ranking(self) -> list[dict[str, Any]]:
        """Every combination of effects tried, best first; ``pandas.DataFrame(result.ranking)`` is its table."""
        return list(self.summary["ranking"])

    def better(self, t: FloatArray, u: FloatArray, y: FloatArray | None = None) -> FloatArray:
        """Output of the simulation with the effects added.

        Parameters
        ----------
        t : array_like, shape (N,)
            Times in seconds, with the sampling time of the record.
        u : array_like, shape (N,)
            Input.
        y : array_like, shape (N,), optional
            Measured output, of which the first samples determine the initial state; without it, the simulation starts
            from rest.

        Returns
        -------
        ndarray, shape (N,)

        Raises
        ------
        ValueError
            If the lengths differ, or the times have another sampling time.
        """
        times, inputs = np.asarray(t, float), np.asarray(u, float)
        measured = None if y is None else np.asarray(y, float)
        shapes = [one.shape for one in (times, inputs, measured) if one is not None]
        if times.ndim != 1 or times.size < 2 or len(set(shapes)) > 1:
            raise ValueError(f"t, u and y must be vectors of one length, two samples or more; got shapes {shapes}.")
        if not np.allclose(np.diff(times), self.model.Ts, rtol=1e-3):
            raise ValueError(
                f"the simulation runs at {self.model.Ts:g} s, the times at {np.diff(times).mean():g} s. Resample them."
            )
        return self.model.simulate(inputs, measured)

    def plot(self) -> Any:
        """A matplotlib figure of the measured output and of the simulations before and after, with their errors.

        Several records have a row each, with the simulations that are scored.
        """
        from labsid.plots.gap import figure_simulations
        from labsid.plots.gap_records import figure_records

        report = self.report
        if report.get("records"):
            return figure_records(report | {"record_traces": record_traces(report)})
        return figure_simulations(report)

    def with_summary(self, summary: dict[str, Any]) -> "Diagnosis":
        """The same result with another summary, such as one in other units."""
        return replace(self, summary=summary)

    def __str__(self) -> str:
        return format_report(self.summary)

    def __repr__(self) -> str:
        gap = self.summary["gap"]
        named = ", ".join(f"{one['name']} (p = {one['probability']:.2f})" for one in self.summary["effects"])
        found = f"{self.verdict}: {named}" if named else self.verdict
        closed = "" if gap["closed"] is None else f", {gap['closed']:.0%} of the gap closed"
        return f"<Diagnosis: {found}; rms error {gap['before']:.3g} before, {gap['after']:.3g} after{closed}>"

    def _repr_html_(self) -> str:
        return in_frame(render_html(self.report))
