"""The lock file, the table of licences and the bill of materials name what is installed."""

from __future__ import annotations

import importlib.util
import json
import re
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]
SCRIPT = ROOT / ".ci" / "supply.py"
if not SCRIPT.exists():
    pytest.skip("the source distribution has no .ci", allow_module_level=True)
spec = importlib.util.spec_from_file_location("supply", SCRIPT)
supply = importlib.util.module_from_spec(spec)
spec.loader.exec_module(supply)


def test_the_lock_file_fits_the_project() -> None:
    block = (ROOT / "pyproject.toml").read_text(encoding="utf-8").partition("\ndependencies = [")[2].partition("\n]")[0]
    wanted = [Requirement(text) for text in re.findall(r'^  "(.+?)"', block, re.M)]
    locked = supply.locked()
    assert [supply.plain(each.name) for each in wanted] == supply.direct() and len(wanted) > 10
    for each in wanted:
        versions = locked[supply.plain(each.name)]
        assert all(each.specifier.contains(version) for version in versions), each


def test_every_locked_version_has_hashes_and_no_address() -> None:
    assert all(hashes for versions in supply.locked().values() for hashes in versions.values())
    assert "://" not in supply.LOCK.read_text(encoding="utf-8")


def test_the_table_of_licences_names_what_is_locked() -> None:
    table = supply.PAGE.read_text(encoding="utf-8").partition(supply.BEGIN)[2].partition(supply.END)[0]
    rows = dict(re.findall(r"^\| ([^|]+?) \| ([^|]+?) \|$", table, re.M))
    del rows["package"]
    assert list(rows) == list(supply.locked())
    for name, versions in supply.locked().items():
        package = supply.installed(name)
        if package is not None and package.version in versions:
            assert rows[name] == supply.stated_licence(package), name


def test_the_bill_of_materials_is_closed(tmp_path: Path) -> None:
    supply.sbom(tmp_path / "sbom.json")
    bill = json.loads((tmp_path / "sbom.json").read_text(encoding="utf-8"))
    assert (bill["bomFormat"], bill["specVersion"]) == ("CycloneDX", "1.5")
    named = [component.get("bom-ref") for component in bill["components"] if "bom-ref" in component]
    assert len(set(named)) == len(named) and {"casadi", "pin", "libpinocchio", "numpy"} <= set(named)
    edges = {entry["ref"]: entry["dependsOn"] for entry in bill["dependencies"]}
    assert set(edges) == {*named, "robotraj"}
    assert {each for needs in edges.values() for each in needs} <= set(named)
    reached, waiting = set(), ["robotraj"]
    while waiting:
        reached.update(new := set(edges[waiting.pop()]) - reached)
        waiting += new
    assert reached == set(named)
