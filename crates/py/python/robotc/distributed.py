"""Compiling with many workers: Dask, Ray, a pool of processes, or anything that runs functions elsewhere.

    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context
    from robotc import distributed

    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        distributed.compile("mug.task.toml", depot="/shared/depot", submit=pool.submit)

The workers meet in the depot, a folder that all of them see, or an address such as s3://bucket/kb where the package was
built with the features for that. Any of them may die; running it again goes on from there.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, Protocol

from ._robotc import KnowledgeBase, Robot, Task, build, plan_build


class Future(Protocol):
    """What `submit` gives: a result that comes later."""

    def result(self) -> Any: ...


Submit = Callable[..., Future]


def compile(
    specification: str | os.PathLike[str],
    depot: str | os.PathLike[str],
    submit: Submit,
    store: str | os.PathLike[str] | None = None,
    shards: int = 4,
) -> KnowledgeBase:
    """Computes all that a specification needs, and opens it.

    Every worker reads the specification and the depot by these paths. `submit(function, *arguments)` is the method of that
    name of a `concurrent.futures` executor or of a `dask.distributed.Client`, or `ray_submit`. `store` is the folder of each
    worker's own knowledge base, on a local disk; by default one in the user's cache. Each large artefact is shared by
    `shards` workers. An exception of a worker is raised here.
    """
    path, depot = str(specification), str(depot)
    store = str(store) if store is not None else None
    steps = plan_build(_load(path))
    for level in sorted({step["level"] for step in steps}):
        here = [step for step in steps if step["level"] == level]
        shares = [(step["recipe"], min(shards, step["shards"])) for step in here]
        _all(submit(_work, path, recipe, depot, store, f"{i}/{n}") for recipe, n in shares for i in range(n))
        # Put together what was shared, should the workers have died that wanted to.
        _all(submit(_work, path, recipe, depot, store, "0/1") for recipe, n in shares if n > 1)
    for step in steps:
        _work(path, step["recipe"], depot, store, "0/1")
    return KnowledgeBase(_load(path), _store(store))


def ray_submit(function: Callable[..., Any], *arguments: Any) -> Future:
    """Runs a function on a Ray cluster; for the argument `submit` of `compile`."""
    import ray

    return _RayFuture(ray.remote(function).remote(*arguments))


class _RayFuture:
    def __init__(self, reference: Any) -> None:
        self.reference = reference

    def result(self) -> Any:
        import ray

        return ray.get(self.reference)


def _work(path: str, recipe: str, depot: str, store: str | None, shard: str) -> bool:
    return build(_load(path), recipe, depot, _store(store), shard)


def _load(path: str) -> Robot | Task:
    return Robot(path) if path.endswith(".robot.toml") else Task(path)


def _store(store: str | None) -> Path:
    if store is not None:
        return Path(store)
    if folder := os.environ.get("ROBOTC_STORE"):
        return Path(folder)
    cache = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA") or Path.home() / ".cache"
    return Path(cache) / "robotc"


def _all(futures: Iterable[Future]) -> None:
    # All are submitted before the first is waited for.
    for future in list(futures):
        future.result()
