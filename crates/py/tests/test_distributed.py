"""Many processes compile one specification."""

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest
from conftest import BLOCK

import robotc
from robotc import distributed


def test_a_pool_gives_what_one_process_gives(compiled, tmp_path):
    alone, _, _ = compiled
    # Workers that do not inherit the threads of this process.
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        base = distributed.compile(BLOCK, tmp_path / "depot", pool.submit, tmp_path / "store", shards=3)
    assert base.built == 0
    assert base.artefacts == alone.artefacts


def test_what_cannot_be_built_is_told(tmp_path):
    task = robotc.Task(BLOCK)
    steps = robotc.plan_build(task)
    last = max(steps, key=lambda step: step["level"])
    arguments = (task, last["recipe"], str(tmp_path / "depot"), tmp_path / "store")
    with pytest.raises(robotc.CompileError, match="not there yet"):
        robotc.build(*arguments)
    with pytest.raises(ValueError, match="i/n"):
        robotc.build(*arguments, shard="2/2")
    with pytest.raises(ValueError, match="recipe"):
        robotc.build(task, "nonsense", *arguments[2:])
