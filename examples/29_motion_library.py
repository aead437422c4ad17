"""A library of reaches: plans start from the nearest one, and answers without a proof take milliseconds."""

import time

import robotraj as rt

arm = rt.load("two_link_arm")


def make(case: dict[str, float]) -> rt.Phase:
    """Reach a configuration."""
    start, end = rt.State(q=[0.0, 0.3], v=0), rt.State(q=[case["shoulder"], case["elbow"]], v=0)
    return rt.Phase(arm, 6.0, start, end, rt.Effort(), name="reach")


grid = [{"shoulder": shoulder, "elbow": elbow} for shoulder in (0.8, 1.1, 1.4) for elbow in (0.3, 0.6)]
library = rt.applications.library(make, grid)
case = {"shoulder": 1.2, "elbow": 0.5}

cold = rt.plan(make(case))
warm = library.plan(case)
assert warm.proved and abs(warm.objective / cold.objective - 1.0) < 2e-3
print(f"iterations: {cold.iterations} alone, {warm.iterations} from the nearest of {len(library.cases)}")

library.answer(case)  # builds the program of a step
began = time.process_time()
answer = library.answer({"shoulder": 1.21, "elbow": 0.52})
print(f"answered in {1e3 * (time.process_time() - began):.1f} ms, rows met: {answer.fresh}")
print("wrote", rt.replay(warm, "29_motion_library.html"))
