"""Compares convex parts with those of CoACD: `python compare.py PARTS.json [SECONDS]`, as the example `convex_parts` of robotc-core
writes it. CoACD is given up on after so many seconds a mesh; 0 leaves it out.

Both have at most 32 corners a part and the same mesh. Uncovered: vertices of the mesh more than a millionth of its diagonal outside of
all parts. Distance: mean, of points spread over the outer surface of the parts from the mesh, in thousandths of the diagonal; it
needs no closed mesh. Times: ours by the clock, CoACD's too, in the order given, one after the other. Needs `pip install coacd scipy`.
"""

import json
import multiprocessing
import pathlib
import queue
import sys
import time

import coacd
import numpy as np
from scipy.spatial import ConvexHull, cKDTree

CORNERS = 32
SAMPLES = 20_000
DENSE = 300_000


def on_triangles(triangles, count, rng):
    areas = 0.5 * np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1)
    chosen = triangles[rng.choice(len(triangles), count, p=areas / areas.sum())]
    u, v = rng.random(count), rng.random(count)
    flip = u + v > 1
    u[flip], v[flip] = 1 - u[flip], 1 - v[flip]
    return chosen[:, 0] + (chosen[:, 1] - chosen[:, 0]) * u[:, None] + (chosen[:, 2] - chosen[:, 0]) * v[:, None]


def height(points, hulls):
    best = np.full(len(points), np.inf)
    for hull in hulls:
        of_hull = np.full(len(points), -np.inf)
        for equation in np.unique(np.round(hull.equations, 12), axis=0):
            np.maximum(of_hull, points @ equation[:3] + equation[3], out=of_hull)
        np.minimum(best, of_hull, out=best)
    return best


def score(parts, vertices, tree, size, rng):
    hulls = [ConvexHull(np.asarray(p), qhull_options="QJ" if len(p) < 5 else "Qt") for p in parts]
    uncovered = int(np.sum(height(vertices, hulls) > 1e-6 * size))
    surface = np.concatenate([h.points[h.simplices] for h in hulls])
    points = on_triangles(surface, SAMPLES, rng)
    outer = points[height(points, hulls) > -1e-4 * size]
    return uncovered, 1e3 * tree.query(outer)[0].mean() / size


def coacd_parts(vertices, faces, results):
    coacd.set_log_level("error")
    results.put([p for p, _ in coacd.run_coacd(coacd.Mesh(vertices, faces), decimate=True, max_ch_vertex=CORNERS)])


def parts_of_coacd(vertices, faces, limit):
    """The parts, or None when that takes longer than the limit; and the seconds."""
    start = time.perf_counter()
    context = multiprocessing.get_context("spawn")
    results = context.Queue()
    worker = context.Process(target=coacd_parts, args=(vertices, faces, results))
    worker.start()
    try:
        parts = results.get(timeout=limit)
    except queue.Empty:
        parts = None
    worker.kill()
    worker.join()
    return parts, time.perf_counter() - start


def main(path, limit):
    print("| mesh | triangles | parts | CoACD | uncovered | CoACD | distance | CoACD | ratio | seconds | CoACD |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    ratios = []
    for entry in json.loads(pathlib.Path(path).read_text()):
        rng = np.random.default_rng(1)
        # STL repeats corners; CoACD would take the mesh for one that is not closed.
        vertices, number = np.unique(np.array(entry["vertices"]), axis=0, return_inverse=True)
        faces = number.reshape(-1)[np.array(entry["faces"])]
        faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
        size = np.linalg.norm(vertices.max(0) - vertices.min(0))
        tree = cKDTree(on_triangles(vertices[faces], DENSE, rng))
        theirs, seconds = parts_of_coacd(vertices, faces, limit) if limit > 0 else (None, 0.0)
        missed, distance = score(entry["parts"], vertices, tree, size, rng)
        cells = ["-", "-", "-", "-", f"> {limit:.0f}" if limit > 0 else "-"]
        if theirs is not None:
            missed_theirs, distance_theirs = score(theirs, vertices, tree, size, rng)
            ratios.append(distance / distance_theirs)
            cells = [len(theirs), missed_theirs, f"{distance_theirs:.2f}", f"{ratios[-1]:.2f}", f"{seconds:.1f}"]
        print(
            f"| {pathlib.Path(entry['mesh']).stem} | {len(faces)} | {len(entry['parts'])} | {cells[0]} | {missed} | {cells[1]} | "
            f"{distance:.2f} | {cells[2]} | {cells[3]} | {entry['seconds']:.1f} | {cells[4]} |",
            flush=True,
        )
    if ratios:
        print(f"\nmedian ratio {np.median(ratios):.2f}, largest {max(ratios):.2f}")


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 600.0)
