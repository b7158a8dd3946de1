"""From a task file to a plan and its execution."""

import xml.etree.ElementTree as xml

import numpy as np
import pytest

import robotc
from conftest import BLOCK, PANDA, ROOT

ORDER = ["reach", "approach", "grasp", "lift", "carry", "lower", "release", "retreat"]


def test_task():
    task = robotc.Task(BLOCK)
    assert (task.name, task.objects, task.obstacles) == ("block", ["block"], ["table"])
    assert all(w["severity"] == "warning" for w in task.warnings)


def test_wrong_specifications_say_where(tmp_path):
    path = tmp_path / "wrong.task.toml"
    text = BLOCK.read_text().replace("../../specs/robots", PANDA.parent.as_posix())
    path.write_text(text.replace("mass = 0.2", "mass = -0.2").replace("any_yaw", "any_yow"))
    with pytest.raises(robotc.SpecificationError) as raised:
        robotc.Task(path)
    assert isinstance(raised.value, ValueError)
    errors = {d["line"]: d for d in raised.value.diagnostics if d["severity"] == "error"}
    lines = path.read_text().splitlines()
    mass = next(i for i, line in enumerate(lines, 1) if line.startswith("mass"))
    yaw = next(i for i, line in enumerate(lines, 1) if line.startswith("any_yow"))
    assert set(errors) == {mass, yaw}
    assert errors[yaw]["column"] == 1
    assert "any_yaw" in f"{errors[yaw]['hint']} {errors[yaw]['expected']}"
    for error in errors.values():
        assert error["path"].endswith("wrong.task.toml")
        assert error["code"] and error["code"] in str(raised.value)


def test_missing_file(tmp_path):
    with pytest.raises(robotc.SpecificationError, match="nowhere.robot.toml"):
        robotc.Robot(tmp_path / "nowhere.robot.toml")


def test_compiling_tells_and_keeps(compiled):
    base, told, store = compiled
    assert base.built == len({a["key"] for a in base.artefacts})
    kinds = {a["kind"] for a in base.artefacts}
    assert {"ik_solver", "convex_parts", "grasp_set", "reachability"} <= kinds
    assert {kind for kind, _, _ in told} == kinds
    assert all(0 <= fraction <= 1 for _, _, fraction in told)
    assert ("grasp_set", 1.0) in {(kind, fraction) for kind, _, fraction in told}

    again = robotc.KnowledgeBase(robotc.Task(BLOCK), store=store)
    assert again.built == 0
    assert again.artefacts == base.artefacts


def test_plan(plan):
    assert plan.complete and plan.skipped == []
    assert [s["kind"] for s in plan.segments] == ORDER
    assert plan.choices == [{"goal": 0, "object": "block", "passed_over": []}]
    assert {s["object"] for s in plan.segments} == {"block"}
    assert plan.duration == pytest.approx(sum(s["duration"] for s in plan.segments))
    assert plan.seconds > 0

    rows, joints = len(plan.times), len(plan.joint_names)
    for table in (plan.positions, plan.velocities, plan.accelerations):
        assert table.shape == (rows, joints) and table.dtype == np.float64
        assert np.isfinite(table).all()
    assert plan.times[0] == 0 and plan.times[-1] == pytest.approx(plan.duration)
    assert (np.diff(plan.times) >= 0).all()
    assert np.abs(plan.velocities[[0, -1]]).max() < 1e-9


def test_plan_keeps_limits(plan, panda):
    joints = xml.parse(PANDA.parent / "panda" / "panda.urdf").getroot().findall("joint")
    fastest = {j.get("name"): float(j.find("limit").get("velocity")) for j in joints if j.find("limit") is not None}
    speeds = np.abs(plan.velocities).max(axis=0)
    for name, speed in zip(plan.joint_names, speeds):
        assert speed <= fastest[name] * (1 + 1e-9), name
    assert speeds.max() > 0.1

    columns = [plan.joint_names.index(name) for name in panda.joint_names]
    lower, upper = panda.limits.T
    positions = plan.positions[:, columns]
    assert (positions >= lower - 1e-9).all() and (positions <= upper + 1e-9).all()


def test_plans_follow_from_their_seed(compiled, plan):
    session = compiled[0].session()
    same, other = session.plan(seed=3), session.plan(seed=4)
    for name in ("times", "positions", "velocities", "accelerations"):
        assert np.array_equal(getattr(same, name), getattr(plan, name))
    assert not (
        other.positions.shape == plan.positions.shape and np.array_equal(other.positions, plan.positions)
    )


def test_no_time_is_an_error_with_a_reason(compiled):
    with pytest.raises(robotc.PlanError, match="time limit"):
        compiled[0].session().plan(time_limit=0.0)


def test_execution_places_the_block_and_writes_files(plan, tmp_path):
    page, model = tmp_path / "out.html", tmp_path / "out.glb"
    poses = plan.execute(view=page, glb=model)
    assert list(poses) == ["block"]
    np.testing.assert_allclose(poses["block"][:3, 3], [0.45, -0.2, 0.061], atol=1e-3)
    np.testing.assert_allclose(poses["block"][2, :3], [0, 0, 1], atol=1e-3)
    assert page.read_text().lstrip().lower().startswith("<!doctype html>")
    assert model.read_bytes()[:4] == b"glTF"
    with pytest.raises(OSError, match="nowhere"):
        plan.execute(view=tmp_path / "nowhere" / "out.html")


def test_the_guide_runs(compiled, tmp_path, monkeypatch):
    """All code of the guide, in order, with the small task in place of the shipped one."""
    text = (ROOT / "docs" / "guides" / "python.md").read_text()
    code = "".join(part.split("```")[0] for part in text.split("```python\n")[1:])
    shipped, store, wrong = '"specs/tasks/mug_to_shelf.task.toml"', '".robotc"', '"wrong.task.toml"'
    assert all(word in code for word in (shipped, store, wrong))
    code = code.replace(shipped, repr(str(BLOCK))).replace(store, repr(str(compiled[2])))
    code = code.replace('"specs/robots', f'"{PANDA.parent.as_posix()}')
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(compile(code, "python.md", "exec"), names)
    assert len(names["solutions"]) > 0
    assert (tmp_path / "out.html").exists()
