"""Does a record contradict itself, or the case it claims to be of?

Limits on statistics cannot tell a wrong record with the right numbers. These checks need no other simulator: they hold
a record against its own channels, its sidecar's word, and the pantograph of the case.

===============  ======================================================================================================
check            what must hold
===============  ======================================================================================================
coverage         every pantograph crosses the whole evaluated stretch
motion           positions advance with the speed of the train
support passing  a support is lifted most while a pantograph is near it
roll-off         a force said to be filtered falls off above the cut-off as that filter makes it fall
dynamics         the pantograph of the case, driven by the force, moves as the contact height says
===============  ======================================================================================================
"""
