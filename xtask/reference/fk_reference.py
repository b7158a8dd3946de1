#!/usr/bin/env python3
"""Records forward kinematics and Jacobians of real arms with Pinocchio, for tests of robotc.

    python -m venv /somewhere && /somewhere/bin/pip install pin==4.1.0
    /somewhere/bin/python xtask/reference/fk_reference.py ARMS_FOLDER tests/reference/fk.json

ARMS_FOLDER holds URDF files and an INDEX.tsv with the columns `file`, `base_link` and `tip_link`. For each file and each
of three seeded configurations the result holds

    q         values of the independent joints of the chain from base to tip, in chain order
    pose      base_from_tip: the first three rows of the 4x4 matrix, row by row
    jacobian  6 x len(q), row by row: linear velocity of the tip origin, then angular velocity, both in base axes

All other joints are at zero. Mimic joints follow. Where Pinocchio cannot read a file, a plain numpy product of the
joint transforms takes its place, which `source` tells; on all other files the two are compared.
"""

import json
import math
import random
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pinocchio

CONFIGURATIONS = 3
TOLERANCE = 1e-11


def rotation_from_rpy(roll, pitch, yaw):
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (math.cos, math.sin))
    x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return z @ y @ x


def rotation_about(axis, angle):
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * (cross @ cross)


class Joint:
    """A joint as the file writes it."""

    def __init__(self, element):
        def numbers(tag, attribute, default):
            child = element.find(tag)
            text = child.get(attribute) if child is not None else None
            return [float(word) for word in text.split()] if text else default

        self.name = element.get("name")
        self.kind = element.get("type")
        self.parent = element.find("parent").get("link")
        self.child = element.find("child").get("link")
        self.parent_from_joint = np.eye(4)
        self.parent_from_joint[:3, :3] = rotation_from_rpy(*numbers("origin", "rpy", [0.0] * 3))
        self.parent_from_joint[:3, 3] = numbers("origin", "xyz", [0.0] * 3)
        axis = np.array(numbers("axis", "xyz", [1.0, 0.0, 0.0]))
        self.axis = axis / (np.linalg.norm(axis) or 1.0)
        limit = element.find("limit")
        bound = lambda name: float(limit.get(name, 0.0)) if limit is not None else 0.0
        self.lower, self.upper = bound("lower"), bound("upper")
        if self.kind == "continuous" or not self.lower < self.upper:
            self.lower, self.upper = -math.pi, math.pi
        self.lower, self.upper = max(self.lower, -2 * math.pi), min(self.upper, 2 * math.pi)
        mimic = element.find("mimic")
        self.leader = mimic.get("joint") if mimic is not None else None
        self.multiplier = float(mimic.get("multiplier", 1.0)) if mimic is not None else 1.0
        self.offset = float(mimic.get("offset", 0.0)) if mimic is not None else 0.0

    @property
    def moves(self):
        return self.kind in ("revolute", "continuous", "prismatic")


