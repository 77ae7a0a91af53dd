"""Every bar of the grading, of batches on a cluster and of given simulations, measured here, as one table.

Exit status 1 where one that must be reached is missed.

`make bars` runs it, which takes an hour; ``make bars BARS_ARGS="--only attacks"`` runs a part.
"""

import argparse
import os
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))  # the packages first: the tests mirror them

from bars_grading_figures import Metric, markdown, show
from bars_grading_parts import PARTS, Size


def main() -> None:
    parser = argparse.ArgumentParser(description="every bar, measured on this machine")
    parser.add_argument("--only", choices=list(PARTS), action="append", help="this part; may be given again")
    parser.add_argument("--submissions", type=int, default=60, help="hand-ins that are graded beside nbgrader")
    parser.add_argument("--kills", type=int, default=20, help="times that grading is killed and restarted")
    parser.add_argument("--draws", type=int, default=200, help="draws of the trials for each wrong answer")
    parser.add_argument("--records", type=int, default=1000, help="records that are diagnosed on two Dask workers")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="at a time")
    parser.add_argument("--markdown", metavar="FILE", type=Path, help="also write the table here")
    options = parser.parse_args()
    size = Size(options.submissions, options.kills, options.draws, options.jobs, options.records)
    began = time.monotonic()

    def say(text: str) -> None:
        minutes, seconds = divmod(int(time.monotonic() - began), 60)
        print(f"[{minutes:2d}:{seconds:02d}] {text}", file=sys.stderr, flush=True)

    busy = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    if busy > 0.5 * (os.cpu_count() or 1):
        say(f"this machine has other work (load {busy:.1f} on {os.cpu_count()} processors): times will be too long")
    metrics: list[Metric] = []
    for name in options.only or PARTS:
        say(f"{name}: {PARTS[name].__doc__}")
        with tempfile.TemporaryDirectory(prefix="labsid-bars-") as folder:
            for metric in PARTS[name](Path(folder), size, say):
                say(f"  {metric.name}: {metric.measured} {metric.status}")
                metrics.append(metric)
    show(metrics)
    if options.markdown is not None:
        options.markdown.write_text(markdown(metrics), encoding="utf-8")
    raise SystemExit(int(any(metric.status == "missed" for metric in metrics)))


if __name__ == "__main__":
    main()
