"""Files of templates/clients: what stands around kernels in other languages."""

from __future__ import annotations

from collections.abc import Iterable

from .banner import Banner, bannered
from .formatting import format_source


def client_file(name: str, command: str, data: Iterable[str], **shown: object) -> str:
    """A file from its template, with the banner of all generated files; `data` as there."""
    made = name.removesuffix(".j2")
    banner = Banner({"file": made}, command, tuple(data))
    return format_source(bannered(f"clients/{name}", shown, banner), made)
