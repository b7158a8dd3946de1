from collections.abc import Mapping, Sequence

from . import InverseKinematics, Path

class GeneratedSolver(InverseKinematics):
    """A solver of one chain, usable at once, and its source."""

    @property
    def kind(self) -> str:
        """Class of the chain and how it is solved."""
    @property
    def type(self) -> str:
        """What it is asked for, such as `transform6d`."""
    def write(self, path: Path, *, calibrated: bool = False) -> None:
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
