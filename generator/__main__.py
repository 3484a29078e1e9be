"""python -m generator: the gen command."""

from .cli.main import main

main()
