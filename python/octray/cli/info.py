"""``octray info``: what is in a scene file."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import click

from octray.cli.messages import as_dict, load
from octray.cli.options import scene_argument

if TYPE_CHECKING:
    from typing import Any


def _numbers(values: list[float]) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in values) + ")"


def _box(bounds: list[list[float]] | None) -> str:
    if bounds is None:
        return "none"
    low, high = bounds
    size = [b - a for a, b in zip(low, high, strict=True)]
    return f"{_numbers(low)} to {_numbers(high)}, size {_numbers(size)}"


def _object_line(index: int, entry: dict[str, Any]) -> str:
    parts = ", ".join(
        f"{count} {name}" if count > 1 else name for name, count in entry["primitives"].items()
    )
    triangles = f", {entry['triangles']} triangles" if entry["triangles"] else ""
    copies = entry["instances"]
    kind = entry["kind"] if copies is None else f"{copies} instances of"
    bounds = "unbounded" if entry["unbounded"] else _box(entry["bounds"])
    return (
        f"  {index}  {entry['name']}: {kind} ({parts or 'empty'}{triangles}),"
        f" material {entry['material']}\n       bounds {bounds}"
    )


def _mesh_lines(check: dict[str, Any]) -> list[str]:
    if check["solid"]:
        shells = check["shells"]
        return [f"       bounds a solid of {shells} shell{'s' if shells > 1 else ''}"]
    closed = "closed, but no" if check["closed"] else "not closed: no"
    flaws = ", ".join(f"{kind} {count}" for kind, count in check["flaws"].items())
    places = [f"         {place['message']}" for place in check["places"]]
    return [f"       {closed} boundary of a solid: {flaws or 'no triangles'}", *places]


def _near_line(pair: dict[str, Any], objects: list[dict[str, Any]]) -> str:
    kind = {"plane": "planes", "curved": "curved surfaces"}[pair["kind"]]
    names = " and ".join(f"`{objects[i]['name']}`" for i in dict.fromkeys(pair["objects"]))
    return f"  {kind} of {names}, {pair['gap']:.3g} apart, at {_numbers(pair['position'])}"


def _surface_lines(check: dict[str, Any], objects: list[dict[str, Any]]) -> list[str]:
    lines = [f"surfaces {check['surfaces']}, faces merged with them {check['merged']}"]
    count, pairs = check["near_count"], check["pairs"]
    if count:
        lines.append(
            f"  {count} nearly {'coincide' if count > 1 else 'coincides'} with another: nearer than"
            f" {check['near']:.3g}, and farther than {check['tolerance']:.3g}, so they are distinct"
        )
        lines.extend(_near_line(pair, objects) for pair in pairs)
        if count > len(pairs):
            lines.append(f"  and {count - len(pairs)} more")
    return lines


def _material_line(index: int, entry: dict[str, Any]) -> str:
    look = entry["pattern"] or f"color {_numbers(entry['color'])}"
    if entry["transparent"]:
        look += f", transparent, ior {entry['ior']:.6g}"
    if any(entry["reflection"]):
        look += f", reflection up to {_numbers(entry['reflection'])}"
    return f"  {index}  {entry['name']}: {look}"


def _light_line(index: int, entry: dict[str, Any]) -> str:
    place = f" at {_numbers(entry['position'])}" if entry["position"] else ""
    way = f" along {_numbers(entry['direction'])}" if entry["direction"] else ""
    shadows = "" if entry["shadows"] else ", no shadows"
    return f"  {index}  {entry['kind']}{place}{way}, color {_numbers(entry['color'])}{shadows}"


def _text(path: str, scene: dict[str, Any]) -> str:
    lines = [path]
    unit = f" {scene['units']}" if scene["units"] else ""
    lines.append(f"bounds {_box(scene['bounds'])}{unit}")
    lines.append(f"triangles {scene['triangles']}")
    camera = scene["camera"]
    lines.append(
        f"camera {camera['kind']} at {_numbers(camera['eye'])}" if camera else "camera none"
    )
    lines.append(f"objects {len(scene['objects'])}")
    for index, entry in enumerate(scene["objects"]):
        lines.append(_object_line(index, entry))
        for check in scene["meshes"]:
            if check["object"] == index:
                lines.extend(_mesh_lines(check))
    lines.extend(_surface_lines(scene["surfaces"], scene["objects"]))
    for title, line in (("materials", _material_line), ("lights", _light_line)):
        entries = scene[title]
        lines.append(f"{title} {len(entries)}")
        lines.extend(line(index, entry) for index, entry in enumerate(entries))
    return "\n".join(lines)


@click.command("info", epilog="Example: octray info --strict part.csg")
@scene_argument
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@click.option("-q", "--quiet", is_flag=True, help="No warnings on standard error.")
def command(scene: str, facets: bool, strict: bool, as_json: bool, quiet: bool) -> None:
    """Print the objects, materials, lights and bounds of SCENE.

    Of meshes it says whether they bound a solid, and if not, what is wrong where; of the
    surfaces of solids how many coincide, and which nearly do and are distinct.
    With --strict a warning is an error (exit code 3): a check of the file.
    """
    loaded = load(scene, facets=facets, strict=strict, quiet=quiet)
    described = loaded.describe()
    described["meshes"] = loaded.check_meshes()
    described["surfaces"] = loaded.check_surfaces()
    if as_json:
        described["file"] = scene
        described["warnings"] = [as_dict(diagnostic) for diagnostic in loaded.diagnostics]
        click.echo(json.dumps(described, indent=2))
    else:
        click.echo(_text(scene, described))
