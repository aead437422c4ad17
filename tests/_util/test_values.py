"""Copies that share nothing with the caller's values."""

from __future__ import annotations

import numpy as np
import pytest

from robotraj._util.values import own


def test_own_copies_share_no_array_list_or_dict() -> None:
    inner = np.array([1.0, 2.0])
    given = {"a": [inner, (inner, None)], "b": "text", "c": abs}
    kept = own(given)
    inner[0], given["a"], given["b"] = 9.0, [], ""
    assert kept["a"][0].tolist() == kept["a"][1][0].tolist() == [1.0, 2.0]
    assert kept["b"] == "text" and kept["c"] is abs
    with pytest.raises(ValueError, match="read-only"):
        kept["a"][0][0] = 3.0
