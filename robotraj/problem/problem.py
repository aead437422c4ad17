"""Problems: frozen values of phases and links, with checks and with a printed table of all rows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import fields
from html import escape
from typing import TYPE_CHECKING

from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import ENTRIES, OneLine, brief, table
from robotraj._util.values import dataclass
from robotraj.problem.clearance.swinging_feet import with_feet_above_ground
from robotraj.problem.links.base import BoundLink, Link
from robotraj.problem.links.continuity import running_on
from robotraj.problem.phase import Phase
from robotraj.problem.printing import interval_text

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from robotraj.problem.phase_fields import PhaseChanges

_MISSING_AS = {
    "subject": ("the equations ", "the shapes "),
    "constraints": ("constraint ",),
    "objective": ("objective ",),
}
"""Beginnings of the entries of ``Problem.missing`` by field of the phase."""


@dataclass(frozen=True, eq=False)
class Problem(OneLine):
    """Phases and the links between them, which one NLP represents.

    Parameters
    ----------
    phases : Phase or sequence of Phase
    links : Link or sequence of Link
        ``rt.Continuity(0, 1)`` joins the end of phase 0 to the start of phase 1. A phase without such a link
        starts when the one before ends; its states are continuous only where a link imposes it. Phases get the rows
        ``rt.GroundClearance`` of feet that other phases hold, where they state no clearance of them.
    missing : sequence of str
        Parts of the problem that a file does not hold, as ``load_solution`` lists them; empty for problems written in
        Python.
    """

    phases: Sequence[Phase]
    links: Sequence[Link] = ()
    missing: Sequence[str] = ()

    def __post_init__(self) -> None:
        for which, one, several in (("phases", Phase, "rt.Phase values"), ("links", Link, "links, [] for none")):
            given = getattr(self, which)
            if not isinstance(given, one | Iterable):
                raise InputError(f"The {which} of a problem are a list of {several}; got {type(given).__name__}.")
        phases = (self.phases,) if isinstance(self.phases, Phase) else tuple(self.phases)
        if not phases:
            raise InputError("The problem has no phase; give at least one.")
        for phase in phases:
            if not isinstance(phase, Phase):
                raise InputError(f"A problem is made of rt.Phase values; got {type(phase).__name__}.")
        links = (self.links,) if isinstance(self.links, Link) else tuple(self.links)
        object.__setattr__(self, "phases", phases)
        object.__setattr__(self, "links", links)
        _ = self.bound_links
        above = with_feet_above_ground(phases, links)
        if any(one is not other for one, other in zip(above, phases, strict=True)):
            object.__setattr__(self, "phases", above)
            self.__dict__.pop("bound_links", None)

    @cached_property
    def bound_links(self) -> tuple[BoundLink, ...]:
        """Every link bound to its phases, and continuity of time where no link fixes the start of a phase."""
        for link in self.links:
            if not isinstance(link, Link):
                raise InputError(f"{link!r} in the links of the problem is not a link such as rt.Continuity(0, 1).")
        bound = tuple(link.bind(self.phases) for link in self.links)
        return bound + running_on(self.phases, bound)

    @property
    def has_footholds(self) -> bool:
        """Return whether the robot stands on a contact with a foothold in some phase."""
        return any(contact.anchors and contact.stands for phase in self.phases for contact in phase.bound_contacts)

    def with_(self, **changes: Unpack[PhaseChanges]) -> Problem:
        """Return the problem with another start, end or other field of its phase.

        Parameters
        ----------
        **changes
            Fields of ``rt.Phase``. With several phases, ``start`` is that of the first and ``end`` that of the last
            one; change others by ``phase.with_`` and a new problem.

        Examples
        --------
        >>> again = rt.plan(problem.with_(end=rt.State(q=goal, v=0)), mesh, guess=solution)  # doctest: +SKIP
        """
        phases = list(self.phases)
        unknown = set(changes) - {entry.name for entry in fields(Phase)}
        if len(phases) > 1 and not unknown and not set(changes) <= {"start", "end"}:
            name = sorted(set(changes) - {"start", "end"})[0]
            raise InputError(
                f"problem.with_({name}=...) is ambiguous: the problem has {len(phases)} phases; use "
                "phase.with_(...) and make a new problem."
            )
        if len(phases) == 1 or unknown:
            phases = [phases[0].with_(**changes)]
        else:
            if "start" in changes:
                phases[0] = phases[0].with_(start=changes["start"])
            if "end" in changes:
                phases[-1] = phases[-1].with_(end=changes["end"])
        # A field that is given now is no longer missing.
        given = tuple(start for name in changes for start in _MISSING_AS.get(name, ()))
        return Problem(phases, self.links, tuple(name for name in self.missing if not name.startswith(given)))

    def __repr__(self) -> str:
        names = brief(tuple(phase.name for phase in self.phases)).strip("(),")
        what = names if len(self.phases) <= ENTRIES else f"{len(self.phases)} phases"
        return f"<Problem of {what}: {len(self.links)} link{'s' * (len(self.links) != 1)}>"

    @property
    def grouped(self) -> str:
        """The text of ``print(problem)`` in which rows of one quantity, time and bounds share a line."""
        bounds: dict[tuple[str, str], list[str]] = {}
        for link, label, *line in self._links:
            bounds.setdefault((link.name, line[0]), []).append(label)
        cells = [
            (f"link {name}", labels[0] if len(labels) == 1 else f"{labels[0]} (+{len(labels) - 1})", interval)
            for (name, interval), labels in bounds.items()
        ]
        return "\n\n".join([phase.grouped for phase in self.phases] + ["\n".join(table(cells))] * bool(cells))

    def __str__(self) -> str:
        cells = [(f"link {link.name}", *line) for link, *line in self._links]
        return "\n\n".join([str(phase) for phase in self.phases] + ["\n".join(table(cells))] * bool(cells))

    def _repr_html_(self) -> str:
        cells = "".join(
            f"<tr><td>{escape(link.name)}</td>{''.join(f'<td>{escape(cell)}</td>' for cell in line)}</tr>"
            for link, *line in self._links
        )
        links = f"<div><b>links</b><table>{cells}</table></div>" if cells else ""
        return "".join(phase._repr_html_() for phase in self.phases) + links

    @property
    def _links(self) -> list[tuple[BoundLink, str, str, str]]:
        """Every row of a link: the link, the row's label, its bounds and its unit."""
        return [
            (link, row.label, interval_text(row.lower, row.upper), row.unit)
            for link in self.bound_links
            for row in link.rows
        ]
