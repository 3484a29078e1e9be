"""Files of templates/clients: what stands around kernels in other languages."""

from __future__ import annotations

from generator.emission.banner import banner, source_hash
from generator.emission.environment import environment
from generator.emission.formatting import format_source


def client_file(name: str, command: str, **values: object) -> str:
    """A file from its template, with the banner of all generated files."""
    made = name.removesuffix(".j2")
    template = environment().get_template(f"clients/{name}")
    body = template.render(banner="", **values)
    top = banner(f"clients/{name}", made, command, source_hash(body))
    return format_source(template.render(banner=top, **values), made)
