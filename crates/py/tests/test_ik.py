"""Inverse kinematics from a URDF alone."""

from pathlib import Path

import numpy as np
import pytest

import robotc

PANDA = Path(__file__).resolve().parents[3] / "specs" / "robots" / "panda" / "panda.urdf"


@pytest.fixture(scope="module")
def solver():
    return robotc.ik.generate(PANDA, "panda_link0", "panda_link8")


def test_solutions_reach_the_pose(solver):
    assert solver.kind.startswith("7R")
    assert len(solver.free_joints) == 1
    given = solver.joint_names.index(solver.free_joints[0])
    joints = [0.1, -0.4, 0.3, -1.8, 0.2, 1.7, 0.5]
    pose = solver.fk(joints)
    solutions = solver.solve(pose, free=[joints[given]])
    assert len(solutions) > 0
    for solution in solutions:
        np.testing.assert_allclose(solver.fk(solution), pose, atol=1e-9)
    assert np.abs(solutions - joints).max(axis=1).min() < 1e-6


def test_preferences(solver):
    joints = np.array([0.1, -0.4, 0.3, -1.8, 0.2, 1.7, 0.5])
    given = solver.joint_names.index(solver.free_joints[0])
    pose, free = solver.fk(joints), [joints[given]]
    everything = solver.solve(pose, free)
    within = solver.solve(pose, free, limits=True)
    assert 0 < len(within) < len(everything)
    nearest = solver.solve(pose, free, limits=True, near=joints, max_solutions=1)
    np.testing.assert_allclose(nearest, [joints], atol=1e-6)
    box = np.stack([joints - 0.01, joints + 0.01], axis=1)
    assert len(solver.solve(pose, free, limits=box)) == 1
    wide = np.tile([-4.0, 4.0], (7, 1))
    assert len(solver.solve(pose, free, limits=wide, all_aliases=True)) > len(everything)
    with pytest.raises(ValueError, match="near: expected 7 values, got 1"):
        solver.solve(pose, free, near=[0.0])
    with pytest.raises(ValueError, match="expected 1 free values"):
        solver.solve(pose)


def test_free_intervals(solver):
    joints = [0.1, -0.4, 0.3, -1.8, 0.2, 1.7, 0.5]
    given = joints[solver.joint_names.index(solver.free_joints[0])]
    pose = solver.fk(joints)
    intervals, completeness = solver.free_intervals(pose)
    assert intervals.shape[1] == 2 and completeness.startswith("complete to width")
    assert any(low <= given <= high for low, high in intervals)
    for low, high in intervals:
        assert len(solver.solve(pose, [0.5 * (low + high)], limits=True)) > 0
    assert np.allclose(solver.nearest(pose, joints), joints, atol=1e-6)
    assert solver.swivel(pose) is None
    with pytest.raises(KeyError, match="elbow is not a free joint"):
        solver.free_intervals(pose, "elbow")


def test_closest(solver):
    joints = np.array([0.1, -0.4, 0.3, -1.8, 0.2, 1.7, 0.5])
    given = solver.joint_names.index(solver.free_joints[0])
    pose, free = solver.fk(joints), [joints[given]]
    solutions, errors, exact = solver.closest(pose, free)
    np.testing.assert_array_equal(solutions, solver.solve(pose, free, limits=True))
    assert exact.all() and not errors.any()
    pose[:3, 3] *= 3.0
    assert len(solver.solve(pose, free)) == 0
    nearest, errors, exact = solver.closest(pose, free, max_solutions=1)
    assert nearest.shape == (1, 7) and not exact[0]
    missed = np.linalg.norm(solver.fk(nearest[0])[:3, 3] - pose[:3, 3])
    np.testing.assert_allclose(errors[0, 0], missed, atol=1e-9)
    with pytest.raises(ValueError, match="radian: expected a positive length"):
        solver.closest(pose, free, radian=0.0)


def test_sources(solver, tmp_path):
    for name in ["arm.rs", "arm.c", "arm.ik"]:
        solver.write(tmp_path / name)
    assert "arm_solve(" in (tmp_path / "arm.h").read_text()
    with pytest.raises(ValueError, match="must end in"):
        solver.write(tmp_path / "arm.txt")


def test_types(solver):
    assert solver.type == "transform6d"
    elbow = robotc.ik.generate(PANDA, "panda_link0", "panda_link4", type="translation3d")
    joints = [0.1, -0.4, 0.3, -1.8]
    pose = elbow.fk(joints)
    free = [joints[elbow.joint_names.index(name)] for name in elbow.free_joints]
    anyhow = np.eye(4)
    anyhow[:3, 3] = pose[:3, 3]
    solutions = elbow.solve(anyhow, free=free)
    assert len(solutions) > 0
    for solution in solutions:
        np.testing.assert_allclose(elbow.fk(solution)[:3, 3], pose[:3, 3], atol=1e-9)
    with pytest.raises(ValueError, match='there is no type "ray"'):
        robotc.ik.generate(PANDA, "panda_link0", "panda_link4", type="ray")


def test_unknown_names():
    with pytest.raises(KeyError, match="no link nowhere"):
        robotc.ik.generate(PANDA, "panda_link0", "nowhere")
    with pytest.raises(KeyError, match="no joint elbow"):
        robotc.ik.generate(PANDA, "panda_link0", "panda_link8", free=["elbow"])
