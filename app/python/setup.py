"""pip install ./app/python: the library and the module, built by CMake.

Setuptools calls CMake itself: with Debian's packages it needs nothing from the network (docs/guide,
From Python); scikit-build-core is no package of Debian 12. TITOP_BUILD names a build folder that has
been configured with -DTITOP_PYTHON=ON for the same interpreter, to be used in place of a new one.
"""
import os
import pathlib
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
OUT = ROOT / "build" / "pip"
PACKAGES = ("g++ cmake make libeigen3-dev libboost-dev libfmt-dev nlohmann-json3-dev pybind11-dev "
            "python3-dev")  # of Debian 12


def pybind11_folder():
    """Of the package pybind11, if it is installed; CMake finds Debian's by itself."""
    try:
        import pybind11
    except ImportError:
        return []
    return [f"-Dpybind11_DIR={pybind11.get_cmake_dir()}"]


def cmake(*arguments):
    """Runs it; its own message stands above ours."""
    try:
        subprocess.run(["cmake", *arguments], check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        sys.exit(f"titop is compiled by CMake, which failed ({error}). It needs the packages "
                 f"{PACKAGES}: see docs/guide/11_python.md")


class CMakeBuild(build_ext):
    def build_extension(self, extension):
        folder = os.environ.get("TITOP_BUILD")
        if not folder:
            folder = OUT / "cmake"
            cmake("-S", ROOT, "-B", folder, "-DTITOP_PYTHON=ON", "-DCMAKE_BUILD_TYPE=Release",
                  f"-DPython3_EXECUTABLE={sys.executable}", *pybind11_folder())
        cmake("--build", folder, "--target", "titop_python", "-j", str(os.cpu_count()))
        target = pathlib.Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(pathlib.Path(folder) / "python" / "titop" / target.name, target)


OUT.mkdir(parents=True, exist_ok=True)
setup(packages=["titop"], package_data={"titop": ["*.pyi", "py.typed"]},
      ext_modules=[Extension("titop._titop", [])], cmdclass={"build_ext": CMakeBuild},
      options={"build": {"build_base": str(OUT)}, "egg_info": {"egg_base": str(OUT)}})
