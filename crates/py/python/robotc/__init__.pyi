from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Path = str | PathLike[str]

__version__: str

class Diagnostic(TypedDict):
    """A finding about a specification."""

    severity: str
    code: str
    message: str
    expected: str | None
    hint: str | None
    path: str | None
    line: int | None
    column: int | None

class Artefact(TypedDict):
    """An artefact of a knowledge base."""

    kind: str
    subject: str
    key: str | None
    content: str | None

class Step(TypedDict):
    """An artefact to be computed; `shards` is the largest number of workers that can share it."""

    recipe: str
    kind: str
    subjects: list[str]
    inputs: list[str]
    shards: int
    level: int

class Segment(TypedDict):
    """A motion of a plan; `kind` is preshape, reach, approach, grasp, lift, carry, lower, release, retreat, open, fold or drive."""

    kind: str
    object: str
    duration: float

class Choice(TypedDict):
    """What was taken for goal number `goal` of a task. `passed_over` says of each other object that would have done how many of its
    grasps were looked at, and why these were rejected."""

    goal: int
    object: str
    passed_over: list[str]

class Contact(TypedDict):
    """Where a path first meets something: on the way from state `edge` to the next. `link` and `body` are empty, and `depth` zero,
    when a limit is exceeded or a constraint violated."""

    edge: int
    fraction: float
    q: Array
    link: str
    body: str
    depth: float
    message: str

class SpecificationError(ValueError):
    """A specification cannot be used; `diagnostics` holds everything that was found."""

    diagnostics: list[Diagnostic]

class CompileError(Exception):
    """An artefact could not be computed."""

class PlanError(Exception):
    """The planner found no plan; the message says why, with counts."""

class Robot:
    """A checked robot specification with its kinematics."""

    def __init__(self, path: Path) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def warnings(self) -> list[Diagnostic]: ...
    @property
    def joint_names(self) -> list[str]:
        """Independently driven joints, in the order of joint vectors."""
    @property
    def link_names(self) -> list[str]: ...
    @property
    def arms(self) -> list[str]: ...
    @property
    def limits(self) -> Array:
        """Lower and upper limit of each joint, shape (joints, 2); infinite for continuous joints."""
    def fk(self, q: Array, link: str) -> Array:
        """`root_from_link`, shape (4, 4)."""
    def jacobian(self, q: Array, link: str, point: Sequence[float] = (0.0, 0.0, 0.0)) -> Array:
        """Linear, then angular velocity of a point of the link in root axes, shape (6, joints)."""

class Task:
    """A checked task specification."""

    def __init__(self, path: Path) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def warnings(self) -> list[Diagnostic]: ...
    @property
    def objects(self) -> list[str]: ...
    @property
    def obstacles(self) -> list[str]: ...

def plan_build(subject: Robot | Task) -> list[Step]:
    """The artefacts that a subject needs, inputs first. Nothing is computed."""

def build(subject: Robot | Task, recipe: str, depot: str, store: Path, shard: str = "0/1") -> bool:
    """Computes one artefact, or the shard "i/n" of it, with what the folder `depot` has, and puts it there.

    True when the artefact is complete, False when shards of others are missing. `robotc.distributed` runs many of these.
    """

