from collections.abc import Sequence

from . import Array, Path

class GeneratedSolver:
    """A solver of one chain, usable at once, and its source."""

    @property
    def kind(self) -> str:
        """Class of the chain and how it is solved."""
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def free_joints(self) -> list[str]:
        """Joints whose value `solve` is given."""
    def solve(self, pose: Array, free: Sequence[float] = ()) -> Array:
        """Solutions for `base_from_tip`, shape (solutions, joints). Angles in (-pi, pi]; limits are not applied."""
    def fk(self, joints: Sequence[float]) -> Array:
        """`base_from_tip`, shape (4, 4)."""
    def write(self, path: Path) -> None:
        """Writes the solver to a file: Rust (`.rs`), C with its header beside it (`.c`), or the solution program (`.ik`)."""

def generate(
    urdf: Path, base: str, tip: str, free: Sequence[str] | None = None, tolerance: float | None = None
) -> GeneratedSolver:
    """Compiles the chain between two links of a URDF or xacro file; `CompileError` says why it cannot be solved."""
