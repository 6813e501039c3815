"""Zips the extension with its wheel: `python3 package.py WHEEL OUT_FOLDER`; prints the zip's path. Equal inputs give equal bytes."""

import re
import sys
import zipfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parent / "sinew_blender"
# Wheel tags, and Blender's names of their platforms.
PLATFORMS = (
    (r"manylinux.*x86_64|linux_x86_64", "linux-x64"),
    (r"manylinux.*aarch64|linux_aarch64", "linux-arm64"),
    (r"macosx.*arm64", "macos-arm64"),
    (r"macosx.*x86_64", "macos-x64"),
    (r"win_amd64", "windows-x64"),
    (r"win_arm64", "windows-arm64"),
)
# The earliest time that zips can store.
MOMENT = (1980, 1, 1, 0, 0, 0)


def platform(wheel: Path) -> str:
    for tags, name in PLATFORMS:
        if re.search(tags, wheel.name):
            return name
    raise SystemExit(f"{wheel.name}: a wheel for no platform that Blender runs on")


def manifest(wheel: Path) -> str:
    text = (SOURCE / "blender_manifest.toml").read_text()
    text = text.replace("platforms = []", f'platforms = ["{platform(wheel)}"]')
    return text.replace("wheels = []", f'wheels = ["./wheels/{wheel.name}"]')


def package(wheel: Path, out: Path) -> Path:
    version = re.search(r'^version = "(.+)"$', manifest(wheel), re.MULTILINE)
    assert version, "the manifest has a version"
    target = out / f"sinew_blender-{version[1]}-{platform(wheel).replace('-', '_')}.zip"
    files = {"blender_manifest.toml": manifest(wheel).encode(), f"wheels/{wheel.name}": wheel.read_bytes()}
    for path in sorted(SOURCE.glob("*.py")):
        files[path.name] = path.read_bytes()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in sorted(files.items()):
            archive.writestr(zipfile.ZipInfo(name, MOMENT), data, zipfile.ZIP_DEFLATED)
    return target


if __name__ == "__main__":
    print(package(Path(sys.argv[1]), Path(sys.argv[2])))
