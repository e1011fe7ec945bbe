"""The programs that render the scenes: how each is found, called and read."""

from __future__ import annotations

import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from octray.bench.process import RunError
from octray.bench.writers import mitsuba, pov, script, tachyon

if TYPE_CHECKING:
    from octray.bench.process import Cost
    from octray.bench.scene import Scene

#: The program that the others are compared with.
YARDSTICK = "octray"


@dataclass(frozen=True)
class Figures:
    """What a program says of itself: seconds of tracing, and of other parts by name."""

    trace_s: float
    parts: dict[str, float] = field(default_factory=dict)
    #: Seconds that belong to the measurement and not to the command.
    extra_s: float = 0.0


class Program(Protocol):
    """One contender."""

    name: str

    def find(self) -> str:
        """Give its version; raise ``LookupError`` with what is missing."""
        ...

    def objection(self, scene: Scene) -> str | None:
        """Say why it does not render such a scene; ``None`` if it does."""
        ...

    def write(self, scene: Scene, folder: Path) -> None:
        """Write the scene's files for it, unless they are there."""
        ...

    def command(self, scene: Scene, folder: Path, threads: int) -> list[str]:
        """Give the command that renders the files in the folder."""
        ...

    def environment(self, folder: Path) -> dict[str, str]:
        """Give what its environment has besides ours; the folder is ours to write to."""
        ...

    def read(self, cost: Cost) -> Figures:
        """Read what it said."""
        ...


def _number(text: str, pattern: str) -> float:
    """Find the last number that the pattern's group matches."""
    found = re.findall(pattern, text)
    if not found:
        raise RunError("failed", f"it does not tell its times: nothing like {pattern}")
    return float(found[-1])


def _once(path: Path) -> bool:
    """Say whether a file must be made."""
    return not path.exists()


def _write_pov(scene: Scene, folder: Path) -> None:
    path = folder / f"{scene.name}.pov"
    if _once(path):
        with path.open("w", encoding="ascii") as file:
            pov.write(scene, file)


def _write_mitsuba(scene: Scene, folder: Path) -> None:
    path = folder / f"{scene.name}.xml"
    if _once(path):
        with path.open("w", encoding="ascii") as file:
            mitsuba.write(scene, file, folder)


def _phases(cost: Cost) -> Figures:
    """Read the JSON object that octray prints."""
    try:
        phases: dict[str, float] = json.loads(cost.text)["phases"]
    except (ValueError, KeyError) as error:
        raise RunError("failed", "it did not print its report") from error
    parts = {name.removesuffix("_s"): seconds for name, seconds in phases.items()}
    parts["read"] = parts.pop("import")
    return Figures(phases["render_s"], parts)


class Octray:
    """octray's command line, which reads the file that POV-Ray reads."""

    name = YARDSTICK

    def find(self) -> str:
        """Give the version; it is here."""
        from octray._core import __version__  # noqa: PLC0415 - the rest is needed without it

        return __version__

    def objection(self, _scene: Scene) -> str | None:
        """Render everything."""
        return None

    def write(self, scene: Scene, folder: Path) -> None:
        """Write one file."""
        _write_pov(scene, folder)

    def command(self, scene: Scene, folder: Path, threads: int) -> list[str]:
        """Give what a user types."""
        width, height = scene.size
        options = f"--size {width}x{height} --threads {threads} --json --quiet".split()
        command = [sys.executable, "-m", "octray", "render", str(folder / f"{scene.name}.pov")]
        return [*command, "-o", str(folder / "octray.png"), *options]

    def environment(self, _folder: Path) -> dict[str, str]:
        """Let it find the octray that is running."""
        here = str(Path(__file__).resolve().parents[2])
        return {"PYTHONPATH": os.pathsep.join(filter(None, [here, os.environ.get("PYTHONPATH")]))}

    def read(self, cost: Cost) -> Figures:
        """Read its report."""
        return _phases(cost)


