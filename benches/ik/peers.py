"""Generated C beside `ssik` and `EAIK`, from Python.

    python peers.py [POSES] [--write FILE.md]

Needs numpy, `ssik` 8.2.0, `EAIK` 1.2.2, a C compiler, and what `cargo run --bin generate` has written.
"""

import ctypes
import importlib
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

GENERATED = Path(__file__).parent / "generated"
# Arms that `ssik` ships; it sweeps the redundancy of seven joints, which is another question.
SSIK = {"kr6": "kuka.kr6_r900_ik", "ur5e": "universal_robots.ur5e_ik", "crx10ia": "fanuc.crx10ia_ik", "xarm6": "ufactory.xarm6_ik"}
ABOUT = """The same joint vectors, the solvers by turns in one process. Ours is the C source, compiled and called through ctypes. Every solver is
called once for each pose; its way of calling is part of its time. `ssik` 8.2.0 (native) solves its own arm of the same name without limits,
at poses of its own forward kinematics; `EAIK` 1.2.2 the same geometry as ours."""
FLAGS = ["-O3", "-ffp-contract=off", "-shared", "-fPIC"]
CALLS = 3


def axis_turn(axis, angle):
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], dtype=float)
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


class Ours:
    """A generated C source."""

    def __init__(self, arm, folder):
        name, self.axes, self.tip = arm["name"], arm["axes"], np.array(arm["tip"])
        library = Path(folder) / f"{name}.so"
        subprocess.run(["cc", *FLAGS, str(GENERATED / f"{name}.c"), "-o", str(library), "-lm"], check=True)
        self.call = getattr(ctypes.CDLL(str(library)), f"{name}_solve")
        self.joints = len(self.axes)

        class Solutions(ctypes.Structure):
            _fields_ = [("values", ctypes.c_double * (16 * self.joints)), ("count", ctypes.c_int)]

        self.found = Solutions()

    def forward(self, q):
        pose = np.eye(4)
        for (axis, point), angle in zip(self.axes, q):
            step = np.eye(4)
            step[:3, :3] = axis_turn(axis, angle)
            step[:3, 3] = np.array(point) - step[:3, :3] @ np.array(point)
            pose = pose @ step
        tip = np.eye(4)
        tip[:3, 3] = self.tip
        return pose @ tip

    def load(self, pose):
        return (ctypes.c_double * 12)(*pose[:3, :3].ravel(), *pose[:3, 3])

    def solve(self, pose):
        self.call(pose, None, ctypes.byref(self.found))

    def answers(self):
        values = np.ctypeslib.as_array(self.found.values).reshape(16, self.joints)
        return values[: self.found.count].copy()


class Ssik:
    """An arm that ships with `ssik`."""

    def __init__(self, module):
        self.arm = importlib.import_module(f"ssik.prebuilt.{module}")

    def forward(self, q):
        return np.asarray(self.arm.fk(q))

    def load(self, pose):
        return pose

    def solve(self, pose):
        self.found = self.arm.solve(pose, respect_limits=False)

    def answers(self):
        return np.array([solution.q for solution in self.found])


class Eaik:
    """`EAIK` on our geometry."""

    def __init__(self, ours):
        from eaik.IK_HP import HPRobot

        points = [np.zeros(3), *(np.array(point) for _, point in ours.axes), ours.tip]
        steps = np.array([b - a for a, b in zip(points, points[1:])])
        self.robot = HPRobot(np.array([axis for axis, _ in ours.axes]), steps)
        if not self.robot.hasKnownDecomposition():
            raise ValueError(self.robot.getKinematicFamily())
        self.forward = ours.forward

    def load(self, pose):
        return pose

    def solve(self, pose):
        self.found = self.robot.IK(pose)

    def answers(self):
        exact = [q for q, least_squares in zip(self.found.Q, self.found.is_LS) if not least_squares]
        return np.array(exact)


def distance(a, b):
    return max(np.linalg.norm(a[:3, 3] - b[:3, 3]), np.linalg.norm(a[:3, :3] - b[:3, :3]))


def sets(poses, joints):
    rng = np.random.default_rng(7)
    yield "random", rng.uniform(-np.pi, np.pi, (poses, joints))
    yield "grid90", (rng.integers(0, 4, (poses, joints)) - 1) * (np.pi / 2)


def race(name, solvers, vectors):
    """A row for each solver."""
    poses = [[solver.forward(q) for q in vectors] for solver in solvers]
    loaded = [[solver.load(pose) for pose in own] for solver, own in zip(solvers, poses)]
    fastest = np.full((len(solvers), len(vectors)), np.inf)
    for _ in range(CALLS):
        for i in range(len(vectors)):
            for k, solver in enumerate(solvers):
                start = time.perf_counter_ns()
                solver.solve(loaded[k][i])
                fastest[k, i] = min(fastest[k, i], time.perf_counter_ns() - start)
    for k, solver in enumerate(solvers):
        solved = wrong = answers = 0
        for pose, own in zip(poses[k], loaded[k]):
            solver.solve(own)
            errors = [distance(solver.forward(q), pose) for q in solver.answers()]
            right = sum(error <= 1e-6 for error in errors)
            solved, wrong, answers = solved + (right > 0), wrong + len(errors) - right, answers + len(errors)
        n = len(vectors)
        yield name[k], np.median(fastest[k]) / 1e3, fastest[k].mean() / 1e3, f"{solved}/{n}", wrong, answers / n


def main():
    arguments = sys.argv[1:]
    write = Path(arguments[arguments.index("--write") + 1]) if "--write" in arguments else None
    poses = int(arguments[0]) if arguments and arguments[0].isdigit() else 200
    lines = ["", "## From Python", "", f"{poses} poses a set, the fastest of {CALLS} calls.", ABOUT, ""]
    lines += ["| arm | set | solver | median us | mean us | ratio to ssik | solved | wrong | mean solutions |"]
    lines += ["|---|---|---|---:|---:|---:|---:|---:|---:|"]
    refused = []
    with tempfile.TemporaryDirectory() as folder:
        for arm in json.loads((GENERATED / "arms.json").read_text()):
            if arm["name"] not in SSIK:
                continue
            ours = Ours(arm, folder)
            solvers = [("robotc C", ours), ("ssik", Ssik(SSIK[arm["name"]]))]
            try:
                solvers.append(("EAIK", Eaik(ours)))
            except Exception as error:  # what it raises is its own affair
                refused.append(f"EAIK refuses {arm['name']} ({error})")
            names, solvers = zip(*solvers)
            for name, vectors in sets(poses, ours.joints):
                rows = list(race(names, solvers, vectors))
                peer = rows[1][1]
                for solver, median, mean, solved, wrong, answers in rows:
                    lines.append(
                        f"| {arm['name']} | {name} | {solver} | {median:.1f} | {mean:.1f} | {median / peer:.3f} | {solved} | {wrong} | {answers:.2f} |"
                    )
                print(*lines[-len(rows):], sep="\n", flush=True)
    if refused:
        lines += ["", "; ".join(refused) + "."]
    if write:
        with write.open("a") as file:
            file.write("\n".join(lines) + "\n")


main()
