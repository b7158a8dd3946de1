from collections.abc import Mapping, Sequence

from . import Array, Path

class GeneratedSolver:
    """A solver of one chain, usable at once, and its source."""

    @property
    def kind(self) -> str:
        """Class of the chain and how it is solved."""
    @property
    def type(self) -> str:
        """What it is asked for, such as `transform6d`."""
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def free_joints(self) -> list[str]:
        """Joints whose value `solve` is given, then what the type has given besides."""
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
    ) -> tuple[Array, float]:
        """Values of a free joint, by default the first, for which `base_from_tip` has solutions within limits.

        Intervals, shape (intervals, 2), ascending, and how wide what was missed between them can be. `free` gives the values of the free
        joints when there are several.
        """
    def fk(self, joints: Sequence[float]) -> Array:
        """`base_from_tip`, shape (4, 4)."""
    def write(self, path: Path) -> None:
        """Writes the solver to a file: Rust (`.rs`), C with its header beside it (`.c`), or the solution program (`.ik`)."""

def generate(
    urdf: Path,
    base: str,
    tip: str,
    free: Sequence[str] | None = None,
    tolerance: float | None = None,
    type: str = "transform6d",
    *,
    packages: Mapping[str, Path] | None = None,
    arguments: Mapping[str, str] | None = None,
) -> GeneratedSolver:
    """Compiles the chain between two links of a URDF or xacro file; `CompileError` says why it cannot be solved.

    `type` says what of a pose is asked for: `transform6d`, `translation3d`, `translationdirection5d` and so on as listed in the guide of
    inverse kinematics, or `auto`: what the joints suggest. `packages` says where ROS packages are; `arguments` are values for the arguments
    of a xacro file.
    """
