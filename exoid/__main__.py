"""`python -m exoid`, the same as the command `exoid`."""

from .cli import main

if __name__ == "__main__":
    main()
