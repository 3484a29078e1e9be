"""manifest.json: what a vendored folder holds, what was found of it, and every file's sha256."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from pydantic import (
    BaseModel,
    ConfigDict,
    SerializerFunctionWrapHandler,
    ValidationError,
    model_serializer,
)

from .. import __version__
from ..choice.cases import VERIFY_RANDOM, VERIFY_SEED
from ..choice.selection import Selected
from ..emission.banner import LICENCE
from ..errors import InputError
from ..evidence.verification.evidence import evidence_of
from ..evidence.verification.reference import load_reference
from ..registry.question import DEFAULT_IMPACT, Goal
from .kernels import Chosen, TargetKernels
from .request import VendorRequest, checked

FILE = "manifest.json"


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Options(_Strict):
    """The request."""

    targets: tuple[str, ...]
    scene: str
    model: str
    max_error: float | None
    steps: int | None
    prefix: str
    single_header: bool
    reproducible: bool = False
    impact: str = DEFAULT_IMPACT

    @model_serializer(mode="wrap")
    def _without_default(self, serialise: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Folders of the usual kind are as they were before there was another."""
        document: dict[str, Any] = serialise(self)
        if not self.reproducible:
            del document["reproducible"]
        if self.impact == DEFAULT_IMPACT:
            del document["impact"]
        return document


class ErrorBound(_Strict):
    """What is promised, and how it was found; each kernel has the largest error seen."""

    bound: float
    of: str
    against: str
    found: str


class VendoredKernel(_Strict):
    """The kernel of one target with the record of its choice and timing.

    `batch`: that of the kernel which batches go through, where it is another.
    """

    target: str
    file: str
    record: Selected
    batch_file: str | None
    batch: Selected | None


class Manifest(_Strict):
    """The file. `sha256` is that of the file itself with an empty text in its place."""

    schema_version: Literal[1] = 1
    carom: str
    licence: str
    command: str
    options: Options
    error: ErrorBound
    kernels: tuple[VendoredKernel, ...]
    golden_cases: int
    files: dict[str, str]
    sha256: str

    def request(self) -> VendorRequest:
        """The request that the folder was made for. InputError where it can be made no more."""
        o = self.options
        goal = Goal(o.steps, o.max_error)
        return checked(
            VendorRequest(
                o.targets,
                o.scene,
                o.model,
                goal,
                o.prefix,
                o.single_header,
                o.reproducible,
                o.impact,
            )
        )

    def chosen(self) -> Chosen:
        """The kernels by impact and target."""
        found: dict[str, dict[str, TargetKernels]] = {}
        for kernel in self.kernels:
            of = found.setdefault(kernel.record.variant.question.impact, {})
            of[kernel.target] = TargetKernels(kernel.record, kernel.batch)
        return found

    def text(self) -> str:
        return json.dumps(self.model_dump(mode="json"), indent=2) + "\n"

    def hashed(self) -> Manifest:
        """With its own hash filled in."""
        empty = self.model_copy(update={"sha256": ""})
        return self.model_copy(update={"sha256": sha256_of(empty.text())})


def sha256_of(data: str | bytes) -> str:
    return hashlib.sha256(data.encode() if isinstance(data, str) else data).hexdigest()


def make_manifest(
    request: VendorRequest,
    kernels: tuple[VendoredKernel, ...],
    golden_cases: int,
    files: Mapping[str, str],
) -> Manifest:
    """The manifest of files that were made for a request."""
    goal = request.goal
    manifest = Manifest(
        carom=__version__,
        licence=LICENCE,
        command=request.command,
        options=Options(
            targets=request.targets,
            scene=request.scene,
            model=request.model,
            max_error=goal.budget,
            steps=goal.steps,
            prefix=request.prefix,
            single_header=request.single_header,
            reproducible=request.reproducible,
            impact=request.impact,
        ),
        error=_error(request),
        kernels=kernels,
        golden_cases=golden_cases,
        files={name: sha256_of(text) for name, text in sorted(files.items())},
        sha256="",
    )
    return manifest.hashed()


def _error(request: VendorRequest) -> ErrorBound:
    """Of one impact its own; of several what is said of each, by name."""
    own = [_error_of(part) for part in request.parts]
    if len(own) == 1:
        return own[0]

    def said(key: str) -> str:
        told = zip(request.parts, own, strict=True)
        return "; ".join(f"{part.impact}: {getattr(each, key)}" for part, each in told)

    return ErrorBound(
        bound=own[0].bound, of=said("of"), against=said("against"), found=said("found")
    )


def _error_of(request: VendorRequest) -> ErrorBound:
    evidence = evidence_of(request.row)
    known = load_reference(evidence.reference)
    cases = f"{len(known.ids)} cases of tests/data/{evidence.reference.folder.name}"
    if not request.known_scene.unrestricted:
        cases += ", moved into the scene,"
    seen = f"the {cases} and {VERIFY_RANDOM} random ones (seed {VERIFY_SEED})"
    if request.goal.budget is None:
        return ErrorBound(
            bound=1e-6,
            of="m/s, each component of v and R w",
            against=f"the scheme with N = {request.goal.steps} in long double; cases that flip by "
            "a step or stick apart (docs/accuracy.md)",
            found=f"verification on {seen}; max_rel_error is the largest of them",
        )
    return ErrorBound(
        bound=request.goal.budget,
        of=f"{request.row.relative_to} before, each component of v and R w",
        against="the exact solution of the contact model",
        found=f"verification on {seen} against the exact solver of tests/oracle; max_rel_error is "
        "the largest of them, a lower bound of the largest there is (docs/accuracy.md)",
    )


def read_manifest(folder: Path) -> Manifest:
    """The manifest of a folder. Raises InputError that says what is wrong with it."""
    path = folder / FILE
    try:
        document = json.loads(path.read_text("utf-8"))
        return Manifest(**document)
    except FileNotFoundError:
        raise InputError(
            f"{folder}: no {FILE} there; expected a folder that ./gen vendor has made"
        ) from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise InputError(f"{path}: key {where}: {first['msg']}; vendor the folder anew") from None
    except (ValueError, TypeError) as error:
        raise InputError(f"{path}: not a manifest: {error}; vendor the folder anew") from None