class InverseKinematics:
    """All joint vectors of an arm that reach a pose."""

    @property
    def joint_names(self) -> list[str]: ...
    @property
    def free_joints(self) -> list[str]:
        """Joints whose value `solve` is given, then what the goal type has given besides."""
    def solve(
        self,
        pose: Array,
        free: Sequence[float] = (),
        *,
        limits: bool | Sequence[Sequence[float]] | Array = False,
        near: Sequence[float] | Array | None = None,
        weights: Sequence[float] | Array = (),
        all_aliases: bool = False,
        max_solutions: int | None = None,
    ) -> Array:
        """Solutions for `base_from_tip`, shape (solutions, joints).

        By default all of them, angles in (-pi, pi], limits not applied. `limits` keeps those within the described limits
        (`True`) or the given ones, shape (joints, 2); angles are the alias within them that is nearest to `near`, or with
        `all_aliases` every one. `near` puts solutions nearest to it first, in a distance whose terms are weighted by `weights`.
        No more than `max_solutions` are returned; without `near` the search stops when they are found.
        """
    def free_intervals(
        self,
        pose: Array,
        joint: str | None = None,
        free: Sequence[float] = (),
        limits: bool | Sequence[Sequence[float]] | Array = True,
    ) -> tuple[Array, str]:
        """Values of a free joint, by default the first, for which `base_from_tip` has solutions within limits.

        Intervals, shape (intervals, 2), ascending, and how much of the truth they are: "complete", "complete to width 1e-6", or "sampled in
        steps of ...". `free` gives the values of the free joints when there are several.
        """
    def nearest(
        self,
        pose: Array,
        near: Sequence[float] | Array,
        joint: str | None = None,
        free: Sequence[float] = (),
        limits: bool | Sequence[Sequence[float]] | Array = True,
        weights: Sequence[float] | Array = (),
    ) -> Array | None:
        """The solution within limits that is nearest to `near`, over all values of a free joint; `None` when there is none."""
    def closest(
        self,
        pose: Array,
        free: Sequence[float] = (),
        *,
        limits: bool | Sequence[Sequence[float]] | Array = True,
        near: Sequence[float] | Array | None = None,
        max_solutions: int | None = None,
        radian: float = 0.2,
    ) -> tuple[Array, Array, Array]:
        """The joint vectors that come nearest to `base_from_tip`: least squares, for poses that are out of reach.

        Joint vectors, shape (n, joints), what each misses in metres and radians, shape (n, 2), and whether it is a solution all the same, shape
        (n,). If the pose has solutions within limits they are returned, else local minima, the best first, where an error of `radian` metres
        counts as much as one of one radian; then all joints move, the free ones too.
        """
    def swivel(
        self,
        pose: Array,
        limits: bool | Sequence[Sequence[float]] | Array = True,
    ) -> list[tuple[float, int, int, list[list[float]]]] | None:
        """Of an arm whose shoulder and wrist are spherical: the branches that keep the limits.

        Each with the value of the elbow, the sides of the second and of the sixth joint (1, -1, or 0 where the axes beside them line up), and the
        intervals of the swivel angle about the line from shoulder to wrist. `None` for other arms.
        """
    def fk(self, joints: Sequence[float]) -> Array:
        """`base_from_tip`, shape (4, 4)."""

class KnowledgeBase:
    """Everything that was compiled for a robot or a task."""

    def __init__(
        self,
        subject: Robot | Task,
        store: Path,
        progress: Callable[[str, str, float], object] | None = None,
    ) -> None: ...
    @property
    def built(self) -> int:
        """Number of artefacts that were computed; the others were in the store."""
    @property
    def artefacts(self) -> list[Artefact]: ...
    def inverse_kinematics(self, arm: str | None = None) -> InverseKinematics: ...
    def session(self) -> Session: ...

