"""Plans one after the other, as in a control loop: what is built once stays, and memory does not grow."""

import gc
import resource

import numpy as np

import robotraj as rt


def test_warm_plans_from_other_starts_build_nothing_again_and_take_no_memory() -> None:
    """Warm plans of least time used to build their stage each time, and kept 0.2 MB each."""
    arm, rng = rt.load("ur5"), np.random.default_rng(0)
    first, last = np.array([-1.1, -1.8, 1.6, -1.2, -1.57, 0.0]), np.array([1.1, -0.8, 0.6, -0.6, -0.6, 1.2])
    phase = rt.Phase(arm, (0.1, 5.0), rt.State(q=first, v=0), rt.State(q=last, v=0), rt.Duration())
    solution = rt.plan(phase, mesh=rt.Mesh(10))

    def replanned(times: int) -> tuple[int, float]:
        """Plan again and again; return the number of Python's objects and the peak of resident memory [MB]."""
        nonlocal solution
        for _ in range(times):
            start = rt.State(q=first + 0.02 * rng.standard_normal(6), v=0)
            solution = rt.plan(phase.with_(start=start), mesh=rt.Mesh(10), guess=solution)
        gc.collect()
        return len(gc.get_objects()), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0

    objects, memory = replanned(5)
    more_objects, more_memory = replanned(30)
    assert more_objects - objects < 300
    assert more_memory - memory < 3.0
