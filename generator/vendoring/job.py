"""Vendoring from end to end: kernels, golden vectors, files, manifest; and verifying it again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ..errors import InputError
from ..evidence.timing.bench_tool import BenchTool
from .folder import HandChange, hand_changes
from .golden import golden_rows
from .kernels import Chosen, Places, TargetKernels, stored_kernels
from .manifest import (
    FILE,
    Manifest,
    VendoredKernel,
    make_manifest,
    read_manifest,
)
from .package import package_files, unit_file
from .request import VendorRequest


@dataclass(frozen=True)
class Comparison:
    """A folder against its own manifest, and against what vendoring it today would give."""

    manifest: Manifest
    by_hand: tuple[HandChange, ...]
    outdated: tuple[str, ...]  # reasons, a line each

    @property
    def unchanged(self) -> bool:
        return not self.by_hand and not self.outdated


def all_files(
    request: VendorRequest, chosen: Chosen, tools: Mapping[str, BenchTool]
) -> dict[str, str]:
    """Names and texts of all files, the manifest last. `tools`: of each impact."""
    rows = {
        part.impact: golden_rows(tools[part.impact], part.known_scene, part.model, part.goal)
        for part in request.parts
    }
    files = package_files(request, chosen, rows)
    kernels = tuple(
        _record(part, target, chosen[part.impact][target])
        for part in request.parts
        for target in part.targets
    )
    manifest = make_manifest(request, kernels, sum(map(len, rows.values())), files)
    return {**files, FILE: manifest.text()}


def _record(part: VendorRequest, target: str, chosen: TargetKernels) -> VendoredKernel:
    header = f"{part.prefix}.h" if part.single_header else None
    batch_file = header or unit_file(part, target, batch=True)
    return VendoredKernel(
        target=target,
        file=header or unit_file(part, target),
        record=chosen.single,
        batch_file=None if chosen.batch is None else batch_file,
        batch=chosen.batch,
    )


def compare(folder: Path, places: Places, tools: Mapping[str, BenchTool]) -> Comparison:
    """Unchanged, edited by hand, out of date, or both. InputError where it is no vendored folder.

    Out of date is judged by the manifest's record of each file, not by the files: so an edit does
    not look as if the sources had changed.
    """
    manifest = read_manifest(folder)
    by_hand = hand_changes(folder, manifest)
    try:
        request = manifest.request()
        files = all_files(request, manifest.chosen(), tools)
        reasons = [*_other_choices(request, manifest, places), *_other_files(files, manifest)]
    except (InputError, ValueError, KeyError) as error:
        reasons = [f"cannot be made any more: {error}"]
    return Comparison(manifest, by_hand, tuple(reasons))


def _other_choices(request: VendorRequest, manifest: Manifest, places: Places) -> list[str]:
    """Targets for which another choice is stored by now."""
    lines = []
    for part in request.parts:
        for target, chosen in manifest.chosen()[part.impact].items():
            stored = stored_kernels(places, part, target)
            if stored is None or stored == chosen:
                continue
            names = {k.kernel for k in (stored.single, stored.batch) if k is not None}
            old = {k.kernel for k in (chosen.single, chosen.batch) if k is not None}
            other = ", ".join(sorted(names - old))
            what = other or "the same with other figures, or no batch kernel"
            lines.append(f"for {target} another choice is stored: {what}")
    return lines


def _other_files(files: Mapping[str, str], manifest: Manifest) -> list[str]:
    made = Manifest.model_validate_json(files[FILE])
    names = sorted({*made.files, *manifest.files})
    lines = [f"{n}: out of date" for n in names if made.files.get(n) != manifest.files.get(n)]
    if not lines and made != manifest.hashed():
        lines.append(f"{FILE}: out of date")
    return lines
