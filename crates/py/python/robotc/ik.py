"""Inverse kinematics of a chain, from a URDF alone.

    from robotc import ik
    solver = ik.generate("arm.urdf", "base_link", "tool0")
    for joints in solver.solve(pose):
        ...
    solver.write("arm_ik.c")
"""

from ._robotc import _generate_ik as generate

__all__ = ["generate"]
