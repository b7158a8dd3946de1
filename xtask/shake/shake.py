"""Shakes grasps in MuJoCo: `python shake.py SCENE.json...`, scenes as the example `shake_scenes` of robotc-kb writes them.

The palm stands still and gravity turns instead. The object is displaced by up to 10 mm and 5 degrees, the fingers close
without gravity, then 10 m/s^2 pull for half a second in each of six directions. A grasp holds when the object is still
between the fingers, within 5 cm of where it was when they had closed. Needs `pip install mujoco numpy`.
"""

import json
import pathlib
import sys

import mujoco
import numpy as np

FRICTIONS = (0.3, 0.8)
SHIFT, TURN = 0.010, np.radians(5.0)
FORCE, TORQUE = 40.0, 1.5
STIFFNESS_SLIDING, STIFFNESS_TURNING = 4000.0, 60.0
CLOSING_SECONDS, SHAKING_SECONDS = 0.6, 0.5
STEP = 0.002


def numbers(values):
    return " ".join(repr(float(v)) for v in np.ravel(values))


def model_xml(scene, friction, object_pose):
    meshes, bodies, equalities, actuators = [], {}, [], []

    def geoms(name, parts, layer, other):
        text = ""
        for i, points in enumerate(parts):
            meshes.append(f'<mesh name="{name}_{i}" vertex="{numbers(points)}"/>')
            text += (
                f'<geom type="mesh" mesh="{name}_{i}" contype="{layer}" conaffinity="{other}" condim="4" '
                f'friction="{friction} 0.005 0.0001" solref="0.004 1"/>'
            )
        return text

    links = scene["hand"]["links"]
    leads = {}
    for i, link in enumerate(links):
        joint = link["joint"]
        text = ""
        if joint and joint["dof"] is not None:
            kind = "slide" if joint["slides"] else "hinge"
            text += f'<joint name="j{i}" type="{kind}" axis="{numbers(joint["axis"])}" damping="{5.0 if joint["slides"] else 0.05}" armature="{0.1 if joint["slides"] else 0.001}"'
            if joint["leads"]:
                leads[joint["dof"]] = i
                text += f' limited="true" range="{numbers(joint["range"])}"'
            text += "/>"
        text += geoms(f"link{i}", link["parts"], 1, 2)
        bodies[i] = (link["parent"], link["pose"], text)
    for i, link in enumerate(links):
        joint = link["joint"]
        if joint and joint["dof"] is not None and not joint["leads"]:
            lead = leads[joint["dof"]]
            equalities.append(
                f'<joint joint1="j{i}" joint2="j{lead}" polycoef="{joint["offset"]} {joint["multiplier"]} 0 0 0" '
                f'solref="0.004 1"/>'
            )
    for dof, i in sorted(leads.items()):
        limit = FORCE if links[i]["joint"]["slides"] else TORQUE
        stiff = STIFFNESS_SLIDING if links[i]["joint"]["slides"] else STIFFNESS_TURNING
        actuators.append(
            f'<position name="a{dof}" joint="j{i}" kp="{stiff}" forcelimited="true" forcerange="{-limit} {limit}"/>'
        )

    def nested(i):
        _, pose, text = bodies[i]
        inner = "".join(nested(k) for k, (parent, _, _) in bodies.items() if parent == i)
        place = f'pos="{numbers(pose["position"])}" quat="{numbers(pose["rotation"])}"'
        return f'<body name="b{i}" gravcomp="1" {place}><inertial pos="0 0 0" mass="0.1" diaginertia="1e-4 1e-4 1e-4"/>{text}{inner}</body>'

    points = np.concatenate([np.array(p) for p in scene["parts"]])
    mass, size = scene["mass"], points.max(0) - points.min(0)
    inertia = mass / 12.0 * np.maximum([size[1] ** 2 + size[2] ** 2, size[0] ** 2 + size[2] ** 2, size[0] ** 2 + size[1] ** 2], 1e-4)
    centre = (points.max(0) + points.min(0)) / 2
    thing = (
        f'<body name="object" pos="{numbers(object_pose[0])}" quat="{numbers(object_pose[1])}"><freejoint/>'
        f'<inertial pos="{numbers(centre)}" mass="{mass}" diaginertia="{numbers(inertia)}"/>'
        + geoms("object", scene["parts"], 2, 1)
        + "</body>"
    )
    return (
        f'<mujoco><compiler angle="radian"/><option timestep="{STEP}" gravity="0 0 0" cone="elliptic" impratio="10" '
        f'integrator="implicitfast"/><size memory="64M"/><asset>{"".join(meshes)}</asset><worldbody>{nested(0)}{thing}</worldbody>'
        f'<equality>{"".join(equalities)}</equality><actuator>{"".join(actuators)}</actuator></mujoco>'
    )


