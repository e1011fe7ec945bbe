"""POV-Ray and octray render the same scene files; each is compared with itself.

A picture of coincident faces is held against the same program's picture of a scene that means the
same and has none: a longer cutter, one box instead of two, cubes put together instead of cut out.
"""

from __future__ import annotations

import re
import subprocess
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from rays import menger_cells, menger_cutters
from raysect_solids import TORUS_DISTANCES, torus_cases
from report import Row, share

import octray

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

SIZE = 400
Picture = npt.NDArray[np.float64]

#: Where the camera stands.
VIEWS = {
    "straight into the bore": (0.0, 8.0, 0.0),
    "steep": (1.5, 7.0, -3.0),
    "oblique": (4.0, 5.0, -6.0),
    "low": (5.0, 2.0, -6.5),
}


def vector(values: npt.ArrayLike) -> str:
    """A vector of the scene language, every digit of it."""
    return "<" + ", ".join(f"{v:.17g}" for v in np.asarray(values).tolist()) + ">"


def scene(body: str, eye: tuple[float, float, float], scale: float = 1.0) -> str:
    """A scene file: camera, light, background, and ``body``."""
    # Spelled out, because POV-Ray takes a look_at nearer than a fixed length for no direction.
    away = np.array(eye) / np.linalg.norm(eye)
    right = np.cross((0, 0.01, 1), -away)
    right /= np.linalg.norm(right)
    up = np.cross(-away, right)
    location, lamp = np.array(eye) * scale, np.array((6, 9, -4)) * scale
    return f"""#version 3.7;
global_settings {{ assumed_gamma 1.0 max_trace_level 20 }}
camera {{
  location {vector(location)}
  right {vector(right)}
  up {vector(up)}
  direction {vector(-2 * away)}
}}
light_source {{ {vector(lamp)} rgb 1 }}
background {{ rgb <0.1, 0.2, 0.6> }}
#declare Brass = texture {{
  pigment {{ rgb <0.9, 0.7, 0.3> }}
  finish {{ ambient 0.15 diffuse 0.8 }}
}}
{body}
"""


def bored(reach: float, turn: str = "") -> str:
    """A cube minus a cylinder that ends ``reach`` from its middle."""
    return f"""difference {{
  box {{ <-1, -1, -1>, <1, 1, 1> }}
  cylinder {{ <0, {-reach}, 0>, <0, {reach}, 0>, 0.6 }}
  texture {{ Brass }} {turn}
}}"""


def glass(parts: str) -> str:
    """Boxes merged into one body of clear tinted glass that does not bend light."""
    look = "pigment { rgbf <0.7, 0.9, 0.8, 0.7> } finish { ambient 0.1 diffuse 0.4 }"
    return f"merge {{\n{parts}\n{look} }}"


def sponge(level: int, cut: bool) -> str:
    """A Menger sponge of side 2, cut from a cube or put together from cubes."""
    size = 3**level

    def box(low: tuple[int, ...], high: tuple[int, ...]) -> str:
        a, b = (", ".join(map(str, corner)) for corner in (low, high))
        return f"box {{ <{a}>, <{b}> }}"

    if cut:
        parts = [box((0, 0, 0), (size, size, size))]
        parts += [box(low, high) for low, high in menger_cutters(level)]
    else:
        cells = np.argwhere(menger_cells(level)).tolist()
        parts = [box(tuple(c), tuple(v + 1 for v in c)) for c in cells]
    joined = "\n".join(parts)
    place = f"translate {-size / 2} scale {2 / size:.17g} texture {{ Brass }}"
    return f"{'difference' if cut else 'union'} {{\n{joined}\n{place}\n}}"


def collection(scale: float) -> str:
    """Four solids without coincident faces, ``scale`` times as large."""
    return f"""union {{
  difference {{
    box {{ <-1, -1, -1>, <0.1, 0.1, 0.1> }}
    cylinder {{ <-0.45, -1.1, -0.45>, <-0.45, 0.2, -0.45>, 0.3 }}
  }}
  sphere {{ <0.6, 0.3, -0.5>, 0.45 }}
  torus {{ 0.55, 0.2 rotate 60*x translate <0.5, -0.5, 0.5> }}
  cone {{ <-0.5, 0.2, 0.5>, 0.4, <-0.5, 1, 0.5>, 0.1 }}
  texture {{ Brass }}
  scale {scale:.17g}
}}"""


def by_povray(path: Path) -> Picture:
    """The picture that POV-Ray makes, 0 to 255."""
    target = path.with_suffix(".ppm")
    arguments = [f"+I{path}", f"+O{target}", "+FP8", f"+W{SIZE}", f"+H{SIZE}", "-A", "-D", "+WT1"]
    done = subprocess.run(
        ["povray", *arguments], capture_output=True, text=True, timeout=600, check=False
    )
    if done.returncode != 0:
        raise RuntimeError(f"POV-Ray could not render {path.name}:\n{done.stderr[-2000:]}")
    data = target.read_bytes()
    header = re.match(rb"P6\s+(?:#.*\s+)*(\d+)\s+(\d+)\s+255\s", data)
    if header is None:
        raise RuntimeError(f"{target} is not the picture that was asked for")
    pixels = np.frombuffer(data, dtype=np.uint8, offset=header.end())
    return pixels.reshape(SIZE, SIZE, 3).astype(np.float64)


