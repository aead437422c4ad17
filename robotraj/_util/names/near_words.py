"""Words that users write for names of robotraj: by spelling ``tolerence``, by meaning ``goal`` for ``end``."""

from __future__ import annotations

import re
from collections.abc import Iterable
from difflib import get_close_matches

WORDS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[0-9]+")
"""Words of a name such as ``leg_left_1_joint``, ``FL_HAA``, ``LThighPitch`` or ``RFAnkle``."""

_MEANINGS = tuple(
    frozenset(line.split())
    for line in """
    q position positions pos angle angles configuration joint_positions
    v velocity velocities vel speed dq qd qdot joint_velocities
    a acceleration accelerations acc ddq qdd qddot
    tau effort torque torques joint_torques
    forces force wrench contact_forces
    contacts forces external_forces thrusters
    position center centre origin xyz pos translation location
    quaternion orientation rotation quat rot rpy euler
    sides size sizes extents half_extents dimensions dims
    radius r
    length height h l
    start initial begin beginning from q0 x0 q_start
    end goal target final finish to qf xf q_goal q_end
    duration time times t tf total_time horizon t_final mintime min_time minimum_time minimumtime least_time
    objective objectives cost costs criterion
    effort energy min_effort minimum_effort mineffort minenergy minimumeffort
    framespeed toolspeed tcpspeed speedlimit maxspeed cartesianspeed
    constraints constraint obstacles obstacle collision collisions
    limits bounds joint_limits velocity acceleration effort max_velocity velocity_limit velocity_limits
    tolerance tol rtol atol eps accuracy precision
    mesh n nodes knots intervals grid num_nodes segments
    guess initial_guess warm_start init x0
    time_limit timeout max_time budget
    margin distance clearance padding buffer safety
    ground terrain floor
    friction mu friction_coefficient
    contact friction mu friction_coefficient
    bodies payload payloads load gripper attached carried
    executor workers worker processes jobs n_jobs num_workers pool parallel cores
    progress verbose quiet silent verbosity print_level disp
    root base base_type floating_base
    floating free free_flyer freeflyer mobile
    locked frozen locked_joints
    actuated motors actuators motor
    package_dirs package_dir packages mesh_dir mesh_dirs package_path
    joint_names joints names
    frame_names frames links link_names
    frame link body link_name frame_name
    traces trace trail trails
    objective_value objective cost value fun
    plan solve optimize optimise
    load load_urdf load_robot from_urdf
    replay visualize visualise animate show view display
    validate verify simulate
    box cube cuboid block
    panda franka emika fr3
    iiwa kuka
    solo12 solo
    """.strip().splitlines()
)
"""Each line holds words of one meaning; some of them are names."""

_SIDES, _ENDS = {"l": "left", "r": "right"}, {"f": "front", "h": "rear", "b": "rear"}
_SHORT = (
    {side: {word} for side, word in _SIDES.items()}
    | {"fore": {"front"}, "hind": {"rear"}, "back": {"rear"}, "rl": {"rear", "left"}, "rr": {"rear", "right"}}
    | {a + b: {_SIDES[s], _ENDS[e]} for s in _SIDES for e in _ENDS for a, b in ((s, e), (e, s))}
)
"""What the short words of a robot's sides and corners mean: l, fl, LH, rr."""
_SHARED = 0.6
"""Least share of all words of two names that both have, for names of other order or of abbreviated words."""


def near_names(name: str, valid: Iterable[str], likeness: float = 0.5) -> list[str]:
    """Return the valid names that are nearest to a name, those of like spelling first, then those of like meaning.

    Names that differ in capitals only are alike. ``likeness`` is the least ratio of equal letters, as of difflib.

    Examples
    --------
    >>> near_names("tolerence", ["mesh", "tolerance"])
    ['tolerance']
    >>> near_names("goal", ["start", "end"])
    ['end']
    >>> near_names("foot_front_left", ["root_joint", "FL_foot", "FR_foot"])
    ['FL_foot']
    """
    names = list(valid)
    same = _of_same_words(name, names)
    if same:
        return same
    valid = names
    plain: dict[str, list[str]] = {}
    for each in valid:
        plain.setdefault(each.lower(), []).append(each)
    word = name.lower()
    alike = same_meaning(word)
    near = get_close_matches(word, plain, n=3, cutoff=likeness)
    meant = [each for each in plain if each in alike]
    # The meaning of a known word is known: faintly similar letters do not matter.
    close = get_close_matches(word, near, n=3, cutoff=0.8) if alike else near
    return [each for key in dict.fromkeys((*close, *meant)) for each in plain[key]]


def same_meaning(name: str) -> set[str]:
    """Return the other words of the meanings that a word has; empty for a word that is not known."""
    word = name.lower()
    return {known for meaning in _MEANINGS if word in meaning for known in meaning} - {word}


def _of_same_words(name: str, names: Iterable[str]) -> list[str]:
    """Return the names that share most words with a name of several words, in any order and abbreviated as feet are."""
    words = _words(name)
    shares = {each: len(words & known) / len(words | known) for each in names if len(known := _words(each)) > 1}
    most = max(shares.values(), default=0.0)
    return [each for each, share in shares.items() if share == most] if len(words) > 1 and most > _SHARED else []


def _words(name: str) -> frozenset[str]:
    found = [word.lower() for word in WORDS.findall(name)]
    return frozenset().union(*(_SHORT.get(word, {word}) for word in found))
