"""Free motions: goals, things held, constraints, validation, progress."""

import json

import numpy as np
import pytest

import robotc


@pytest.fixture(scope="module")
def session(compiled):
    return compiled[0].session()


def turned(session, by=0.4):
    q = session.start.copy()
    q[0] += by
    return q


def test_goals(session):
    near, far = turned(session), turned(session, 9.0)
    motion = session.plan_motion(goals=np.array([far, near]), seed=3)
    assert motion.goal == 1 and motion.joint_names == session.joint_names
    assert motion.path.shape[1] == len(session.joint_names)
    np.testing.assert_array_equal(motion.path[0], session.start)
    np.testing.assert_array_equal(motion.path[-1], near)
    assert motion.length > 0 and motion.seconds > 0
    assert motion.times[-1] == pytest.approx(motion.duration)
    assert motion.positions.shape == motion.velocities.shape == (len(motion.times), motion.path.shape[1])
    again = session.plan_motion(goals=np.array([far, near]), seed=3)
    np.testing.assert_array_equal(motion.path, again.path)
    assert session.validate(motion.path) is None


def test_races(session):
    goals = np.array([turned(session)])
    first = session.plan_motion(goals=goals, seed=5, race=3)
    np.testing.assert_array_equal(first.path, session.plan_motion(goals=goals, seed=5, race=3).path)
    assert session.validate(first.path) is None
    with pytest.raises(ValueError, match="race is 0"):
        session.plan_motion(goals=goals, race=0)


def test_poses(session):
    pose = session.tool(session.start)
    pose[2, 3] += 0.04
    away = pose.copy()
    away[0, 3] += 9.0
    motion = session.plan_motion(poses=[away, pose])
    assert motion.goal == 1
    np.testing.assert_allclose(session.tool(motion.path[-1]), pose, atol=1e-6)


def test_documents(session):
    problem = json.loads(session.motion_problem())
    problem["goals"] = [list(turned(session))]
    upright = {"kind": "upright", "tool_from_object": {"position": [0, 0, 0], "orientation": [1, 0, 0, 0]}, "tilt": 0.5}
    motion = session.plan_motion(problem={**problem, "constraint": upright})
    for q in motion.path:
        assert session.tool(q)[2, 2] < -np.cos(0.5) + 1e-6
    text = session.plan_motion(problem=json.dumps(problem))
    np.testing.assert_allclose(text.path[-1], turned(session), atol=1e-12)
    with pytest.warns(UserWarning, match="`sed` is not known, and ignored; did you mean `seed`"):
        session.plan_motion(problem={**{k: v for k, v in problem.items() if k != "seed"}, "sed": 3})


def test_contacts(session):
    down = session.start.copy()
    down[1] += 1.6
    contact = session.validate(np.array([session.start, down]))
    assert contact is not None and contact["edge"] == 0 and 0 < contact["fraction"] <= 1
    assert contact["body"] == "table" and contact["link"] and contact["depth"] >= 0
    assert contact["link"] in contact["message"]
    # What is held collides as well.
    tool_from_block = np.eye(4)
    tool_from_block[2, 3] = 0.3
    held = session.validate(np.array([session.start, down]), held=("block", tool_from_block))
    assert held["fraction"] < contact["fraction"] and "block" in (held["link"], held["body"])
    with pytest.raises(robotc.PlanError, match="touches table"):
        session.plan_motion(goals=np.array([down]))
    with pytest.raises(ValueError, match="no body blok; did you mean block"):
        session.plan_motion(goals=np.array([down]), bodies={"blok": np.eye(4)})


def test_progress_and_cancellation(session):
    goal, told = np.array([turned(session)]), []
    session.plan_motion(goals=goal, progress=told.append)
    assert told and told[0] >= 0
    with pytest.raises(robotc.PlanError, match="cancelled"):
        session.plan_motion(goals=goal, progress=lambda _: False)

    def fails(_):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        session.plan_motion(goals=goal, progress=fails)
    with pytest.raises(robotc.PlanError, match="time limit"):
        session.plan_motion(goals=goal, time_limit=0.0)


def test_options(session, plan):
    options = json.loads(session.options())
    assert options["margin"] > 0
    same = session.plan(seed=3, options="{}")
    np.testing.assert_array_equal(same.positions, plan.positions)
    with pytest.warns(UserWarning, match="`margn` is not known, and ignored; did you mean `margin`"):
        session.plan(options='{"margn": 1}')


def test_what_a_camera_sees(session):
    way = np.array([turned(session, -0.6), turned(session, 0.6)])
    assert session.validate(way) is None
    tool = session.tool(session.start)
    grid = np.stack(np.meshgrid(np.linspace(-0.03, 0.03, 7), np.linspace(-0.03, 0.03, 7), [0.0]), -1).reshape(-1, 3)
    grid = np.vstack([grid, [np.nan, 0.0, 0.0]])
    seen = session.with_cloud("scan", grid, 0.01, pose=tool)
    met = seen.validate(way)
    assert met["body"] == "scan" and met["depth"] > 0
    assert session.validate(way) is None, "the first session stays as it was"
    around = seen.plan_motion(start=way[0], goals=way[1:])
    assert seen.validate(around.path) is None
    # Points on the robot where it starts are its own.
    own = session.with_cloud("scan", tool[:3, 3][None], 0.01, without_robot=0.2)
    assert own.validate(session.start[None]) is None
    # The same name again takes its place.
    assert seen.with_cloud("scan", grid + 9.0, 0.01).validate(way) is None
    hills = np.full((20, 20), tool[2, 3] + 0.02)
    hills[:, 10:] = np.nan
    pose = np.eye(4)
    pose[:2, 3] = tool[:2, 3] - [0.05, 0.1]
    met = session.with_heights("hill", hills, (0.01, 0.01), floor=-1.0, pose=pose).validate(way)
    assert met["body"] == "hill"
    with pytest.raises(ValueError, match="shape"):
        session.with_cloud("scan", np.zeros((3, 2)), 0.01)
    with pytest.raises(ValueError, match="radius"):
        session.with_cloud("scan", grid, 0.0)
    with pytest.raises(ValueError, match="floor"):
        session.with_heights("hill", np.zeros((2, 2)), (0.1, 0.1), floor=1.0)
