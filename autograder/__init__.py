"""The nbgrader course of labsid: build the course, grade submissions, write feedback and exports."""

import sys

# nbformat imports jsonschema, which imports rfc3987_syntax if it is installed. Its grammar takes longer to build than a
# submission takes to grade, and notebooks do not need it.
if "jsonschema" not in sys.modules:
    sys.modules.setdefault("rfc3987_syntax", None)  # type: ignore[arg-type]
