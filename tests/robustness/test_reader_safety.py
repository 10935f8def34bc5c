"""No code comes out of a file: nothing in the package unpickles, evaluates, or loads YAML with constructors."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

FORBIDDEN_MODULES = {"pickle", "cPickle", "dill", "shelve", "marshal", "joblib", "cloudpickle"}
FORBIDDEN_CALLS = {"eval", "exec", "compile", "__import__"}
FORBIDDEN_ATTRIBUTES = {
    ("yaml", "load"), ("yaml", "load_all"), ("yaml", "full_load"), ("yaml", "unsafe_load"), ("pd", "read_pickle"),
    ("pandas", "read_pickle"), ("os", "system"), ("os", "popen"),
}  # fmt: skip


def offences(source: str) -> list[str]:
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found += [a.name for a in node.names if a.name.split(".")[0] in FORBIDDEN_MODULES]
        elif isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] in FORBIDDEN_MODULES:
            found.append(str(node.module))
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in FORBIDDEN_CALLS:
            found.append(f"{node.func.id}() in line {node.lineno}")
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            if (node.value.id, node.attr) in FORBIDDEN_ATTRIBUTES:
                found.append(f"{node.value.id}.{node.attr} in line {node.lineno}")
        elif isinstance(node, ast.keyword) and node.arg == "allow_pickle" and ast.unparse(node.value) != "False":
            found.append("allow_pickle")
    return found


MAY = {
    # they speak through a pipe with a process of their own, and pickle what they say; no file is unpickled
    "src/ssmr_ident/readers/apart.py": ["pickle"],
    "src/ssmr_ident/readers/apart_child.py": ["pickle"],
    # the Python file that a user names on the call by --effects; nothing that a log or session names comes here
    "src/ssmr_ident/physics/own_effect.py": ["exec()", "compile()"],
}


@pytest.mark.slow
def test_package_neither_unpickles_nor_evaluates(root: Path) -> None:
    files = sorted((root / "src").rglob("*.py"))
    assert len(files) > 40
    found = {file.relative_to(root).as_posix(): offences(file.read_text()) for file in files}
    assert {name: [one.partition(" in line")[0] for one in bad] for name, bad in found.items() if bad} == MAY


@pytest.mark.parametrize(
    "line", ["import pickle", "from dill import loads", "eval('1')", "yaml.load(x, Loader=L)", "exec(a)",
             "np.load(f, allow_pickle=True)"]
)  # fmt: skip
def test_the_search_finds_what_it_looks_for(line: str) -> None:
    assert offences(line)


def test_reading_leaves_nothing_beside_the_log(tmp_path: Path) -> None:
    from ssmr_ident.readers import read

    (tmp_path / "a.csv").write_text("time [s],force [N]\n" + "".join(f"{k},{k % 3}\n" for k in range(50)))
    read(tmp_path / "a.csv")
    assert [path.name for path in tmp_path.iterdir()] == ["a.csv"]