class OctrayPython(Octray):
    """octray called from Python, which takes meshes from binary files."""

    name = "octray, Python"

    def objection(self, scene: Scene) -> str | None:
        """Only meshes come in binary files."""
        if scene.spheres or scene.solids or not scene.meshes:
            return "is for meshes in binary files"
        return None

    def write(self, scene: Scene, folder: Path) -> None:
        """Write the script and the meshes."""
        _write_mitsuba(scene, folder)
        with (folder / f"{scene.name}.py").open("w", encoding="utf-8") as file:
            script.write(scene, file, folder)

    def command(self, scene: Scene, folder: Path, threads: int) -> list[str]:
        """Run the script."""
        path = folder / f"{scene.name}.py"
        return [sys.executable, str(path), str(folder / "octray-python.png"), str(threads)]


@dataclass
class PovRay:
    """POV-Ray 3.7, by its own choice of structure or with its BSP tree (``+BM2``)."""

    bsp: bool = False

    def __post_init__(self) -> None:
        """Name it."""
        self.name = "POV-Ray +BM2" if self.bsp else "POV-Ray"

    def find(self) -> str:
        """Look on the path."""
        path = shutil.which("povray")
        if path is None:
            raise LookupError("povray is not on the path (apt: povray)")
        said = subprocess.run(  # noqa: S603 - what the user installed
            [path, "--version"], capture_output=True, text=True, check=False, timeout=60
        )
        found = re.search(r"POV-Ray (\d[\w.]*)", said.stdout + said.stderr)
        return found[1] if found else "of unknown version"

    def objection(self, _scene: Scene) -> str | None:
        """Render everything."""
        return None

    def write(self, scene: Scene, folder: Path) -> None:
        """Write one file."""
        _write_pov(scene, folder)

    def command(self, scene: Scene, folder: Path, threads: int) -> list[str]:
        """Give the command for the same picture, without display and pauses."""
        width, height = scene.size
        options = f"+FN +W{width} +H{height} +WT{threads} -A -D -P".split()
        files = [f"+I{folder / scene.name}.pov", f"+O{folder / 'povray.png'}"]
        return ["povray", *files, *options, *(["+BM2"] if self.bsp else [])]

    def environment(self, _folder: Path) -> dict[str, str]:
        """Nothing."""
        return {}

    def read(self, cost: Cost) -> Figures:
        """Read its statistics."""
        trace = _number(cost.text, r"Trace Time:.*?\(([\d.]+) sec")
        return Figures(trace, {"read": _number(cost.text, r"Parse Time:.*?\(([\d.]+) sec")})


class Tachyon:
    """Tachyon 0.99; it knows no solids."""

    name = "Tachyon"

    def find(self) -> str:
        """Look on the path."""
        path = shutil.which("tachyon")
        if path is None:
            raise LookupError("tachyon is not on the path (apt: tachyon)")
        said = subprocess.run(  # noqa: S603 - what the user installed
            [path, os.devnull], capture_output=True, text=True, check=False, timeout=60
        )
        found = re.search(r"Version (\d[\w.]*)", said.stdout + said.stderr)
        return found[1] if found else "of unknown version"

    def objection(self, scene: Scene) -> str | None:
        """Refuse solids."""
        return "has no solids" if scene.solids else None

    def write(self, scene: Scene, folder: Path) -> None:
        """Write one file."""
        path = folder / f"{scene.name}.dat"
        if _once(path):
            with path.open("w", encoding="ascii") as file:
                tachyon.write(scene, file)

    def command(self, scene: Scene, folder: Path, threads: int) -> list[str]:
        """Give the command, at best quality."""
        options = f"+V -fullshade -numthreads {threads} -format PPM".split()
        return [
            *("tachyon", str(folder / f"{scene.name}.dat"), *options),
            *("-o", str(folder / "tachyon.ppm")),
        ]

    def environment(self, folder: Path) -> dict[str, str]:
        """Choose its library with threads: Debian's package of the MPI variant switches it off."""
        for threaded in Path("/usr/lib").glob("*/libtachyon-mt-thr.so.0"):
            link = folder / "tachyon-with-threads" / "libtachyon.so.0"
            link.parent.mkdir(exist_ok=True)
            if not link.is_symlink():
                link.symlink_to(threaded)
            return {"LD_LIBRARY_PATH": str(link.parent)}
        return {}

    def read(self, cost: Cost) -> Figures:
        """Read its statistics. It ends with status 0 whatever happens."""
        trace = _number(cost.text, r"Ray Tracing Time:\s*([\d.]+)")
        parts = {
            "read": _number(cost.text, r"Scene Parsing Time:\s*([\d.]+)"),
            "build": _number(cost.text, r"Preprocessing Time:\s*([\d.]+)"),
        }
        return Figures(trace, parts)