def quaternion_product(a, b):
    out = np.zeros(4)
    mujoco.mju_mulQuat(out, np.asarray(a, float), np.asarray(b, float))
    return out


def inverse(position, rotation):
    back = np.zeros(4)
    mujoco.mju_negQuat(back, np.asarray(rotation, float))
    moved = np.zeros(3)
    mujoco.mju_rotVecQuat(moved, -np.asarray(position, float), back)
    return moved, back


def shake(scene, grasp, friction, rng):
    """Whether the grasp holds; the fingers that touch at the end decide, and how far the object went."""
    pose = grasp["object_from_palm"]
    position, rotation = inverse(pose["position"], pose["rotation"])
    axis = rng.normal(size=3)
    noise = np.zeros(4)
    mujoco.mju_axisAngle2Quat(noise, axis / np.linalg.norm(axis), rng.uniform(-TURN, TURN))
    shift = rng.normal(size=3)
    position = position + shift / np.linalg.norm(shift) * rng.uniform(0, SHIFT)
    rotation = quaternion_product(noise, rotation)
    model = mujoco.MjModel.from_xml_string(model_xml(scene, friction, (position, rotation)))
    data = mujoco.MjData(model)
    closing = scene["hand"]["closing"]
    links = scene["hand"]["links"]
    lead_values = {}
    for i, link in enumerate(links):
        joint = link["joint"]
        if not joint or joint["dof"] is None:
            continue
        value = grasp["open"][joint["dof"]] * joint["multiplier"] + joint["offset"]
        data.joint(f"j{i}").qpos[0] = value
        if joint["leads"]:
            sign = closing[joint["dof"]]
            end = value if sign == 0 else joint["range"][1 if sign > 0 else 0]
            # A drive pushes with all its force wherever the fingers stop, so it aims beyond its range.
            beyond = FORCE / STIFFNESS_SLIDING if joint["slides"] else TORQUE / STIFFNESS_TURNING
            lead_values[joint["dof"]] = end + sign * beyond
    for dof, end in lead_values.items():
        data.actuator(f"a{dof}").ctrl[0] = end
    for _ in range(int(CLOSING_SECONDS / STEP)):
        mujoco.mj_step(model, data)
    start = data.body("object").xpos.copy()
    for way in np.vstack([np.eye(3), -np.eye(3)]):
        model.opt.gravity[:] = 10.0 * way
        for _ in range(int(SHAKING_SECONDS / STEP)):
            mujoco.mj_step(model, data)
        gone = np.linalg.norm(data.body("object").xpos - start)
        if not np.isfinite(gone) or gone > 0.05:
            return False
    touching = set()
    thing = model.body("object").id
    for contact in data.contact:
        bodies = {int(model.geom_bodyid[g]) for g in (contact.geom1, contact.geom2)}
        if thing in bodies:
            touching |= bodies - {thing}
    return len(touching) >= 2


def main(paths):
    print("| object | grasps | hold, friction 0.3 | hold, friction 0.8 | both |")
    print("|---|---|---|---|---|")
    shares = []
    for path in paths:
        scene = json.loads(pathlib.Path(path).read_text())
        grasps = scene["grasps"]
        if not grasps:
            print(f"| {scene['object']} | 0 | - | - | - |", flush=True)
            continue
        held = [
            [shake(scene, g, friction, np.random.default_rng([i, k])) for i, g in enumerate(grasps)]
            for k, friction in enumerate(FRICTIONS)
        ]
        per = [100.0 * np.mean(h) for h in held]
        shares.append(np.mean(per))
        print(
            f"| {scene['object']} | {len(grasps)} | {per[0]:.0f} % | {per[1]:.0f} % | {shares[-1]:.0f} % |", flush=True
        )
    if shares:
        print(f"| mean | | | | {np.mean(shares):.0f} % |")


if __name__ == "__main__":
    main(sys.argv[1:])
