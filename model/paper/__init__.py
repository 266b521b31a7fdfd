"""The paper put to the test: its runs again, and what had to be settled in it."""
