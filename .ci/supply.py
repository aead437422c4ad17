"""What robotraj is installed with: a lock file with hashes, the table of licences, a bill of materials.

``python .ci/supply.py lock`` resolves the dependencies of the wheel for every supported Python and platform (needs uv);
``licences`` writes the table in THIRD_PARTY.md from what is installed; ``sbom FILE`` writes CycloneDX 1.5 of it.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterable
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LOCK, PAGE = ROOT / "requirements.lock", ROOT / "THIRD_PARTY.md"
BEGIN, END = "<!-- written by: python .ci/supply.py licences -->", "<!-- end of the table -->"
COMPILED_IN = {"nanobind": "BSD-3-Clause", "robin-map": "MIT", "Eigen": "MPL-2.0"}
"""Sources without a Python package of their own that the compiled modules contain, with their licences."""
SHORTEST = 60
"""Length above which a field for a licence holds its whole text."""


def plain(name: str) -> str:
    """Return the name of a package as indexes write it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def locked() -> dict[str, dict[str, list[str]]]:
    """Return the versions of every package in the lock file, each with its hashes."""
    found: dict[str, dict[str, list[str]]] = {}
    hashes: list[str] = []
    for line in LOCK.read_text(encoding="utf-8").splitlines():
        if package := re.match(r"([a-z0-9._-]+)==(\S+)", line):
            hashes = found.setdefault(plain(package[1]), {}).setdefault(package[2], [])
        elif known := re.match(r"\s+--hash=sha256:([0-9a-f]{64})", line):
            hashes.append(known[1])
    return found


def installed(name: str) -> Distribution | None:
    """Return an installed package, None where it is not installed."""
    try:
        return distribution(name)
    except PackageNotFoundError:
        return None


def stated_licence(package: Distribution) -> str:
    """Return the licence that a package's metadata state: its expression, its field, or its classifiers."""
    data = package.metadata
    field = data.get("License") or ""
    named = [
        entry.rpartition(" :: ")[2]
        for entry in data.get_all("Classifier") or []
        if entry.startswith("License ::") and not entry.endswith("OSI Approved")
    ]
    short = field.strip() if len(field) <= SHORTEST and field != "UNKNOWN" else ""
    return data.get("License-Expression") or short or ", ".join(named) or "not stated"


def direct() -> list[str]:
    """Return the packages that pyproject.toml names as dependencies."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    block = re.findall(r"^dependencies = \[\n(.*?)^\]", text, re.M | re.S)[0]
    return [_name(line) for line in re.findall(r"^  \"(.+?)\"", block, re.M)]


def licences() -> None:
    """Write the table of THIRD_PARTY.md; packages of other platforms and Pythons keep their rows."""
    text = PAGE.read_text(encoding="utf-8")
    head, rest = text.split(BEGIN)
    old, tail = rest.split(END)
    known = dict(re.findall(r"^\| ([^|]+?) \| ([^|]+?) \|$", old, re.M))
    rows = ["| package | licence, as its metadata state it |", "|---|---|"]
    for name in locked():
        package = installed(name)
        licence = known.get(name) if package is None else stated_licence(package)
        if licence is None:
            sys.exit(f"{name} is in {LOCK.name} but not installed, and {PAGE.name} has no row of it: install it first.")
        rows.append(f"| {name} | {licence} |")
    PAGE.write_text(f"{head}{BEGIN}\n" + "\n".join(rows) + f"\n{END}{tail}", encoding="utf-8")


def sbom(target: Path) -> None:
    """Write the packages that robotraj brings here, and what is compiled in, as CycloneDX 1.5."""
    source = (ROOT / "robotraj" / "__init__.py").read_text(encoding="utf-8")
    own = re.findall(r"^__version__ = \"(.+)\"", source, re.M)[0]
    components = [{"type": "library", "name": name, "licenses": [_licence(text)]} for name, text in COMPILED_IN.items()]
    needs = {"robotraj": _present(direct())}
    waiting = list(needs["robotraj"])
    while waiting:
        if (name := waiting.pop()) not in needs:
            needs[name] = _needs(name)
            waiting += needs[name]
    for name, versions in locked().items():
        package = installed(name)
        if package is None or name not in needs:
            continue
        component: dict[str, object] = {
            "type": "library",
            "bom-ref": name,
            "name": name,
            "version": package.version,
            "purl": f"pkg:pypi/{name}@{package.version}",
            "licenses": [_licence(stated_licence(package))],
        }
        # The lock file has the hashes of all wheels of a version; which of them was installed is not recorded.
        if len(hashes := versions.get(package.version, [])) == 1:
            component["hashes"] = [{"alg": "SHA-256", "content": hashes[0]}]
        components.append(component)
    about = {"type": "library", "bom-ref": "robotraj", "name": "robotraj", "version": own}
    bill = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": about | {"purl": f"pkg:pypi/robotraj@{own}"}},
        "components": components,
        "dependencies": [{"ref": name, "dependsOn": needs[name]} for name in sorted(needs)],
    }
    target.write_text(json.dumps(bill, indent=1) + "\n", encoding="utf-8")


def lock() -> None:
    """Write the lock file; no address of an index is in it."""
    options = ["--universal", "--python-version", "3.10", "--generate-hashes", "--no-header", "--no-emit-index-url"]
    command = [sys.executable, "-m", "uv", "pip", "compile", "pyproject.toml", *options, "-o", LOCK.name, "--quiet"]
    subprocess.run(command, cwd=ROOT, check=True)


def _licence(text: str) -> dict[str, object]:
    """Return a licence as CycloneDX writes it: an expression of SPDX, or a name."""
    words = re.fullmatch(r"[A-Za-z0-9.+-]+( (AND|OR|WITH) [A-Za-z0-9.+-]+)+", text)
    return {"expression": text} if words else {"license": {"name": text}}


def _needs(name: str) -> list[str]:
    """Return the installed packages of the lock file that a package names without an extra."""
    package = installed(name)
    wanted = [] if package is None else package.requires or []
    return _present(_name(need) for need in wanted if "extra ==" not in need)


def _present(names: Iterable[str]) -> list[str]:
    """Return those of some names that are in the lock file and installed."""
    return sorted(name for name in set(names) & set(locked()) if installed(name) is not None)


def _name(requirement: str) -> str:
    return plain(re.split(r"[^A-Za-z0-9._-]", requirement, maxsplit=1)[0])


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["lock"]:
            lock()
        case ["licences"]:
            licences()
        case ["sbom", file]:
            sbom(Path(file))
        case _:
            sys.exit(__doc__)
