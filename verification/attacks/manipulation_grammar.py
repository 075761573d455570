"""Grammar of the manipulation campaign: each manipulation removes, moves, relabels or mixes information of a run.

No manipulation invents physics: it changes or copies channels of a run, but solves no equation of motion.
"""

from verification.attacks.manipulation_channels import change_support, copy_pantograph, smooth_one, smooth_together
from verification.attacks.manipulation_dossier import Manipulation
from verification.attacks.manipulation_mixture import (
    merge_records,
    repeat_pantograph,
    split_train,
    swap_pantographs,
    swap_supports,
)
from verification.attacks.manipulation_notation import (
    convert_unit,
    relabel_unit,
    rename_column,
    reorder_columns,
    reorder_supports,
)
from verification.attacks.manipulation_removal import (
    drop_channel,
    drop_column,
    drop_key,
    drop_pantograph,
    drop_samples,
    drop_support,
)
from verification.attacks.manipulation_samples import change_rate, hold, rescale, smooth
from verification.attacks.manipulation_settings import add_limits_file, change_case, change_section, change_sidecar
from verification.attacks.manipulation_shift import (
    shift_clock,
    shift_positions,
    shift_supports,
    shift_time,
    shift_track,
)

MANIPULATIONS: tuple[tuple[str, Manipulation], ...] = (
    ("drop", drop_column),
    ("drop", drop_channel),
    ("drop", drop_support),
    ("drop", drop_pantograph),
    ("drop", drop_samples),
    ("drop", drop_key),
    ("positions", shift_positions),
    ("positions", shift_supports),
    ("positions", shift_track),
    ("shift", shift_time),
    ("shift", shift_clock),
    ("split", repeat_pantograph),
    ("split", split_train),
    ("split", swap_pantographs),
    ("split", swap_supports),
    ("scale", rescale),
    ("scale", relabel_unit),
    ("scale", smooth),
    ("scale", hold),
    ("reexpress", convert_unit),
    ("reexpress", reorder_columns),
    ("reexpress", reorder_supports),
    ("rename", rename_column),
    ("rate", change_rate),
    ("section", change_section),
    ("sidecar", change_sidecar),
    ("merge", merge_records),
    ("case", change_case),
    ("limits", add_limits_file),
    ("channels", change_support),
    ("channels", smooth_one),
    ("channels", smooth_together),
    ("channels", copy_pantograph),
)
"""Group and function of every manipulation; a trial draws from them by position."""
