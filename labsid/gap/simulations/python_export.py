"""Corrected simulations as Python modules."""

import json
import os
from functools import partial
from pathlib import Path
from typing import Any

from labsid._files import write_file
from labsid.gap.dynamics.record_start import LEAST_START
from labsid.gap.model_file import with_sources
from labsid.gap.system_file import ExportedSystem, system_with_sources
from labsid.simulators.sources import source_file

_MODULE = '''\
"""Corrected simulation, written by `labsid gap diagnose --export`. It needs labsid{needs}.

`simulate(t, u)` starts from rest; with the measured output `y`, its first samples determine the initial state: two of
the slowest time constants, at least {least} and at most a quarter of them; all where these say too little.
"""

import json
from pathlib import Path

from labsid.gap.model_file import from_json_dict, in_folder

_CONTENT = json.loads(r"""
{content}
""")
_MODEL = from_json_dict(in_folder(_CONTENT, Path(__file__).resolve().parent))


def simulate(t, u, y=None):
    """Output of the corrected simulation; the times `t` must have the sampling time of the record, {Ts:g} s."""
    return _MODEL.simulate(u, y)
'''


_SYSTEM_MODULE = '''\
"""Corrected simulation, written by `labsid gap diagnose --export`. It needs labsid{needs}.

`simulate(t, u)` starts from rest at the first inputs; with the measured outputs `y`, their first samples determine the
initial state. The columns of `u` are {inputs}; those of `y`, and of what is returned, are {outputs}.
"""

import json
from pathlib import Path

from labsid.gap.system_file import system_from_json, system_in_folder

_CONTENT = json.loads(r"""
{content}
""")
_MODEL = system_from_json(system_in_folder(_CONTENT, Path(__file__).resolve().parent))


def simulate(t, u, y=None):
    """Outputs, shape (N, {ny}), for inputs of shape (N, {nu}) at times `t` of the record's sampling time, {Ts:g} s."""
    return _MODEL.simulate(u, y)
'''


def write_python_module(path: Path, content: dict[str, Any]) -> None:
    """Write an exported simulation as a Python module with a function ``simulate(t, u, y=None)``.

    Parameters
    ----------
    path : Path
    content : dict
        From `ExportedModel.to_json_dict`. The file of a given simulation is named relative to `path`.
    """

    content = with_sources(content, partial(_near, path))
    needs = f" and {source_file(Path(content['simulator']['source']))}" if "simulator" in content else ""
    text = _MODULE.format(content=json.dumps(content, indent=1), needs=needs, least=LEAST_START, Ts=content["Ts"])
    write_file(path, text.encode())


def write_system_module(path: Path, system: ExportedSystem) -> None:
    """Write an exported simulation of several signals as a Python module with ``simulate(t, u, y=None)``.

    Parameters
    ----------
    path : Path
    system : ExportedSystem
        The file of a given simulation is named relative to `path`.
    """
    content = system_with_sources(system.to_json_dict(), partial(_near, path))
    given = [one["model"]["simulator"] for one in content["outputs"] if "simulator" in one["model"]]
    text = _SYSTEM_MODULE.format(
        content=json.dumps(content, indent=1),
        needs=f" and {source_file(Path(given[0]['source']))}" if given else "",
        inputs=", ".join(system.inputs),
        outputs=", ".join(system.outputs),
        nu=len(system.inputs),
        ny=len(system.outputs),
        Ts=system.sampling_time,
    )
    write_file(path, text.encode())


def _near(path: Path, source: str) -> str:
    """The source of a given simulation, its file named relative to `path`."""
    file = source_file(Path(source))
    return source.replace(str(file), os.path.relpath(file.resolve(), path.resolve().parent), 1)
