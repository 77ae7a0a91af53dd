"""Effects planted in arms of one joint in MuJoCo, their models without them: what is named, and the second record.

python tests/bars_inside.py [ACTUATOR[:EFFECT] ...]        (position, velocity, torque; all by default)
"""

import sys
import tempfile
from pathlib import Path
from time import process_time

import numpy as np
from mjcf_arms import AMPLITUDES, MOTOR, NOISE, SERVO, SPEED, arm, measured, written

from labsid.gap.diagnosis import diagnose
from labsid.simulators.process import open_in_process

ACTUATORS = {"position": SERVO, "velocity": SPEED, "torque": MOTOR}
SAMPLES = 1500
PLANTED: dict[str, tuple[str | None, dict[str, float]]] = {
    "nothing": (None, {}),
    "friction": ("coulomb-friction", {"friction": 0.12}),
    "friction with the load": ("coulomb-friction", {"friction": 0.03, "transmitted": 0.2}),
    "break-away": ("coulomb-friction", {"friction": 0.08, "peak": 0.06, "stribeck": 0.15}),
    "drag": ("quadratic-drag", {"drag": 0.03}),
    "damping": ("parameter-mismatch", {"damping": 0.06}),
    "armature": ("parameter-mismatch", {"armature": 0.015}),
    "gravity": ("gravity", {"gravity_sin": 0.8}),
    "payload": ("parameter-mismatch", {"mass": 0.3}),
    "cubic spring": ("cubic-stiffness", {"cubic": 1.0}),
    "spring": ("parameter-mismatch", {"stiffness": 0.8}),
    "stop": ("end-stop", {"high": 0.5}),
    "force limit": ("force-limit", {"limit": 0.6}),
    "lag": ("extra-lag", {"lag": 0.05}),
    "load": ("load-step", {"load": 0.2, "onset": 6.4}),
    "wave": ("periodic-disturbance", {"wave_cos": 0.1, "frequency": 0.9}),
    "gain": ("parameter-mismatch", {"gain": 0.2}),
}


def main() -> None:
    wanted = sys.argv[1:] or list(ACTUATORS)
    right = count = 0
    with tempfile.TemporaryDirectory() as folder:
        for kind, actuator in ACTUATORS.items():
            model = written(Path(folder) / f"{kind}.xml", arm(actuator))
            for what, (name, changes) in PLANTED.items():
                if not {kind, f"{kind}:{what}"} & set(wanted) or (what == "force limit" and kind == "torque"):
                    continue
                first, second = (measured(model, n, SAMPLES, AMPLITUDES[actuator], **changes) for n in (1, 2))
                begun = process_time()
                found = diagnose(first, open_in_process(str(model)))
                seconds = process_time() - begun
                y = found.model.simulate(second.u, second.y, of_record=True)  # load and wave act at the same times
                error = np.sqrt(np.mean((y - second.y)[50:] ** 2)) / (NOISE * np.std(second.y))
                named = [(e["name"], e.get("joint"), round(e["probability"], 2)) for e in found.report["effects"]]
                right += [one[0] for one in named] == ([] if name is None else [name])
                count += 1
                print(f"{kind:9s}{what:23s}{named}  second record {error:.3f}  {seconds:.1f} s", flush=True)
    print(f"{right} of {count} named")


if __name__ == "__main__":
    main()
