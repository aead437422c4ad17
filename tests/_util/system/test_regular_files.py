"""Files that do not exist: the message names those of like names, or the folder that is missing."""

from pathlib import Path

import pytest

import robotraj as rt


def test_a_missing_file_names_its_neighbour_or_its_missing_folder(tmp_path: Path) -> None:
    (tmp_path / "my_arm.urdf").write_text("<robot/>")
    (tmp_path / "problem.toml").write_text("")
    with pytest.raises(rt.InputError, match=r"no URDF file .*my_arn\.urdf'\. Did you mean 'my_arm\.urdf'"):
        rt.load(tmp_path / "my_arn.urdf")
    with pytest.raises(rt.InputError, match=r"does not exist\. Did you mean 'problem\.toml'"):
        rt.load_problem(tmp_path / "prblem.toml")
    with pytest.raises(rt.InputError, match=r"no file .*Neither does the folder '.*nowhere'"):
        rt.load_solution(tmp_path / "nowhere" / "x.npz")
