"""The demos by name; the problem of a demo is imported only when it is run."""

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
    """A demo: its name, one line on what it shows, and its module.

    Attributes
    ----------
    name : str
        Also the name of a function in ``module``.
    module : str
        A file of this folder.
    shows : str
    example : str
        The script in ``examples/`` of the sources that plans the same or a similar problem.
    """

    name: str
    module: str
    shows: str
    example: str

    @property
    def page(self) -> str:
        """File name of the replay."""
        return f"{self.name}.html"

    def make(self) -> Demo:
        """Return the demo."""
        demo: Demo = getattr(import_module(f"robotraj.cli.demos.{self.module}"), self.name)()
        return demo


DEMOS: dict[str, DemoEntry] = {
    entry.name: entry
    for entry in (
        DemoEntry("block", "first", "A block of 1 kg is pushed 10 m in minimum time by at most 1 N.", "01_block"),
        DemoEntry("pendulum", "first", "A pendulum swings up with a motor that is too weak to lift it.", "02_pendulum"),
        DemoEntry(
            "cartpole",
            "first",
            "A cart moves 1 m and swings its pole up with least effort (Kelly, 2017).",
            "03_cartpole",
        ),
        DemoEntry(
            "acrobot",
            "first",
            "A double pendulum swings up by its elbow alone; keyframes choose the way.",
            "04_acrobot",
        ),
        DemoEntry(
            "ur5", "arms", "A ur5 moves in 1 s within its limits, its wrist at least 5 cm above the ground.", "05_ur5"
        ),
        DemoEntry("lecture", "systems", "A mass moves 10 m in minimum time, by multiple shooting.", "06_lecture"),
        DemoEntry(
            "bouncing_mass",
            "systems",
            "A mass bounces off a wall: two phases with a jump of the velocity between them.",
            "07_phases",
        ),
        DemoEntry("design", "arms", "The links of an arm are designed together with its motion.", "08_design"),
        DemoEntry(
            "multistart",
            "first",
            "The cart-pole is planned from 20 random guesses; the best optimum is kept.",
            "09_multistart",
        ),
        DemoEntry(
            "compass_walker", "planar_legs", "A compass walks down a slope without any torque.", "10_compass_gait"
        ),
        DemoEntry(
            "five_link_walking",
            "planar_legs",
            "A five-link biped walks with least effort (Kelly, 2017).",
            "11_five_link_walking",
        ),
        DemoEntry(
            "five_link_running",
            "planar_legs",
            "A five-link biped runs at 2.5 m/s: stance, flight, landing.",
            "12_five_link_running",
        ),
        DemoEntry(
            "hopper",
            "planar_legs",
            "A hopper hops; the solver finds when its foot stands (not proved).",
            "13_hopper",
        ),
        DemoEntry(
            "solo12_trot", "legs", "Solo12, a quadruped, trots at 0.3 m/s on diagonal pairs of feet.", "14_solo12"
        ),
        DemoEntry("solo12_jump", "legs", "Solo12 jumps 10 cm forward and 8 cm up.", "14_solo12"),
        DemoEntry(
            "bolt_walking",
            "legs",
            "Bolt, a biped on two points, walks: every step falls into the next one.",
            "15_biped_walking",
        ),
        DemoEntry(
            "talos_walking",
            "legs",
            "The legs of Talos walk on flat feet, with both feet down in between.",
            "15_biped_walking",
        ),
        DemoEntry(
            "five_link_stairs",
            "planar_legs",
            "A five-link biped climbs two stairs; footholds are unknowns.",
            "16_stairs",
        ),
        DemoEntry(
            "costates",
            "first",
            "Pontryagin's conditions of the block's motion, and its polish to round-off.",
            "17_costates",
        ),
        DemoEntry(
            "tool_on_a_line",
            "arms",
            "A ur5 draws a straight line in minimum time, its tool pointing down.",
            "18_tool_on_a_line",
        ),
        DemoEntry("moving_goal", "arms", "A ur5 follows a goal of its joints that moves.", "19_moving_goal"),
        DemoEntry("around_a_box", "arms", "A ur5 passes a post in minimum time.", "20_around_a_box"),
        DemoEntry("humanoid_stands_up", "legs", "A g1 with arms stands up.", "21_whole_body"),
        DemoEntry("two_arms", "arms", "Two ur5 swap sides without touching each other.", "22_two_arms"),
        DemoEntry("pick_and_place", "arms_at_work", "A ur5 carries a payload around a box.", "23_pick_and_place"),
        DemoEntry("shelf_to_shelf", "arms_at_work", "A panda moves from shelf to shelf.", "24_shelf_to_shelf"),
        DemoEntry("glass_of_water", "arms_at_work", "An arm keeps a glass of water upright.", "25_glass_of_water"),
        DemoEntry("drawn_path", "arms_at_work", "An arm follows a drawn path in minimum time.", "26_drawn_path"),
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