#: Renders twice: the first picture belongs to the command, the second is what tracing costs.
_MITSUBA = """\
import sys, time
import drjit
drjit.set_thread_count(int(sys.argv[2]))
import mitsuba
mitsuba.set_variant("scalar_rgb")
times = [time.perf_counter()]
scene = mitsuba.load_file(sys.argv[1])
times.append(time.perf_counter())
mitsuba.util.write_bitmap(sys.argv[3], mitsuba.render(scene, spp=1, seed=0), write_async=False)
times.append(time.perf_counter())
mitsuba.render(scene, spp=1, seed=1)
times.append(time.perf_counter())
print("read %.9f first %.9f second %.9f" % tuple(b - a for a, b in zip(times, times[1:])))
"""


@dataclass
class Mitsuba:
    """Mitsuba 3 in its plain variant, which has Embree inside. It follows paths: like our work."""

    #: A Python that has it; this one by default.
    python: str | None = None
    name = "Mitsuba"

    def _python(self) -> str:
        return self.python or os.environ.get("OCTRAY_MITSUBA") or sys.executable

    def find(self) -> str:
        """Ask the Python that has it."""
        python = self._python()
        if python == sys.executable and importlib.util.find_spec("mitsuba") is None:
            raise LookupError("this Python has no mitsuba (pip: mitsuba; see --mitsuba)")
        try:
            said = subprocess.run(  # noqa: S603 - what the user named
                [python, "-c", "import mitsuba; print(mitsuba.__version__)"],
                capture_output=True,
                text=True,
                check=True,
                timeout=120,
            )
        except (OSError, subprocess.SubprocessError) as error:
            raise LookupError(f"{python} does not import mitsuba") from error
        return said.stdout.strip()

    def objection(self, scene: Scene) -> str | None:
        """Refuse solids."""
        return "has no solids" if scene.solids else None

    def write(self, scene: Scene, folder: Path) -> None:
        """Write the scene and its meshes."""
        _write_mitsuba(scene, folder)

    def command(self, scene: Scene, folder: Path, threads: int) -> list[str]:
        """Give a script's call; Mitsuba's own command does not render twice."""
        files = [str(folder / f"{scene.name}.xml"), str(threads), str(folder / "mitsuba.png")]
        return [self._python(), "-c", _MITSUBA, *files]

    def environment(self, _folder: Path) -> dict[str, str]:
        """Nothing."""
        return {}

    def read(self, cost: Cost) -> Figures:
        """Read the three times."""
        first, second = (_number(cost.text, rf"{word} ([\d.]+)") for word in ("first", "second"))
        parts = {"read": _number(cost.text, r"read ([\d.]+)"), "first render": first}
        return Figures(second, parts, extra_s=second)


def programs(python: str | None = None) -> list[Any]:
    """All of them, octray first; ``python`` is one that has Mitsuba."""
    return [Octray(), OctrayPython(), PovRay(), PovRay(bsp=True), Tachyon(), Mitsuba(python)]
