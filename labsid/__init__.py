"""System identification as it is taught in the lab: records, least squares, verification, and the sim-to-real gap.

The names below are the front door; each is imported from its room when it is first used, so that ``import labsid`` and
``labsid --help`` stay fast::

    from labsid import load_record, find_offsets, remove_offsets, fit_arx, to_tf, verify, diagnose
"""

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

_ROOMS = {
    "labsid.records.record": ("Record", "load_record"),
    "labsid.lab.record_check": ("check_record",),
    "labsid.lab.sinusoid": ("make_sinusoids", "cut_off"),
    "labsid.lab.offset": ("Offsets", "find_offsets", "remove_offsets"),
    "labsid.lab.regressor": ("build_phi",),
    "labsid.lab.arx": ("ArxFit", "ArxModel", "arx_from_theta", "fit_arx", "to_ss", "to_tf"),
    "labsid.lab.arx_system": ("ArxSystem", "fit_arx_system", "simulate_system"),
    "labsid.lab.long_arx": ("fit_long_arx",),
    "labsid.lab.excitation": ("excitation_order", "prbs"),
    "labsid.lab.simulation": ("estimate_initial_state", "predict_one_step", "simulate"),
    "labsid.lab.verification": ("Verification", "mse", "verify"),
    "labsid.lab.record_verification": ("verify_on_record", "verify_system_on_record"),
    "labsid.lab.identification": ("Identification", "identify"),
    "labsid.lab.system_identification": ("SystemIdentification", "identify_system"),
    "labsid.lab.step_response": ("fit_step_response",),
    "labsid.model_structures.structures": ("PolynomialModel", "Regression", "Structure", "fit_structure"),
    "labsid.model_structures.prediction": ("free_run", "one_step_prediction"),
    "labsid.model_structures.order": ("loss_against_order",),
    "labsid.model_structures.residuals": ("input_residual_test", "whiteness_test"),
    "labsid.estimation.recursive": ("recursive_armax", "recursive_instrumental", "recursive_least_squares"),
    "labsid.estimation.online": ("RecursiveArmax", "RecursiveInstrumental", "RecursiveLeastSquares"),
    "labsid.estimation.armax": ("fit_armax",),
    "labsid.estimation.instrumental": ("fit_instrumental",),
    "labsid.estimation.likelihood": ("fit_likelihood",),
    "labsid.estimation.subspace": ("fit_subspace",),
    "labsid.nonlinear.solve": ("gauss_newton", "levenberg_marquardt"),
    "labsid.nonlinear.exponential": ("fit_exponential",),
    "labsid.gap.diagnosis": ("diagnose",),
}
_MODULE_OF = {name: module for module, names in _ROOMS.items() for name in names}

__all__ = ["__version__", *sorted(_MODULE_OF)]


def __getattr__(name: str) -> Any:
    if name not in _MODULE_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_MODULE_OF[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
