"""What Blender calls the functions in its lists of handlers with."""

# A function that takes one argument is given the first of two.
NUMBERS_OF_ARGUMENTS = (1, 2)
_OF_NOTHING = "Callable[[], None]"
_OF_NONE = "Callable[[None, None], None] | Callable[[None], None]"


def handlers_type(kind: str) -> str:
    """A list's type as the reference has it, with the arguments that Blender gives where the reference has none."""
    return kind.replace(_OF_NOTHING, _OF_NONE)
