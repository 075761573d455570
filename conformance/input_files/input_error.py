"""Input errors: what a stranger's file got wrong, said once and clearly."""


class InputError(ValueError):
    """Input that cannot be used; the command line prints it and exits with code 2.

    A wrong input that is not caught where it enters becomes a wrong number in a certificate.

    Parameters
    ----------
    where
        The file, and the key, line or channel inside it.
    found
        What is there.
    hint
        What is expected, or what to do next.
    """

    def __init__(self, where: str, found: str, hint: str) -> None:
        super().__init__(f"{where}: {found}.\n  {hint}")
        self.where = where
        self.found = found
        self.hint = hint
