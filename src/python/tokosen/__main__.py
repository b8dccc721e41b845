"""`python -m tokosen`: the program."""

from tokosen._program import main

main()
