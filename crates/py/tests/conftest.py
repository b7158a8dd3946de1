"""A small task and its knowledge base, shared by the tests."""

from pathlib import Path

import pytest

import robotc

ROOT = Path(__file__).resolve().parents[3]
PANDA = ROOT / "specs" / "robots" / "panda.robot.toml"
BLOCK = ROOT / "tests" / "tasks" / "block.task.toml"


@pytest.fixture(scope="session")
def compiled(tmp_path_factory):
    """The knowledge base of the small task, and what was told while it was made."""
    told = []
    store = tmp_path_factory.mktemp("kb")
    base = robotc.KnowledgeBase(
        robotc.Task(BLOCK), store=store, progress=lambda *event: told.append(event)
    )
    return base, told, store


@pytest.fixture(scope="session")
def plan(compiled):
    return compiled[0].session().plan()


@pytest.fixture(scope="session")
def panda():
    return robotc.Robot(PANDA)
