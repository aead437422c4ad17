import warnings
from contextlib import contextmanager

import robotraj as rt
from robotraj._util.warn import warn


def test_a_warning_of_a_plan_points_at_the_line_of_the_call():
    arm = rt.load("ur5")
    folded = (0, -1.5, 2.8, 1.1, 1.3, 0)
    fold = rt.Phase(arm, duration=1.0, start=rt.State(q=(0, -1.5, 0.5, -1.2, 0, 0), v=0), end=rt.State(q=folded, v=0))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        rt.plan(fold, time_limit=1.0, check=False)
    touching = [each for each in caught if "touch" in str(each.message)]
    assert touching and all(each.filename == __file__ for each in touching)


def test_a_warning_skips_the_frames_of_context_managers():
    @contextmanager
    def context():
        yield

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        with context():
            warn("first")
        context()(warn)("second")
    assert [each.filename for each in caught] == [__file__, __file__]
