"""The result of a diagnosis of several signals."""

from dataclasses import dataclass, replace
from typing import Any

from labsid.gap.model_file import ExportedModel
from labsid.gap.reports.page_parts import in_frame
from labsid.gap.reports.signals_page import render_signals, with_titles
from labsid.gap.reports.signals_text import format_signals
from labsid.gap.system_file import ExportedSystem


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SignalsDiagnosis:
    """Result of `diagnose` for a record of several signals.

    JupyterLab shows it as the page of ``--html``; `print` shows the text of the command line.

    Attributes
    ----------
    report : dict
        In the layout ``labsid.gap/4``; ``--json`` writes it.
    models : dict
        By output: the simulation with the effects added.
    system : ExportedSystem or None
        All of them as one simulation; None where each output was explained beside the measured other outputs.
    """

    report: dict[str, Any]
    models: dict[str, ExportedModel]
    system: ExportedSystem | None = None

    @property
    def verdict(self) -> str:
        """``"none"``, ``"effect"``, ``"partial"`` or ``"unknown"``."""
        return str(self.report["verdict"])

    @property
    def effects(self) -> dict[tuple[str, str | None], dict[str, dict[str, Any]]]:
        """Parameters of the effects found, by name and signal; of a coupling, ``"u2 -> y1"``."""
        return {(effect["name"], _place(effect)): effect["parameters"] for effect in self.report["effects"]}

    @property
    def summary(self) -> dict[str, Any]:
        """The report, as that of `Diagnosis` without what its page replays."""
        return self.report

    def with_summary(self, summary: dict[str, Any]) -> "SignalsDiagnosis":
        """The same result with another report, such as one with the command line."""
        return replace(self, report=summary)

    def plot(self) -> Any:
        """A matplotlib figure of the outputs, measured and simulated before and after, their errors, and the inputs."""
        from labsid.plots.signals import figure_signals

        return figure_signals(with_titles(self.report))

    def __str__(self) -> str:
        return format_signals(self.report)

    def __repr__(self) -> str:
        named = ", ".join(
            f"{one['name']} at {one['signal'] or one.get('joint') or 'the dynamics'} (p = {one['probability']:.2f})"
            for one in self.report["effects"]
        )
        gap = self.report["gap"]
        found = f"{self.verdict}: {named}" if named else self.verdict
        return f"<SignalsDiagnosis: {found}; rms error {gap['before']:.3g} before, {gap['after']:.3g} after>"

    def _repr_html_(self) -> str:
        return in_frame(render_signals(self.report))


def _place(effect: dict[str, Any]) -> str | None:
    """The signal of an effect, or both ends of a coupling."""
    if effect.get("from"):
        return f"{effect['from']} -> {effect['to']}"
    signal: str | None = effect["signal"]
    return signal
