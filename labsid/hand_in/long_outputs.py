"""A notebook as it is handed in: without outputs that are so long that the file would not be collected."""

import json
from collections.abc import Iterator
from typing import Any

from labsid.checks.time_limit import NOTEBOOK_BYTES

MOST_BYTES = 5 * 1024**2
"""Notebooks up to this size are handed in as they are saved."""

LONG_OUTPUTS = (100_000, 1_000)
"""Characters of a cell's outputs, as JSON, from which they are left out of a larger notebook; the second if the first
does not do."""

LEFT_OUT = "The output of this cell was too long, and left out when the notebook was handed in."


def packed_notebook(name: str, data: bytes) -> tuple[bytes, str]:
    """The content of a notebook file to hand in, and what to say of it.

    Outputs are not graded: grading runs the notebook. Answers, texts and pictures in texts stay as they are.

    Parameters
    ----------
    name : str
        The assignment.
    data : bytes
        The file as it is saved.

    Returns
    -------
    content : bytes
    remark : str
        Empty if it is handed in as it is saved.

    Raises
    ------
    ValueError
        If it is too large without these outputs.
    """
    if len(data) <= MOST_BYTES:
        return data, ""
    notebook = json.loads(data)
    content, count = data, 0
    for most in LONG_OUTPUTS:
        for cell in list(_with_outputs(notebook, most)):
            cell["outputs"] = [{"output_type": "stream", "name": "stdout", "text": [LEFT_OUT]}]
            count += 1
        content = f"{json.dumps(notebook, indent=1)}\n".encode() if count else data
        if len(content) <= NOTEBOOK_BYTES:
            break
    else:
        raise ValueError(
            f"{name}.ipynb has {len(content) // 2**20} MB without its outputs; at most {NOTEBOOK_BYTES // 2**20} MB "
            "are collected. Make the pictures in its text cells smaller, or delete long cells, save it and run this "
            "command again."
        )
    cells = "1 cell" if count == 1 else f"{count} cells"
    said = f"{name}: long outputs of {cells} are left out of the file. Your notebook keeps them; they are not graded."
    return content, said if count else ""


def _with_outputs(notebook: Any, longer: int) -> Iterator[dict[str, Any]]:
    for cell in notebook["cells"]:
        if cell.get("outputs") and len(json.dumps(cell["outputs"])) > longer:
            yield cell