class Session:
    """A task with its artefacts, ready to be planned."""

    @property
    def joint_names(self) -> list[str]:
        """The joints that free motions are of."""
    @property
    def start(self) -> Array:
        """Their values where the task starts."""
    def tool(self, q: Array) -> Array:
        """`world_from_tool`, shape (4, 4)."""
    def with_cloud(
        self,
        name: str,
        points: Array,
        radius: float,
        pose: Array | None = None,
        without_robot: float | None = None,
    ) -> Session:
        """The same session with measured points, shape (n, 3), as an obstacle, or in the place of the obstacle of this name.

        Each point is a ball of `radius` metres; those that are no numbers are left out. `pose` is `world_from_points`. Points within
        `without_robot` metres of the robot where the task starts are its own and left out.
        """
    def with_heights(
        self,
        name: str,
        heights: Array,
        spacing: tuple[float, float],
        floor: float | None = None,
        pose: Array | None = None,
    ) -> Session:
        """The same session with measured heights, shape (rows, columns), as an obstacle, or in the place of the obstacle of this name.

        Columns are `spacing[0]` metres apart along x, rows `spacing[1]` along y. It is solid down to `floor`; NaN is a hole. `pose` is
        `world_from_heights`, the frame of the first sample.
        """
    def plan(self, seed: int | None = None, time_limit: float = 30.0, options: str | None = None) -> Plan:
        """Plans the whole task: picking, placing, doors. `options` is JSON with what differs from `options()`."""
    def options(self) -> str:
        """The options of `plan`, as JSON."""
    def motion_problem(self) -> str:
        """A problem of free motion with all defaults and no goal, as JSON."""
    def plan_motion(
        self,
        goals: Array | None = None,
        poses: Sequence[Array] = ...,
        start: Array | None = None,
        held: tuple[str, Array] | None = None,
        bodies: Mapping[str, Array] = ...,
        joints: Mapping[str, float] = ...,
        problem: str | Mapping[str, object] | None = None,
        seed: int | None = None,
        time_limit: float | None = None,
        progress: Callable[[float], object] | None = None,
        race: int | None = None,
    ) -> Motion:
        """A free motion of the arm to one of many goals.

        `goals` are joint values, shape (goals, joints), `poses` are `world_from_tool`. `held` is an object with its pose in
        the tool frame, `bodies` where others are, `joints` what those joints are at that are not planned for. `problem` is a document of
        docs/guides/planners.md, with constraints, margin and limits. `progress` is told the seconds so far; the search ends when it
        returns False or raises. `race` searches with as many seeds at once, on all processors; the path does not depend on how many there are.
        """
    def validate(
        self,
        path: Array,
        held: tuple[str, Array] | None = None,
        bodies: Mapping[str, Array] = ...,
        joints: Mapping[str, float] = ...,
        problem: str | Mapping[str, object] | None = None,
    ) -> Contact | None:
        """Where a path, shape (states, joints), first meets something, exceeds a limit or leaves the constraint of `problem`."""

class Motion:
    """A free motion of an arm."""

    @property
    def joint_names(self) -> list[str]: ...
    @property
    def path(self) -> Array:
        """States from start to goal, straight in between, shape (states, joints)."""
    @property
    def goal(self) -> int:
        """Number of the goal that is reached: goals count first, then poses."""
    @property
    def length(self) -> float:
        """In the metric of the arm."""
    @property
    def seconds(self) -> float:
        """How long planning took."""
    @property
    def duration(self) -> float: ...
    @property
    def times(self) -> Array:
        """Of the knots of the fastest motion along the path, seconds."""
    @property
    def positions(self) -> Array:
        """At these times, shape (knots, joints)."""
    @property
    def velocities(self) -> Array: ...

class Plan:
    """A certified plan with the motion of all joints."""

    @property
    def complete(self) -> bool: ...
    @property
    def skipped(self) -> list[str]:
        """Why goals are left out; empty when the plan is complete."""
    @property
    def seconds(self) -> float:
        """How long planning took."""
    @property
    def duration(self) -> float:
        """Seconds of motion."""
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def times(self) -> Array: ...
    @property
    def positions(self) -> Array:
        """Shape (times, joints)."""
    @property
    def velocities(self) -> Array: ...
    @property
    def accelerations(self) -> Array: ...
    @property
    def segments(self) -> list[Segment]: ...
    @property
    def choices(self) -> list[Choice]:
        """What was taken for each goal reached, in order."""
    def execute(self, view: Path | None = None, glb: Path | None = None) -> dict[str, Array]:
        """Final pose of each object, after a kinematic simulation; writes a replay page or a binary glTF file."""
