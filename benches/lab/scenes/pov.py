"""Writes scenes in POV-Ray's language, where solids are combined; z is up, right-handed."""

from __future__ import annotations

from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from collections.abc import Sequence

    from scenes.nff import Vector


def vector(*values: float) -> str:
    """A vector with nine digits."""
    return "<" + ", ".join(f"{value:.9g}" for value in values) + ">"


def view(file: TextIO, eye: Vector, target: Vector, *, angle: float) -> None:
    """Begin a file with its camera and background; ``angle`` is horizontal, in degrees."""
    file.write("#version 3.7;\nglobal_settings { assumed_gamma 1 max_trace_level 5 }\n")
    file.write("camera {\n  right -x * 4 / 3\n  sky z\n")
    file.write(f"  location {vector(*eye)}\n  look_at {vector(*target)}\n  angle {angle:.9g}\n}}\n")
    file.write("background { rgb <0.35, 0.52, 0.75> }\n")


def lights(file: TextIO, places: Sequence[Vector]) -> None:
    """Point lights that share one strength."""
    strength = 1.15 / len(places)
    file.writelines(f"light_source {{ {vector(*place)} rgb {strength:.9g} }}\n" for place in places)


def material(color: Vector, *, mirror: float = 0.0, glass: float = 0.0) -> str:
    """What an object is made of."""
    finish = f"ambient 0.06 diffuse {0.8 - 0.5 * mirror - 0.6 * glass:.9g}"
    if mirror > 0 or glass > 0:
        finish += f" phong 0.4 phong_size 40 reflection {mirror + 0.08 * glass:.9g}"
    filtered = f"rgbf {vector(*color, glass)}" if glass > 0 else f"rgb {vector(*color)}"
    bent = " interior { ior 1.1 }" if glass > 0 else ""
    return f"material {{ texture {{ pigment {{ {filtered} }} finish {{ {finish} }} }}{bent} }}"
