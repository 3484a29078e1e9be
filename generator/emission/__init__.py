"""Emission: Jinja2 lays out what lowering decided; banners, formatting, files."""
