"""The controls of the page: they show values and hand on what the user asks for."""
