"""Writes bakes as USD: text by Sinew itself, binary files by the `pxr` of usd-core or of Blender."""

from os import PathLike
from pathlib import Path
from typing import Any

from ._sinew import Bake


def save(bake: Bake, path: str | PathLike[str], *, physics: bool = True) -> list[str]:
    """Writes a bake as `.usda` or, if `pxr` can be imported, as `.usdc`; returns a sentence on each loss."""
    target = Path(path)
    if target.suffix not in {".usda", ".usdc"}:
        raise ValueError(f"a USD file ends with .usda or .usdc, not '{target.suffix}'")
    text, notes = bake.usda(physics=physics)
    if target.suffix == ".usda":
        target.write_text(text)
        return notes
    try:
        from pxr import Sdf
    except ImportError as error:
        raise ImportError("a .usdc needs pxr: pip install usd-core, or write a .usda") from error
    layer: Any = Sdf.Layer.CreateAnonymous(".usda")
    if not (layer.ImportFromString(text) and layer.Export(str(target))):
        raise OSError(f"{target}: USD cannot write it")
    return notes
