"""Mistakes in a diagram, a block or a file, with their places."""

class Mistake:
    """One mistake.

    code: "no-equation", "frame", ...; docs/errors.md lists them.
    message: one line, the block, the port, the mistake.
    details: further lines, both sides and their places.
    hint: the way out.
    places: "folder/file.py:12" of every line of the script that takes part; of mistakes that are
    noticed at once the line that runs.
    """

    def __init__(self, code, message, details, hint, places):
        self.code = code
        self.message = message
        self.details = details
        self.hint = hint
        self.places = places

    def __repr__(self):
        return f"Mistake({self.code!r}, {self.message!r}, places={self.places})"


class CompileWarning(UserWarning):
    """A note of the kind "warning" of System.notes: lost digits, or input that is rarely intended."""


class Error(Exception):
    """All mistakes that were found in one stage, together; `str` is the whole text."""

    def __init__(self, text, mistakes):
        super().__init__(text)
        self.mistakes = mistakes

    def has(self, code):
        """True if any mistake has this code."""
        return any(mistake.code == code for mistake in self.mistakes)

    def __reduce__(self):
        return Error, (str(self), self.mistakes)