class Arm:
    """The chain from a base to a tip link."""

    def __init__(self, path, base, tip):
        root = ElementTree.parse(path).getroot()
        self.joints = {joint.name: joint for joint in map(Joint, root.findall("joint"))}
        above = {joint.child: joint for joint in self.joints.values()}
        self.base, self.tip, self.chain = base, tip, []
        link = tip
        while link != base:
            self.chain.insert(0, above[link])
            link = above[link].parent
        self.variables = [joint for joint in self.chain if joint.moves and joint.leader is None]

    def value(self, joint, q):
        """Value of a joint and its derivatives by the chain's variables."""
        slope, offset = 1.0, 0.0
        while joint.leader is not None:
            offset += slope * joint.offset
            slope *= joint.multiplier
            joint = self.joints[joint.leader]
        if joint not in self.variables:
            return offset, np.zeros(len(q))
        at = self.variables.index(joint)
        return slope * q[at] + offset, slope * np.eye(len(q))[at]

    def by_product(self, q):
        pose, moving = np.eye(4), []
        for joint in self.chain:
            pose = pose @ joint.parent_from_joint
            if not joint.moves:
                continue
            value, slopes = self.value(joint, q)
            moving.append((joint, pose.copy(), slopes))
            step = np.eye(4)
            if joint.kind == "prismatic":
                step[:3, 3] = joint.axis * value
            else:
                step[:3, :3] = rotation_about(joint.axis, value)
            pose = pose @ step
        jacobian = np.zeros((6, len(q)))
        for joint, frame, slopes in moving:
            axis = frame[:3, :3] @ joint.axis
            if joint.kind == "prismatic":
                column = np.concatenate([axis, np.zeros(3)])
            else:
                column = np.concatenate([np.cross(axis, pose[:3, 3] - frame[:3, 3]), axis])
            jacobian += np.outer(column, slopes)
        return pose, jacobian

    def by_pinocchio(self, model, q):
        data = model.createData()
        configuration = pinocchio.neutral(model)
        slopes = {}
        for name, joint in self.joints.items():
            if not joint.moves:
                continue
            index = model.getJointId(name)
            value, slope = self.value(joint, q)
            at, width = model.joints[index].idx_q, model.joints[index].nq
            configuration[at : at + width] = [math.cos(value), math.sin(value)] if width == 2 else [value]
            slopes[model.joints[index].idx_v] = slope
        pinocchio.computeJointJacobians(model, data, configuration)
        pinocchio.updateFramePlacements(model, data)
        base, tip = (model.getFrameId(link, pinocchio.BODY) for link in (self.base, self.tip))
        pose = (data.oMf[base].inverse() * data.oMf[tip]).homogeneous
        full = pinocchio.getFrameJacobian(model, data, tip, pinocchio.LOCAL_WORLD_ALIGNED)
        turn = data.oMf[base].rotation.T
        chain = {model.joints[model.getJointId(j.name)].idx_v for j in self.chain if j.moves}
        jacobian = np.zeros((6, len(q)))
        for column, slope in slopes.items():
            if column in chain:
                jacobian += np.outer(np.concatenate([turn @ full[:3, column], turn @ full[3:, column]]), slope)
        return pose, jacobian


def record(path, base, tip):
    arm = Arm(path, base, tip)
    try:
        model = pinocchio.buildModelFromUrdf(str(path))
        if model.getFrameId(base, pinocchio.BODY) >= model.nframes:
            raise ValueError(f"no frame {base}")
        source = f"pinocchio {pinocchio.__version__}"
    except (ValueError, RuntimeError) as error:
        print(f"{path.name}: {error}", file=sys.stderr)
        model, source = None, "numpy"
    stream = random.Random(path.name)
    cases = []
    for _ in range(CONFIGURATIONS):
        q = [stream.uniform(joint.lower, joint.upper) for joint in arm.variables]
        pose, jacobian = arm.by_product(q)
        if model is not None:
            ours = pose, jacobian
            pose, jacobian = arm.by_pinocchio(model, q)
            error = max(np.abs(ours[0] - pose).max(), np.abs(ours[1] - jacobian).max())
            if error > TOLERANCE:
                print(f"{path.name}: product and Pinocchio differ by {error:.1e}", file=sys.stderr)
        flat = lambda matrix: [float(x) + 0.0 for x in matrix.flatten()]
        cases.append({"q": q, "pose": flat(pose[:3]), "jacobian": flat(jacobian)})
    return {"source": source, "base": base, "tip": tip, "cases": cases}


def main():
    folder, output = Path(sys.argv[1]), Path(sys.argv[2])
    lines = (folder / "INDEX.tsv").read_text().splitlines()
    header = lines[0].split("\t")
    arms = {}
    for line in lines[1:]:
        row = dict(zip(header, line.split("\t")))
        arms[row["file"]] = record(folder / row["file"], row["base_link"], row["tip_link"])
    entries = [f"{json.dumps(name)}:{json.dumps(arm, separators=(',', ':'))}" for name, arm in sorted(arms.items())]
    output.write_text("{\n" + ",\n".join(entries) + "\n}\n")


main()
