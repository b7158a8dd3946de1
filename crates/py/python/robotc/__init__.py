"""robotc: from robot and task specifications to knowledge bases, inverse kinematics and plans.

    import robotc
    task = robotc.Task("specs/tasks/mug_to_shelf.task.toml")
    plan = robotc.KnowledgeBase(task, store=".robotc").session().plan(seed=1)
    plan.execute(view="out.html")

Lengths are metres and angles radians; poses are 4 x 4 matrices. Long calls release the interpreter lock and stop at Ctrl-C.
"""

from . import ik as ik
from ._robotc import (
    CompileError,
    InverseKinematics,
    KnowledgeBase,
    Motion,
    Plan,
    PlanError,
    Robot,
    Session,
    SpecificationError,
    Task,
    __version__,
    build,
    plan_build,
)

__all__ = [
    "CompileError",
    "InverseKinematics",
    "KnowledgeBase",
    "Motion",
    "Plan",
    "PlanError",
    "Robot",
    "Session",
    "SpecificationError",
    "Task",
    "__version__",
    "build",
    "plan_build",
]
