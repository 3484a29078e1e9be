"""python -m generator: the gen command."""

from generator.cli.main import main

main()
