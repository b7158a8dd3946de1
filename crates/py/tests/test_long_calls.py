"""Long calls leave the interpreter to others, and stop when they are told to."""

import os
import signal
import threading
import time

import pytest

import robotc
from conftest import BLOCK, ROOT

MUG = ROOT / "specs" / "tasks" / "mug_to_shelf.task.toml"


def compile_mug(folder, progress=None):
    """Tries so many grasps that it takes far longer than these tests wait, on any machine."""
    text = MUG.read_text().replace('"../', f'"{MUG.parent.parent.as_posix()}/')
    task = folder / "slow.task.toml"
    task.write_text(text + "\n[parameters.grasp_set]\napproaches = 600000\nspacing = 0.005\nrolls = 16\n")
    robotc.KnowledgeBase(robotc.Task(task), store=folder / "store", progress=progress)


def test_interrupt_stops_a_compilation_while_other_threads_run(tmp_path):
    # A shell that runs the tests in the background has them ignore Ctrl-C.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    sent, ticks, done = [], [], threading.Event()

    def interrupt():
        time.sleep(1.5)
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    def count():
        while not done.wait(0.01):
            ticks.append(time.monotonic())

    threads = [threading.Thread(target=interrupt), threading.Thread(target=count)]
    for thread in threads:
        thread.start()
    start = time.monotonic()
    try:
        with pytest.raises(KeyboardInterrupt):
            compile_mug(tmp_path)
    finally:
        stopped = time.monotonic()
        signal.signal(signal.SIGINT, before)
        done.set()
        for thread in threads:
            thread.join()
    assert sent[0] - start > 1
    assert stopped - sent[0] < 1
    # With the lock held, the counter would not have come to its turn until the end.
    assert len([t for t in ticks if start < t < sent[0]]) > 20


def test_exceptions_of_progress_stop_a_compilation(tmp_path):
    def progress(kind, subject, fraction):
        raise RuntimeError(f"enough of {kind}")

    with pytest.raises(RuntimeError, match="enough of"):
        compile_mug(tmp_path, progress)


def test_interrupted_work_is_not_lost(compiled, tmp_path):
    """A store that was being written when the call stopped serves the next one."""
    stored = []

    def progress(kind, subject, fraction):
        if fraction == 1.0:
            stored.append((kind, subject))
            if len(stored) == 2:
                raise RuntimeError("stop")

    task = robotc.Task(BLOCK)
    with pytest.raises(RuntimeError, match="stop"):
        robotc.KnowledgeBase(task, store=tmp_path, progress=progress)
    rest = robotc.KnowledgeBase(task, store=tmp_path)
    assert 0 < rest.built <= compiled[0].built - 2
    assert rest.artefacts == compiled[0].artefacts
