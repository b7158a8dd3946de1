"""Forward kinematics, Jacobian and inverse kinematics against computations of this file."""

import xml.etree.ElementTree as xml

import numpy as np
import pytest

from conftest import PANDA


def turn(axis, angle):
    """Rotation about a unit axis, Rodrigues' formula."""
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def transform(rotation=np.eye(3), position=(0, 0, 0)):
    m = np.eye(4)
    m[:3, :3] = rotation
    m[:3, 3] = position
    return m


def numbers(element, name, default="0 0 0"):
    text = default if element is None else element.get(name, default)
    return np.array([float(x) for x in text.split()])


def reference_fk(values, link):
    """`root_from_link` read straight from the URDF; `values` by joint name."""
    urdf = xml.parse(PANDA.parent / "panda" / "panda.urdf").getroot()
    above = {joint.find("child").get("link"): joint for joint in urdf.findall("joint")}
    pose = np.eye(4)
    while link in above:
        joint = above[link]
        origin = joint.find("origin")
        roll, pitch, yaw = numbers(origin, "rpy")
        rotation = turn((0, 0, 1), yaw) @ turn((0, 1, 0), pitch) @ turn((1, 0, 0), roll)
        step = transform(rotation, numbers(origin, "xyz"))
        mimic = joint.find("mimic")
        name = joint.get("name") if mimic is None else mimic.get("joint")
        value = values.get(name, 0.0)
        if mimic is not None:
            value = value * float(mimic.get("multiplier", 1)) + float(mimic.get("offset", 0))
        axis = numbers(joint.find("axis"), "xyz", "1 0 0")
        if joint.get("type") in ("revolute", "continuous"):
            step = step @ transform(turn(axis, value))
        elif joint.get("type") == "prismatic":
            step = step @ transform(position=axis * value)
        pose = step @ pose
        link = joint.find("parent").get("link")
    return pose


def configurations(robot, count=20):
    lower, upper = robot.limits.T
    return np.random.default_rng(5).uniform(lower, upper, (count, len(lower)))


def test_robot(panda):
    assert panda.name == "panda"
    assert panda.arms == ["arm"]
    assert panda.joint_names == [f"panda_joint{i}" for i in range(1, 8)] + ["panda_finger_joint1"]
    assert panda.limits.shape == (8, 2)
    assert panda.limits[3].tolist() == [-3.0718, -0.0698]
    assert "8 joints" in repr(panda)


@pytest.mark.parametrize("link", ["panda_link0", "panda_link4", "panda_hand", "panda_rightfinger"])
def test_forward_kinematics(panda, link):
    for q in configurations(panda):
        expected = reference_fk(dict(zip(panda.joint_names, q)), link)
        np.testing.assert_allclose(panda.fk(q, link), expected, rtol=0, atol=1e-12)


def test_jacobian_is_the_derivative(panda):
    point, step = np.array([0.02, -0.03, 0.1034]), 1e-6
    for q in configurations(panda, 5):
        jacobian = panda.jacobian(q, "panda_hand", point=tuple(point))
        assert jacobian.shape == (6, 8)
        for column in range(8):
            d = np.zeros(8)
            d[column] = step
            before, after = panda.fk(q - d, "panda_hand"), panda.fk(q + d, "panda_hand")
            at = np.append(point, 1)
            linear = ((after - before) @ at)[:3] / (2 * step)
            spin = (after - before)[:3, :3] / (2 * step) @ panda.fk(q, "panda_hand")[:3, :3].T
            angular = [spin[2, 1], spin[0, 2], spin[1, 0]]
            np.testing.assert_allclose(jacobian[:, column], [*linear, *angular], atol=1e-8)


def test_inverse_kinematics_finds_the_configuration_again(panda, compiled):
    solver = compiled[0].inverse_kinematics("arm")
    assert solver.joint_names == panda.joint_names[:7]
    assert solver.free_joints == ["panda_joint7"]
    for q in configurations(panda):
        pose = solver.fk(q[:7])
        np.testing.assert_allclose(pose, panda.fk(q, "panda_hand"), atol=1e-12)
        solutions = solver.solve(pose, free=[q[6]])
        assert solutions.shape[1] == 7 and len(solutions) > 0
        for solution in solutions:
            np.testing.assert_allclose(solver.fk(solution), pose, atol=1e-9)
        off = (solutions - q[:7] + np.pi) % (2 * np.pi) - np.pi
        assert np.abs(off).max(axis=1).min() < 1e-6


def test_out_of_reach_has_no_solutions(compiled):
    far = transform(position=(3, 0, 0))
    assert compiled[0].inverse_kinematics().solve(far, free=[0.0]).shape == (0, 7)


def test_wrong_arguments(panda, compiled):
    solver = compiled[0].inverse_kinematics()
    with pytest.raises(KeyError, match="did you mean panda_hand"):
        panda.fk(np.zeros(8), "panda_hnd")
    with pytest.raises(ValueError, match="expected 8 joint values, got 7"):
        panda.fk(np.zeros(7), "panda_hand")
    with pytest.raises(ValueError, match="panda_joint7"):
        solver.solve(np.eye(4))
    with pytest.raises(ValueError, match="4 x 4"):
        solver.solve(np.eye(3), free=[0.0])
    with pytest.raises(ValueError, match="rigid"):
        solver.solve(2 * np.eye(4), free=[0.0])
    with pytest.raises(KeyError, match="leg"):
        compiled[0].inverse_kinematics("leg")
