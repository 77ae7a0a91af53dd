"""The nbgrader course of labsid: building, grading, feedback and hand-in."""

import sys

# jsonschema, which reads notebooks, builds the grammar of internationalised addresses when it is imported and that
# grammar is installed. Notebooks hold none, and building it takes longer than grading a student.
if "jsonschema" not in sys.modules:
    sys.modules.setdefault("rfc3987_syntax", None)  # type: ignore[arg-type]
