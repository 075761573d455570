"""Input errors. The table lists the steps in which input is used, and the exception of each step.

================================  ==================================  ==============================================
step                              exception                           result
================================  ==================================  ==============================================
open, parse and validate a file   `InputError`                        message of the command line, exit code 2
build a record from samples       `RecordInvalid`                     `InputError` of the table (`record_reading`)
compute a quantity                `QuantityUnavailable`               criterion with the verdict `skip`
evaluate the rule of a profile    `BoundMissing`                      criterion with the verdict `skip`
start an external program         `ProgramFailed`                     case with the verdict `error`
read the answer of a program      `AnswerRefused`                     case with the verdict `error`
read the files of a program       `DeliveryRefused`, `InputError`     case with the verdict `error`
tune and simulate a line          `SimulationError`                   message of the command line, exit code 2
================================  ==================================  ==============================================

In a run of several cases, the first and the last end as the verdict `error` of their case.
"""


class InputError(ValueError):
    """Input that cannot be used. It is refused, because wrong input would give a wrong number in a certificate.

    Parameters
    ----------
    where : str
        File, and the key, line or channel inside it.
    found : str
        Content found there.
    hint : str
        Content expected there, or the next step of the user.
    """

    def __init__(self, where: str, found: str, hint: str) -> None:
        super().__init__(f"{where}: {found}.\n  {hint}")
        self.where = where
        self.found = found
        self.hint = hint
