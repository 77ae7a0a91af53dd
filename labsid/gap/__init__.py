"""Diagnosis of the gap between a simulation and a rig: where it lies, what causes it, and how far it closes.

``diagnose`` is imported when it is first used, so that ``import labsid.gap`` stays fast::

    from labsid.gap import diagnose
"""

from importlib import import_module
from typing import Any

__all__ = ["Diagnosis", "diagnose"]

_MODULE_OF = {"diagnose": "labsid.gap.diagnosis", "Diagnosis": "labsid.gap.reports.result"}


def __getattr__(name: str) -> Any:
    if name not in _MODULE_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_MODULE_OF[name]), name)