def by_octray(path: Path) -> Picture:
    """The picture that octray makes, 0 to 255 by the same transfer function (sRGB)."""
    linear = octray.load(path).render(size=(SIZE, SIZE), spp=1).to_numpy().astype(np.float64)
    linear = np.clip(linear, 0, 1)
    curve = np.where(linear < 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.round(255 * curve)


def difference(a: Picture, b: Picture) -> int:
    """How many pixels differ by more than one step of 255 in some channel."""
    return int(np.count_nonzero((np.abs(a - b) > 1).any(axis=2)))


def compare(folder: Path, rays: int) -> Iterator[Row]:
    """Rows for POV-Ray."""

    def pair(name: str, text: str) -> tuple[Picture, Picture]:
        path = folder / f"{name}.pov"
        path.write_text(text, encoding="utf-8")
        return by_povray(path), by_octray(path)

    plain: dict[str, int] = {}

    def row(what: str, counted: str, test: tuple[str, str], right: tuple[str, str]) -> Row:
        theirs, ours = pair(*test)
        their_right, our_right = pair(*right)
        plain[right[0]] = difference(their_right, our_right)
        return Row(
            what,
            counted,
            "POV-Ray",
            share(difference(theirs, their_right), SIZE * SIZE),
            share(difference(ours, our_right), SIZE * SIZE),
        )

    for index, (view, eye) in enumerate(VIEWS.items()):
        for turn in ("", "rotate <-12, 17, 9>") if view == "steep" else ("",):
            suffix = f"{index}{'t' if turn else ''}"
            yield row(
                "cube minus cylinder of equal height",
                f"wrong pixels, {view}{', solid turned' if turn else ''}",
                (f"flush{suffix}", scene(bored(1.0, turn), eye)),
                (f"longer{suffix}", scene(bored(1.1, turn), eye)),
            )
    one = "box { <-1, -1, -1>, <1, 1, 1> }"
    two = "box { <-1, -1, -1>, <0.3, 1, 1> }\nbox { <0.3, -1, -1>, <1, 1, 1> }"
    yield row(
        "two abutting boxes in a merge, of glass",
        "wrong pixels, oblique",
        ("abutting", scene(glass(two), VIEWS["oblique"])),
        ("one", scene(glass(one), VIEWS["oblique"])),
    )
    for level in (2, 3):
        yield row(
            f"Menger sponge of level {level} cut by {len(menger_cutters(level))} boxes",
            "wrong pixels, oblique",
            (f"sponge{level}", scene(sponge(level, cut=True), VIEWS["oblique"])),
            (f"cubes{level}", scene(sponge(level, cut=False), VIEWS["oblique"])),
        )
    eye = VIEWS["oblique"]
    for power in (-9, -3, 3, 9):
        scale = 10.0**power
        yield row(
            "four solids, everything scaled",
            f"pixels unlike those at scale 1, scale 10^{power}",
            (f"scale{power}", scene(collection(scale), eye, scale)),
            ("scale0", scene(collection(1.0), eye)),
        )
    total = share(sum(plain.values()), len(plain) * SIZE * SIZE)
    yield Row(
        f"the {len(plain)} pictures without coincident faces that these were held against",
        "pixels in which the two programs differ",
        "POV-Ray",
        total,
        "the same",
    )
    yield from torus(folder, rays // 10)


def torus(folder: Path, count: int) -> Iterator[Row]:
    """Rays aimed into the tube of a torus, by the scene language's ``trace``."""
    for far, distances in TORUS_DISTANCES.items():
        total, lost, ours_lost = 0, 0, 0
        for ratio, rays in torus_cases(distances, count):
            lost += lost_by_povray(folder / "torus.pov", ratio, rays)
            mine = octray.Scene()
            mine.add(octray.torus(1.0, ratio))
            ours_lost += np.count_nonzero(~mine.cast_rays(rays).hit)
            total += len(rays)
        yield Row(
            f"torus, tube 0.001 to 0.999 of its radius, seen from {far} radii",
            "rays aimed into the tube that miss",
            "POV-Ray",
            share(lost, total),
            share(ours_lost, total),
        )


def lost_by_povray(path: Path, ratio: float, rays: Picture) -> int:
    """How many of the rays miss a torus of radius 1 about z."""
    turned = rays[:, [0, 2, 1, 3, 5, 4]]  # its torus stands about y
    numbers = ",\n".join(
        "<{:.17g},{:.17g},{:.17g}>,<{:.17g},{:.17g},{:.17g}>".format(*r) for r in turned
    )
    path.write_text(
        f"""#version 3.7;
global_settings {{ assumed_gamma 1.0 }}
#declare Ring = torus {{ 1, {ratio} }}
#declare Rays = array[{2 * len(rays)}] {{ {numbers} }}
#declare Normal = <0, 0, 0>;
#declare Lost = 0;
#declare I = 0;
#while (I < {len(rays)})
  #declare P = trace(Ring, Rays[2*I], Rays[2*I+1], Normal);
  #if (vlength(Normal) = 0) #declare Lost = Lost + 1; #end
  #declare I = I + 1;
#end
#debug concat("lost ", str(Lost, 0, 0), "\\n")
camera {{ location -5*z look_at 0 }}
""",
        encoding="utf-8",
    )
    done = subprocess.run(
        ["povray", f"+I{path}", "-F", "+W4", "+H4", "-D"],
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    answer = re.search(r"lost (\d+)", done.stderr)
    if answer is None:
        raise RuntimeError(f"POV-Ray could not read {path.name}:\n{done.stderr[-2000:]}")
    return int(answer.group(1))
