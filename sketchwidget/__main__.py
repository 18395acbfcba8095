"""`python -m sketchwidget` is the `sketchwidget` command."""

from sketchwidget.cli import main

main(prog_name="sketchwidget")
