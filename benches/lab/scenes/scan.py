"""A scanned mesh out of the corpus of other people's files, which is not part of the project."""

from __future__ import annotations

import csv
import os
from dataclasses import dataclass
from pathlib import Path

import octray

#: The entry of the corpus's manifest.
ENTRY = "mesh/armadillo.obj"
ROOT = Path(__file__).resolve().parents[3]


@dataclass(frozen=True)
class Scan:
    """The mesh, as the manifest names it."""

    path: Path
    entry: str
    source: str
    triangles: int


def find() -> Scan | str:
    """Look for the mesh; in words why it is not there."""
    given = os.environ.get("OCTRAY_CORPUS")
    corpus = Path(given) if given else ROOT.parent / "shared" / "data"
    absent = f"absent: OCTRAY_CORPUS names no corpus with {ENTRY}"
    manifest = corpus / "MANIFEST.tsv"
    if not manifest.is_file():
        return absent
    with manifest.open(encoding="utf-8", newline="") as file:
        entries = {row["file"]: row for row in csv.DictReader(file, delimiter="\t")}
    path = corpus / ENTRY
    if ENTRY not in entries or not path.is_file():
        return absent
    source = f"from {entries[ENTRY]['repo']}"
    return Scan(path, ENTRY, source, octray.load(path).describe()["triangles"])
