"""What a scene file says of itself, read as a text: nothing of it is executed."""

import ast
from pathlib import Path

from rsmpm_ti.errors import SceneError


def glance(path: Path) -> tuple[str, dict[str, str]]:
    """The first line of a scene file, and keyword -> default as it stands there. Raises SceneError."""
    try:
        tree = ast.parse(path.read_bytes())
        said = (ast.get_docstring(tree) or "").strip()
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError) as error:
        reason = getattr(error, "msg", None) or getattr(error, "strerror", None) or error
        raise SceneError(f"{path} cannot be read: {type(error).__name__}: {reason}") from None
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == "scene"]
    if not functions:
        raise SceneError(f"{path} defines no function scene()")
    given = functions[-1].args
    names = [*given.posonlyargs, *given.args, *given.kwonlyargs]
    bare: list[ast.expr | None] = [None] * (len(given.posonlyargs) + len(given.args) - len(given.defaults))
    defaults = [*bare, *given.defaults, *given.kw_defaults]
    keywords = {
        name.arg: "?" if default is None else ast.unparse(default).replace(" ", "")
        for name, default in zip(names, defaults, strict=True)
    }
    return said.partition("\n")[0].removesuffix("."), keywords
