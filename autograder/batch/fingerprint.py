"""Fingerprints of everything a result depends on, part by part, to detect and name changes between runs."""

import hashlib
import os
import sys
from collections.abc import Mapping
from decimal import Decimal
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from autograder.batch.grading_inputs import DataStore, GradingInputs, data_hash
from autograder.course.sources import sources_hash
from autograder.intake.submission import MAX_NOTEBOOK_BYTES, NOT_READ_FILE, UNTOUCHED_FILE, VERSIONS_FILE, is_plain_file
from autograder.results.result_files import StoredResult
from labsid.checks.cells import Template

JUDGING = (
    "autograder.intake.alignment",
    "autograder.intake.submission",
    "autograder.judge.judging",
    "labsid.checks.other_records.other_tanks",
    "labsid.checks.other_records.other_withheld_rig",
    "autograder.batch.wrong_record",
    "autograder.sandbox.child",
    "autograder.sandbox.fork_server",
)
"""The modules on which every result depends, besides the assignment's checks."""

PACKAGES = ("labsid", "numpy", "scipy", "control", "matplotlib", "ipython")


def result_fingerprint(data_store: DataStore, inputs: GradingInputs, folder: Path) -> dict[str, str]:
    """Fingerprint each part that a result depends on.

    Parameters
    ----------
    data_store : DataStore
    inputs : GradingInputs
        The student's.
    folder : Path
        The submission.

    Returns
    -------
    dict
        ``submission``, ``release`` (cells and points), ``solution`` (the functions that replace wrong ones, and hidden
        tests), ``check`` (source files), ``data`` (record and the seed of hidden inputs) and ``environment``
        (versions).
    """
    return {
        "submission": submission_hash(folder, Path(inputs.assets.assignment.record_file or "").suffix),
        "release": template_hash(inputs.assets.template),
        "solution": _solution_hash(inputs.assets.functions, inputs.assets.tests),
        "check": sources_hash(checks_module(inputs.assets.template.assignment), *JUDGING),
        "data": data_hash(data_store, inputs),
        "environment": environment_hash(),
    }


def _solution_hash(functions: Mapping[str, str], tests: Mapping[str, str]) -> str:
    return hashlib.sha256(repr((sorted(functions.items()), sorted(tests.items()))).encode()).hexdigest()


def checks_module(assignment: str) -> str:
    """The module of an assignment's checks."""
    return f"labsid.checks.assignments.{assignment.replace('-', '_')}"


def submission_hash(folder: Path, data_suffix: str) -> str:
    """Fingerprint of a submission's notebooks and data files, but not of its timestamp."""
    digest = hashlib.sha256()
    kinds = {".ipynb", data_suffix}
    entries = sorted(folder.iterdir()) if folder.is_dir() else []
    noted = (VERSIONS_FILE, UNTOUCHED_FILE, NOT_READ_FILE)
    entries += [path] if (path := folder.parent / NOT_READ_FILE).is_file() else []
    for path in (path for path in entries if path.suffix in kinds or path.name in noted):
        digest.update(os.fsencode(path.name) + b"\0" + _content_hash(path))
    return digest.hexdigest()


def _content_hash(path: Path) -> bytes:
    """Fingerprint of a file; of links, devices and files too large to be graded only of what they are."""
    try:
        if not is_plain_file(path, MAX_NOTEBOOK_BYTES):
            found = path.lstat()
            return f"{found.st_mode} {found.st_size} {found.st_mtime_ns}".encode()
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").digest()
    except OSError as error:
        return str(error).encode()


def template_hash(template: Template) -> str:
    """Fingerprint of the cells and points of a released assignment."""
    digest = hashlib.sha256()
    for cell in template.cells:
        digest.update(repr((cell.id, cell.kind, cell.source, cell.points or Decimal(0))).encode())
    return digest.hexdigest()


@cache
def environment() -> tuple[str, ...]:
    """Versions of Python and of the packages that results depend on."""
    return sys.version, *(_version(name) for name in PACKAGES)


@cache
def environment_hash() -> str:
    """Fingerprint of `environment`."""
    return hashlib.sha256(" ".join(environment()).encode()).hexdigest()


def _version(package: str) -> str:
    try:
        return f"{package}={version(package)}"
    except PackageNotFoundError:
        return package


def reason_for_regrading(previous: StoredResult | None, new: StoredResult, level: str) -> str:
    """Say why a submission was graded: ``new``, or the parts that changed since the previous result."""
    if previous is None:
        return "new"
    changed = [part for part, found in new.fingerprint.items() if previous.fingerprint.get(part) != found]
    return ", ".join(changed) or f"isolation {previous.isolation} to {level}"
