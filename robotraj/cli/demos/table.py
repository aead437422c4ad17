"""The demos by name; a problem is imported and written out only when its demo is run."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from robotraj._util.errors import unknown_name
from robotraj._util.values import dataclass

if TYPE_CHECKING:
    from robotraj.cli.demos.demo import Demo

DEFAULT = "cartpole"


@dataclass(frozen=True)
class DemoEntry:
    """A demo: its name, which is that of a function in ``module``, and one line on what it shows."""

    name: str
    module: str
    shows: str

    @property
    def page(self) -> str:
        """File name of the replay."""
        return f"{self.name}.html"

    def make(self) -> Demo:
        """Write the problem out."""
        demo: Demo = getattr(import_module(f"robotraj.cli.demos.{self.module}"), self.name)()
        return demo


DEMOS: dict[str, DemoEntry] = {
    entry.name: entry
    for entry in (
        DemoEntry("block", "first", "A block of 1 kg is pushed 10 m in minimum time by at most 1 N."),
        DemoEntry("pendulum", "first", "A pendulum swings up with a motor that is too weak to lift it."),
        DemoEntry("cartpole", "first", "A cart moves 1 m and swings its pole up with least effort (Kelly, 2017)."),
        DemoEntry("acrobot", "first", "A double pendulum swings up by its elbow alone; keyframes choose the way."),
        DemoEntry("ur5", "arms", "A ur5 moves in 1 s within its limits, its wrist at least 5 cm above the ground."),
        DemoEntry("compass_walker", "planar_legs", "A compass walks down a slope without any torque."),
        DemoEntry("five_link_walking", "planar_legs", "A five-link biped walks with least effort (Kelly, 2017)."),
        DemoEntry("five_link_running", "planar_legs", "A five-link biped runs at 2.5 m/s: stance, flight, landing."),
        DemoEntry("five_link_stairs", "planar_legs", "A five-link biped climbs two stairs; footholds are unknowns."),
        DemoEntry("solo12_trot", "legs", "Solo12, a quadruped, trots at 0.3 m/s on diagonal pairs of feet."),
        DemoEntry("solo12_jump", "legs", "Solo12 jumps 10 cm forward and 8 cm up."),
        DemoEntry("bolt_walking", "legs", "Bolt, a biped on two points, walks: every step falls into the next one."),
        DemoEntry("talos_walking", "legs", "The legs of Talos walk on flat feet, with both feet down in between."),
    )
}


def demo_named(name: str) -> DemoEntry:
    """Look a demo up.

    Raises
    ------
    UnknownName
        Lists those that exist.
    """
    if name not in DEMOS:
        raise unknown_name("demo", name, DEMOS)
    return DEMOS[name]
