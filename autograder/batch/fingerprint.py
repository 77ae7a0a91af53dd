"""Fingerprints of all that goes into a result, part by part, so that a second run can say what has changed."""

import hashlib
import os
import sys
from decimal import Decimal
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from autograder.batch.assets import DataStore, GradingInputs, data_hash
from autograder.course.layout import Template
from autograder.course.sources import sources_hash
from autograder.results.result_files import StoredResult

JUDGING = (
    "autograder.intake.submission",
    "autograder.judge.judging",
    "autograder.batch.wrong_record",
    "autograder.sandbox.child",
    "autograder.sandbox.fork_server",
)
"""With an assignment's checks, the modules on which its results depend."""

PACKAGES = ("labsid", "numpy", "scipy", "control", "matplotlib", "ipython")


def fingerprint(data_store: DataStore, inputs: GradingInputs, folder: Path) -> dict[str, str]:
    """Fingerprints of what goes into a result.

    Parameters
    ----------
    data_store : DataStore
    inputs : GradingInputs
        The student's own.
    folder : Path
        The hand-in.

    Returns
    -------
    dict
        ``submission``, ``release`` (cells and points), ``check`` (source files), ``data`` (record and the seed of
        hidden inputs) and ``environment`` (versions).
    """
    return {
        "submission": submission_hash(folder, Path(inputs.assets.assignment.record_file or "").suffix),
        "release": template_hash(inputs.assets.template),
        "check": sources_hash(checks_module(inputs.assets.template.assignment), *JUDGING),
        "data": data_hash(data_store, inputs),
        "environment": environment_hash(),
    }


def checks_module(assignment: str) -> str:
    """The module of an assignment's checks, which `sources_hash` must be told."""
    return f"labsid.checks.assignments.{assignment.replace('-', '_')}"


def submission_hash(folder: Path, data_suffix: str) -> str:
    """Of a hand-in's notebooks and data files; its time does not count."""
    digest = hashlib.sha256()
    kinds = {".ipynb", data_suffix}
    there = sorted(folder.iterdir()) if folder.is_dir() else []
    for path in (path for path in there if path.suffix in kinds and path.is_file()):
        try:
            with path.open("rb") as file:
                content = hashlib.file_digest(file, "sha256").digest()
        except OSError as error:
            content = str(error).encode()
        digest.update(os.fsencode(path.name) + b"\0" + content)
    return digest.hexdigest()


def template_hash(template: Template) -> str:
    """Fingerprint of a released assignment: any change of its cells or points changes it."""
    digest = hashlib.sha256()
    for cell in template.cells:
        digest.update(repr((cell.id, cell.kind, cell.source, cell.points or Decimal(0))).encode())
    return digest.hexdigest()


@cache
def environment() -> tuple[str, ...]:
    """Versions of Python and of what students' code and the checks compute with."""
    return sys.version, *(_version(name) for name in PACKAGES)


@cache
def environment_hash() -> str:
    """Fingerprint of these versions."""
    return hashlib.sha256(" ".join(environment()).encode()).hexdigest()


def _version(package: str) -> str:
    try:
        return f"{package}={version(package)}"
    except PackageNotFoundError:
        return package


def what_changed(known: StoredResult | None, new: StoredResult, level: str) -> str:
    """In words, why a submission was graded anew."""
    if known is None:
        return "new"
    changed = [part for part, found in new.fingerprint.items() if known.fingerprint.get(part) != found]
    return ", ".join(changed) or f"isolation {known.isolation} to {level}"
