"""The stubs name exactly what the module has."""

import ast
import inspect
from pathlib import Path

import robotc

# Shapes of dictionaries and names of types, for type checkers alone.
TYPES_ONLY = {"Array", "Path", "Diagnostic", "Artefact", "Segment", "Step", "Contact", "Choice"}


def stub():
    return ast.parse(Path(robotc.__file__).with_name("__init__.pyi").read_text())


def public(names):
    return {name for name in names if not name.startswith("_") or name in ("__version__",)}


def test_names():
    declared = set()
    for node in stub().body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            declared.add(node.name)
        elif isinstance(node, ast.AnnAssign):
            declared.add(node.target.id)
        elif isinstance(node, ast.Assign):
            declared.update(target.id for target in node.targets)
    assert declared - TYPES_ONLY == set(robotc.__all__)
    assert public(vars(robotc._robotc)) == set(robotc.__all__)


def test_members_and_parameters():
    for node in stub().body:
        if not isinstance(node, ast.ClassDef) or node.name in TYPES_ONLY:
            continue
        native = getattr(robotc, node.name)
        if issubclass(native, Exception):
            continue
        functions = {f.name: f for f in node.body if isinstance(f, ast.FunctionDef)}
        assert public(functions) == public(vars(native)), node.name
        for name, function in functions.items():
            is_property = any(isinstance(d, ast.Name) and d.id == "property" for d in function.decorator_list)
            if name == "__init__":
                parameters = list(inspect.signature(native).parameters)
            elif is_property:
                assert inspect.isgetsetdescriptor(getattr(native, name)), f"{node.name}.{name}"
                continue
            else:
                parameters = list(inspect.signature(getattr(native, name)).parameters)[1:]
            declared = [a.arg for a in function.args.args + function.args.kwonlyargs][1:]
            assert declared == parameters, f"{node.name}.{name}"


def test_functions():
    for node in stub().body:
        if isinstance(node, ast.FunctionDef):
            declared = [a.arg for a in node.args.args]
            assert declared == list(inspect.signature(getattr(robotc, node.name)).parameters), node.name


def test_typed():
    assert Path(robotc.__file__).with_name("py.typed").exists()
