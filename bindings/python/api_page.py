"""Writes docs/python-api.md from the stubs: `python3 bindings/python/api_page.py`; with `--check` it compares."""

import ast
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
STUBS = ROOT / "bindings/python/python/sinew/_sinew.pyi"
PAGE = ROOT / "docs/python-api.md"
HEAD = """# Sinew in Python: all names

Made of the stubs by `bindings/python/api_page.py`; [python.md](python.md) shows how they are used. Metres, kilograms, seconds, radians; +Y is up. A pose is seven
numbers (place, quaternion x y z w), a velocity six (linear, angular). `(n, 7)` is the shape of an array. The stubs have the
types of arguments.
"""


# Public names for private ones of the stubs.
ALIASES = {
    "_Floats": "NDArray[np.float32]",
    "_Ids": "NDArray[np.uint64]",
    "_Path": "str | PathLike[str]",
    "_Hit": "tuple[float, str, ArrayLike]",
    "_Shape": "Literal['box', 'sphere', 'capsule', 'cylinder', 'cone', 'half_space']",
    "_Quality": "Literal['fast', 'balanced', 'exact']",
}


def plain(text: str) -> str:
    for alias, meaning in ALIASES.items():
        text = text.replace(alias, meaning)
    return text


def doc(node: ast.FunctionDef | ast.ClassDef) -> str:
    return (ast.get_docstring(node) or "").replace("\n", " ")


def drop_types(arguments: ast.arguments) -> ast.arguments:
    """Keeps only the annotations that list choices."""
    for argument in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs):
        if argument.annotation and "Literal" not in plain(ast.unparse(argument.annotation)):
            argument.annotation = None
    return arguments


def signature(function: ast.FunctionDef) -> str:
    arguments = ast.unparse(drop_types(function.args))
    arguments = arguments.removeprefix("self, ").removeprefix("cls, ").removeprefix("self").removeprefix("cls")
    result = ast.unparse(function.returns) if function.returns else "None"
    return plain(f"({arguments})" + ("" if result == "None" else f" -> {result}"))


def rows(nodes: list[ast.stmt]) -> list[str]:
    entries = []
    for node in nodes:
        if not isinstance(node, ast.FunctionDef):
            continue
        is_property = any(isinstance(name, ast.Name) and name.id == "property" for name in node.decorator_list)
        if node.name == "__new__":
            continue
        name = f"`{node.name}`" if is_property else f"`{node.name}{signature(node)}`"
        if is_property and node.returns:
            name = f"`{node.name}: {plain(ast.unparse(node.returns))}`"
        entries.append(f"- {name}: {doc(node)}")
    return entries


def page() -> str:
    body = ast.parse(STUBS.read_text()).body
    parts = [HEAD, "## Functions\n", "\n".join(rows(body))]
    for node in body:
        if isinstance(node, ast.ClassDef):
            made = next((item for item in node.body if isinstance(item, ast.FunctionDef) and item.name == "__new__"), None)
            parts.append(f"\n## `{node.name}`\n\n{doc(node)}\n")
            if made:
                parts.append(f"`{node.name}{signature(made).rsplit(' -> ', 1)[0]}`\n")
            parts.append("\n".join(rows(node.body)))
    return "\n".join(part for part in parts if part).rstrip() + "\n"


if __name__ == "__main__":
    text = page()
    if "--check" not in sys.argv:
        PAGE.write_text(text)
    elif PAGE.read_text() != text:
        sys.exit("docs/python-api.md is not what the stubs say: run bindings/python/api_page.py")
