"""`python -m app` is `trackride`."""

from app.cli import main

if __name__ == "__main__":
    main()
