"""A report on the necessary conditions: each condition with its variable, residual and time."""

from __future__ import annotations

from robotraj._util.errors import ValidationFailed
from robotraj._util.printing import OneLine, table
from robotraj._util.values import dataclass


@dataclass(frozen=True)
class NecessaryCondition(OneLine):
    """One necessary condition.

    Attributes
    ----------
    phase : str
    name : str
        ``"costate equation"``, ``"stationarity"``, ``"saturation"``, ``"transversality"``, ``"Hamiltonian"``,
        ``"complementarity"``.
    label : str
        The state, control, joint or row of the condition.
    residual : float
        Largest residual, relative to the size of its terms.
    time : float
        Time of the largest residual [s].
    note : str
        Explanation of the result.
    """

    phase: str
    name: str
    label: str
    residual: float
    time: float
    note: str = ""


@dataclass(frozen=True)
class ConditionsReport(OneLine):
    """The first-order necessary conditions of Pontryagin along a direct solution.

    Attributes
    ----------
    conditions : tuple of NecessaryCondition
    tolerance : float
        Largest relative residual of a satisfied condition.
    """

    conditions: tuple[NecessaryCondition, ...]
    tolerance: float

    @property
    def failed(self) -> tuple[NecessaryCondition, ...]:
        """Conditions whose residual exceeds the tolerance, largest first."""
        off = [c for c in self.conditions if not c.residual <= self.tolerance]
        return tuple(sorted(off, key=lambda c: -c.residual))

    @property
    def passed(self) -> bool:
        """Whether every condition holds to the tolerance."""
        return not self.failed

    def worst(self, name: str) -> float:
        """Return the largest relative residual of the conditions of a name; 0 if there are none."""
        return max((c.residual for c in self.conditions if c.name == name), default=0.0)

    def check(self) -> None:
        """Raise ``ValidationFailed`` if a condition does not hold."""
        if not self.passed:
            worst = self.failed[0]
            raise ValidationFailed(
                f"{worst.name} of {worst.label} has the residual {worst.residual:.2g} at t = {worst.time:.4g} s, "
                f"more than {self.tolerance:g}; refine the mesh there.",
                self,
            )

    def __str__(self) -> str:
        several = len({c.phase for c in self.conditions}) > 1
        rows = [("phase", "condition", "of", "off by", "t [s]", "found")]
        for c in self.conditions:
            holds = c.residual <= self.tolerance
            found = ", ".join(text for text in ("" if holds else "OFF", c.note) if text) or "holds"
            rows.append((c.phase, c.name, c.label, f"{c.residual:.1e}", f"{c.time:.4g}", found))
        shown = rows if several else [row[1:] for row in rows]
        verdict = "all hold" if self.passed else f"{len(self.failed)} of {len(self.conditions)} do not hold"
        last = f"necessary conditions, to {self.tolerance:g} of their terms: {verdict}"
        return "\n".join([*table(shown), last])
